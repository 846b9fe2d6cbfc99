#include "tests/golden/golden_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <istream>
#include <memory>
#include <optional>
#include <ostream>
#include <set>
#include <sstream>
#include <vector>

#include "protocol/model/self_check.hpp"
#include "protocol/units/hash.hpp"
#include "tests/golden/golden_text.hpp"

namespace trochoid {

namespace {

constexpr const char* head =
    R"(# Trochoid golden vectors, model version 2. Any program that computes the sea must reproduce every line bit for bit.
# All numbers are decimal integers, except floats: 8 hex digits of their IEEE 754 binary32 bits.
# sincos PHASE SIN COS                     phase in turns, Q0.32
# wakenode SYSTEM J PHASE ALONG OUTWARDS GAIN     node of the wake table; system 0 transverse, 1 diverging
# wakeroot J VALUE
# box ID FIRST_TRAIN X Z UX UZ LENGTH WIDTH RAMP_REAR RAMP_FRONT RAMP_SIDE BEGIN BUILD_UP END DECAY FRONT_SPEED GAIN_MAX RAISED FADE ROUNDNESS
# leg FROM DURATION X Z VX VZ                             of the last box, as are the next five
# overlay FIELD BASE
# irregular SHARE UKX UKZ VKX VKZ OMEGA PHASE_U PHASE_V
# noise AMPLITUDE PERSISTENCE OCTAVES STEP_LOG2 PERIOD_LOG2 DISPLAYED_ONLY SEED
# wake TRANSVERSE DIVERGING CHOPPINESS INVERSE_LENGTH GROUP_SPEED
# train KX KZ OMEGA PHASE AMPLITUDE CHOPPINESS FIELD
# field ID STEP_LOG2
# block X Z then 289 shifts, 289 gains and 289 orbits      of the last field
# sample T X Z AX AY AZ PXX PXZ PZX PZZ YX YZ NX NY NZ VX VY VZ      surface at a rest point, authoritative layers
# layers MASK T X Z AX ... VZ                                        the same with another set of layers
# water T X Z HEIGHT NX NY NZ VX VY VZ REST_X REST_Z                 surface at a fixed place
# hash SEED COUNT HASH                     known-answer hash of the built-in reference sea (16 hex digits)
)";

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

    static float float_from(std::istringstream& in) {
        uint32_t word = 0;
        in >> std::hex >> word >> std::dec;
        return std::bit_cast<float>(word);
    }

    static WaveTrain train_from(std::istringstream& in) {
        WaveTrain t;
        in >> t.kx >> t.kz >> t.omega >> t.phase;
        t.amplitude = float_from(in);
        t.choppiness = float_from(in);
        in >> t.field.value;
        return t;
    }

    /// A field of the file, over another one or (base 0) alone; nothing where it is not there.
    std::optional<LandField> field_over(FieldId id, FieldId base) const {
        const auto found = [&](FieldId wanted) {
            return std::find_if(fields.begin(), fields.end(),
                                [&](const auto& f) { return f->id() == wanted; });
        };
        const auto top = found(id);
        const auto below = found(base);
        if (top == fields.end() || (base.value != 0 && below == fields.end())) return std::nullopt;
        LandField field(**top);
        if (base.value != 0) field.set_base(*below);
        return field;
    }

    /// True where the kind is one of a box's features (read, or failed to be).
    bool feature(const std::string& kind, std::istringstream& in) {
        WaveTrainBox& b = boxes.back();
        if (kind == "leg") {
            CourseLeg& l = b.course.emplace_back();
            in >> l.from.us >> l.duration_us >> l.origin.x >> l.origin.z >> l.vx >> l.vz;
        } else if (kind == "overlay") {
            FieldOverlay& o = b.overlays.emplace_back();
            in >> o.field.value >> o.base.value;
        } else if (kind == "irregular") {
            IrregularHeight& i = b.irregular;
            in >> i.share >> i.ukx >> i.ukz >> i.vkx >> i.vkz >> i.omega >> i.phase_u >> i.phase_v;
        } else if (kind == "noise") {
            uint32_t octaves = 0;
            uint32_t step = 0;
            uint32_t period = 0;
            b.noise.amplitude = float_from(in);
            in >> b.noise.persistence >> octaves >> step >> period >> b.noise.displayed_only >> b.noise.seed;
            b.noise.octaves = static_cast<uint8_t>(octaves);
            b.noise.step_log2 = static_cast<uint8_t>(step);
            b.noise.period_log2 = static_cast<uint8_t>(period);
        } else if (kind == "wake") {
            b.wake.transverse = float_from(in);
            b.wake.diverging = float_from(in);
            b.wake.choppiness = float_from(in);
            in >> b.wake.inverse_length >> b.wake.group_speed;
        } else {
            return false;
        }
        return true;
    }

    bool record(const std::string& kind, std::istringstream& in) {
        if (kind == "box") {
            WaveTrainBox& b = boxes.emplace_back();
            in >> b.id.value >> b.first_train.value >> b.origin.x >> b.origin.z >> b.ux >> b.uz >> b.length >>
                b.width >> b.ramp_rear >> b.ramp_front >> b.ramp_side >> b.begin.us >> b.build_up_us >>
                b.end.us >> b.decay_us >> b.front_speed >> b.gain_max >> b.raised_us >> b.fade_us >>
                b.roundness;
            return !in.fail();
        }
        if (!boxes.empty() && feature(kind, in)) return !in.fail();
        if (kind == "train" && !boxes.empty()) {
            boxes.back().trains.push_back(train_from(in));
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
            for (uint16_t& v : block->orbit) in >> v;
            if (in.fail()) return false;
            fields.back()->set(std::move(block));
            return true;
        }
        return false;
    }

    /// The same for the lines that need no sea.
    std::string part(const std::string& kind, std::istringstream& in) const {
        SeaTime t;
        LatticePoint p;
        if (kind == "constants") {
            const WaveTrain train = train_from(in);
            return in.fail() ? "" : constants_text(train);
        }
        if (kind == "phase") {
            WaveTrain train;
            in >> train.kx >> train.kz >> train.omega >> train.phase >> t.us >> p.x >> p.z;
            return in.fail() ? "" : phase_text(train, t, p);
        }
        FieldId id;
        FieldId base;
        in >> id.value >> base.value >> p.x >> p.z;
        const auto field = in.fail() ? std::nullopt : field_over(id, base);
        return field ? land_text(*field, p) : "";
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
        if (kind == "wakenode") {
            int system = 0;
            size_t j = 0;
            in >> system >> j;
            return in.fail() || j > wake_cells ? "" : wake_node_text(system, j);
        }
        if (kind == "wakeroot") {
            size_t j = 0;
            in >> j;
            return in.fail() || j > wake_root_cells ? "" : fmt::format("{}", wake_table().root[j]);
        }
        if (kind == "constants" || kind == "phase" || kind == "land") return part(kind, in);
        Layers layers = authoritative_layers;
        if (kind == "layers") in >> layers.bits;
        SeaTime t;
        LatticePoint p;
        in >> t.us >> p.x >> p.z;
        if (in.fail()) return "";
        if (kind == "sample" || kind == "layers") return sample_text(rebuilt(), t, p, layers);
        if (kind == "water") return water_text(rebuilt(), t, p);
        return "";
    }
};

void write_wake_table(std::ostream& out) {
    for (int system = 0; system < 2; ++system)
        for (size_t j = 0; j <= wake_cells; j += j >= 240 && j < 264 ? 1 : (j >= 712 && j < 764 ? 4 : 8))
            out << fmt::format("wakenode {} {} {}\n", system, j, wake_node_text(system, j));
    for (size_t j = 0; j <= wake_root_cells; j += 4)
        out << fmt::format("wakeroot {} {}\n", j, wake_table().root[j]);
}

/// Each layer left out alone, each with the trains alone, all: around the storm, the successor's fade and the ship.
void write_layers(std::ostream& out, const Sea& sea) {
    for (uint32_t i = 0; i < 200; ++i) {
        const uint16_t one = static_cast<uint16_t>(1U << (i % 10));
        Layers layers{i % 10 == 9 ? displayed_layers.bits : static_cast<uint16_t>(one | 1U)};
        if (i % 20 < 9) layers.bits = static_cast<uint16_t>(displayed_layers.bits ^ one);
        const uint64_t a = splitmix64(5000 + i);
        const uint64_t b = splitmix64(a);
        const LatticePoint p{static_cast<int64_t>(a % 4'000'000) - 2'000'000,
                             static_cast<int64_t>(b % 4'000'000) - 2'000'000};
        const SeaTime t{static_cast<int64_t>(splitmix64(b) % 900'000'000)};
        out << fmt::format("layers {} {} {} {} {}\n", layers.bits, t.us, p.x, p.z,
                           sample_text(sea, t, p, layers));
    }
}

}  // namespace

void write_goldens(std::ostream& out) {
    out << head;
    for (uint32_t i = 0; i < 256; ++i) {
        // Every octant's borders first, then anywhere.
        const uint32_t phase =
            i < 64 ? (i / 4) * 0x10000000U + (i % 4) - 2U : static_cast<uint32_t>(splitmix64(i));
        out << fmt::format("sincos {} {}\n", phase, sincos_text(phase));
    }
    write_wake_table(out);
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
    write_layers(out, sea);
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
        static const std::set<std::string> records = {"box",  "leg",   "overlay", "irregular", "noise",
                                                      "wake", "train", "field",   "block"};
        if (records.contains(kind)) {
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
