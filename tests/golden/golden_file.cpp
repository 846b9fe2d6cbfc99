#include "tests/golden/golden_file.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <istream>
#include <map>
#include <memory>
#include <ostream>
#include <sstream>
#include <vector>

#include "protocol/model/point_query.hpp"
#include "protocol/model/sea.hpp"
#include "protocol/model/self_check.hpp"
#include "protocol/model/sincos.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {

namespace {

constexpr const char* head =
    R"(# Trochoid golden vectors, model version 1. Any program that computes the sea must reproduce every line bit for bit.
# All numbers are decimal integers, except floats: 8 hex digits of their IEEE 754 binary32 bits.
# sincos PHASE SIN COS                     phase in turns, Q0.32
# box ID FIRST_TRAIN X Z UX UZ LENGTH WIDTH RAMP_REAR RAMP_FRONT RAMP_SIDE BEGIN BUILD_UP END DECAY FRONT_SPEED GAIN_MAX
# train KX KZ OMEGA PHASE AMPLITUDE CHOPPINESS FIELD      of the last box
# field ID STEP_LOG2
# block X Z then 289 shifts and 289 gains                  of the last field
# sample T X Z AX AY AZ PXX PXZ PZX PZZ YX YZ NX NY NZ VX VY VZ      surface at a rest point
# water T X Z HEIGHT NX NY NZ VX VY VZ REST_X REST_Z                 surface at a fixed place
# hash SEED COUNT HASH                     known-answer hash of the built-in reference sea (16 hex digits)
)";

std::string hex(float v) { return fmt::format("{:08x}", std::bit_cast<uint32_t>(v)); }

std::array<float, 15> floats_of(const SurfaceSample& s) {
    return {s.ax, s.ay, s.az, s.pxx, s.pxz, s.pzx, s.pzz, s.yx, s.yz, s.nx, s.ny, s.nz, s.vx, s.vy, s.vz};
}

std::string sincos_text(uint32_t phase) {
    const SinCos v = sincos_turns(phase);
    return hex(v.sin) + " " + hex(v.cos);
}

std::string sample_text(const Sea& sea, SeaTime t, LatticePoint p) {
    std::string text;
    for (const float v : floats_of(SeaInstant(sea, t).evaluate(p)))
        text += (text.empty() ? "" : " ") + hex(v);
    return text;
}

std::string water_text(const Sea& sea, SeaTime t, LatticePoint p) {
    const WaterPoint w = water_at(SeaInstant(sea, t), p);
    std::string text;
    for (const float v : {w.height, w.nx, w.ny, w.nz, w.vx, w.vy, w.vz}) text += hex(v) + " ";
    return text + fmt::format("{} {}", w.rest.x, w.rest.z);
}

void write_records(std::ostream& out, const Sea& sea) {
    for (const auto& box : sea.boxes()) {
        const WaveTrainBox& b = box->record;
        out << fmt::format("box {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {}\n", b.id.value,
                           b.first_train.value, b.origin.x, b.origin.z, b.ux, b.uz, b.length, b.width,
                           b.ramp_rear, b.ramp_front, b.ramp_side, b.begin.us, b.build_up_us, b.end.us,
                           b.decay_us, b.front_speed, b.gain_max);
        for (const WaveTrain& t : b.trains)
            out << fmt::format("train {} {} {} {} {} {} {}\n", t.kx, t.kz, t.omega, t.phase, hex(t.amplitude),
                               hex(t.choppiness), t.field.value);
        for (const auto& field : box->fields) {
            out << fmt::format("field {} {}\n", field->id().value, field->step_log2());
            for (const auto& block : field->blocks()) {
                out << fmt::format("block {} {}", block->key.x, block->key.z);
                for (const int32_t v : block->shift) out << ' ' << v;
                for (const uint16_t v : block->gain) out << ' ' << v;
                out << '\n';
            }
        }
    }
}

/// The sea as read from a file's records.
struct Reader {
    std::vector<WaveTrainBox> boxes;
    std::vector<std::shared_ptr<LandField>> fields;
    Sea sea;
    bool built = false;

    const Sea& rebuilt() {
        if (!built) {
            const std::vector<std::shared_ptr<const LandField>> all(fields.begin(), fields.end());
            std::vector<std::shared_ptr<const PreparedBox>> prepared;
            for (const WaveTrainBox& box : boxes) prepared.push_back(prepare(box, all));
            sea = Sea(std::move(prepared));
            built = true;
        }
        return sea;
    }

    bool record(const std::string& kind, std::istringstream& in) {
        if (kind == "box") {
            WaveTrainBox& b = boxes.emplace_back();
            in >> b.id.value >> b.first_train.value >> b.origin.x >> b.origin.z >> b.ux >> b.uz >> b.length >>
                b.width >> b.ramp_rear >> b.ramp_front >> b.ramp_side >> b.begin.us >> b.build_up_us >>
                b.end.us >> b.decay_us >> b.front_speed >> b.gain_max;
            return !in.fail();
        }
        if (kind == "train" && !boxes.empty()) {
            WaveTrain& t = boxes.back().trains.emplace_back();
            uint32_t amplitude = 0;
            uint32_t choppiness = 0;
            in >> t.kx >> t.kz >> t.omega >> t.phase >> std::hex >> amplitude >> choppiness >> std::dec >>
                t.field.value;
            t.amplitude = std::bit_cast<float>(amplitude);
            t.choppiness = std::bit_cast<float>(choppiness);
            return !in.fail();
        }
        if (kind == "field") {
            uint32_t id = 0;
            int step = 0;
            in >> id >> step;
            if (in.fail() || step < 12 || step > 20) return false;
            fields.push_back(std::make_shared<LandField>(FieldId{id}, static_cast<uint8_t>(step)));
            return true;
        }
        if (kind == "block" && !fields.empty()) {
            auto block = std::make_shared<LandBlock>();
            in >> block->key.x >> block->key.z;
            for (int32_t& v : block->shift) in >> v;
            for (uint16_t& v : block->gain) in >> v;
            if (in.fail()) return false;
            fields.back()->set(std::move(block));
            return true;
        }
        return false;
    }

    /// What this build computes for a check line; empty where the line cannot be read.
    std::string answer(const std::string& kind, std::istringstream& in) {
        if (kind == "sincos") {
            uint32_t phase = 0;
            in >> phase;
            return in.fail() ? "" : sincos_text(phase);
        }
        if (kind == "hash") {
            uint64_t seed = 0;
            uint32_t count = 0;
            in >> seed >> count;
            return in.fail() ? "" : fmt::format("{:016x}", reference_hash(seed, count));
        }
        SeaTime t;
        LatticePoint p;
        in >> t.us >> p.x >> p.z;
        if (in.fail()) return "";
        if (kind == "sample") return sample_text(rebuilt(), t, p);
        if (kind == "water") return water_text(rebuilt(), t, p);
        return "";
    }
};

}  // namespace

void write_goldens(std::ostream& out) {
    out << head;
    for (uint32_t i = 0; i < 256; ++i) {
        // Every octant's borders first, then anywhere.
        const uint32_t phase =
            i < 64 ? (i / 4) * 0x10000000U + (i % 4) - 2U : static_cast<uint32_t>(splitmix64(i));
        out << fmt::format("sincos {} {}\n", phase, sincos_text(phase));
    }
    const Sea sea = reference_sea();
    write_records(out, sea);
    const int64_t times[] = {
        0, 3'000'000, 200'000'000, 1'000'000'000, 86'400'000'000, 315'360'000'000'000 + 450'000'000};
    for (uint32_t i = 0; i < 240; ++i) {
        const uint64_t a = splitmix64(1000 + i);
        const uint64_t b = splitmix64(a);
        const int64_t span = i % 6 == 5 ? 40'960'000'000 : 3'000'000;
        const LatticePoint p{static_cast<int64_t>(a % static_cast<uint64_t>(span)) - span / 2,
                             static_cast<int64_t>(b % static_cast<uint64_t>(span)) - span / 2};
        const SeaTime t{times[i % 6] + static_cast<int64_t>(splitmix64(b) % 1'000'000)};
        out << fmt::format("sample {} {} {} {}\n", t.us, p.x, p.z, sample_text(sea, t, p));
        if (i % 4 == 0) out << fmt::format("water {} {} {} {}\n", t.us, p.x, p.z, water_text(sea, t, p));
    }
    for (const uint64_t seed : {1ULL, 2ULL, 99ULL})
        out << fmt::format("hash {} 4096 {:016x}\n", seed, reference_hash(seed, 4096));
}

GoldenReport check_goldens(std::istream& in) {
    GoldenReport report;
    Hash64 hash;
    Reader reader;
    std::string line;
    for (uint32_t number = 1; std::getline(in, line); ++number) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        const auto wrong = [&](const std::string& why) {
            if (report.wrong++ == 0) report.first_wrong = fmt::format("line {}: {}", number, why);
        };
        if (kind == "box" || kind == "train" || kind == "field" || kind == "block") {
            if (!reader.record(kind, words)) wrong("unreadable " + kind);
            continue;
        }
        const std::string computed = reader.answer(kind, words);
        std::string expected;
        std::getline(words >> std::ws, expected);
        if (computed.empty()) {
            wrong("unreadable: " + line.substr(0, 60));
            continue;
        }
        ++report.checked;
        hash.text(computed);
        if (computed != expected) wrong(fmt::format("{} expected {} computed {}", kind, expected, computed));
    }
    report.hash = hash.value();
    return report;
}

}  // namespace trochoid
