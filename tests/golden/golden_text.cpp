#include "tests/golden/golden_text.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <ostream>
#include <set>

#include "protocol/model/point_query.hpp"
#include "protocol/model/sincos.hpp"

namespace trochoid {

namespace {

std::array<float, 15> floats_of(const SurfaceSample& s) {
    return {s.ax, s.ay, s.az, s.pxx, s.pxz, s.pzx, s.pzz, s.yx, s.yz, s.nx, s.ny, s.nz, s.vx, s.vy, s.vz};
}

void write_features(std::ostream& out, const WaveTrainBox& b) {
    for (const CourseLeg& l : b.course)
        out << fmt::format("leg {} {} {} {} {} {}\n", l.from.us, l.duration_us, l.origin.x, l.origin.z, l.vx,
                           l.vz);
    for (const FieldOverlay& o : b.overlays)
        out << fmt::format("overlay {} {}\n", o.field.value, o.base.value);
    const IrregularHeight& i = b.irregular;
    if (i != IrregularHeight{})
        out << fmt::format("irregular {} {} {} {} {} {} {} {}\n", i.share, i.ukx, i.ukz, i.vkx, i.vkz,
                           i.omega, i.phase_u, i.phase_v);
    const SurfaceNoise& n = b.noise;
    if (n != SurfaceNoise{})
        out << fmt::format("noise {} {} {} {} {} {} {}\n", hex(n.amplitude), n.persistence, n.octaves,
                           n.step_log2, n.period_log2, n.displayed_only ? 1 : 0, n.seed);
    const ShipWake& w = b.wake;
    if (w != ShipWake{})
        out << fmt::format("wake {} {} {} {} {}\n", hex(w.transverse), hex(w.diverging), hex(w.choppiness),
                           w.inverse_length, w.group_speed);
}

}  // namespace

std::string hex(float v) { return fmt::format("{:08x}", std::bit_cast<uint32_t>(v)); }

std::string sincos_text(uint32_t phase) {
    const SinCos v = sincos_turns(phase);
    return hex(v.sin) + " " + hex(v.cos);
}

std::string wake_node_text(int system, size_t j) {
    const WakeTable& table = wake_table();
    const WakeNode& n = system == 0 ? table.transverse[j] : table.diverging[j];
    return fmt::format("{} {} {} {}", n.phase, n.along, n.outwards, n.gain);
}

std::string constants_text(const WaveTrain& train) {
    const TrainConstants c = derive_constants(train);
    return fmt::format("{} {} {} {} {} {} {}", hex(c.kx), hex(c.kz), hex(c.hx), hex(c.hz), hex(c.wavelength),
                       hex(c.omega), c.whole);
}

std::string phase_text(const WaveTrain& train, SeaTime t, LatticePoint p) {
    return fmt::format("{}", phase_from_place(train, p.x, p.z) + phase_at_origin(train, t.us));
}

std::string land_text(const LandField& field, LatticePoint p) {
    const LandSample s = field.sample(p);
    return fmt::format("{} {} {} {} {} {} {} {} {}", s.shift, hex(s.dshift_dx), hex(s.dshift_dz), s.gain,
                       hex(s.dgain_dx), hex(s.dgain_dz), hex(s.orbit), hex(s.dorbit_dx), hex(s.dorbit_dz));
}

std::string sample_text(const Sea& sea, SeaTime t, LatticePoint p, Layers layers) {
    std::string text;
    for (const float v : floats_of(SeaInstant(sea, t, layers).evaluate(p)))
        text += (text.empty() ? "" : " ") + hex(v);
    return text;
}

std::string water_text(const Sea& sea, SeaTime t, LatticePoint p) {
    const WaterPoint w = water_at(SeaInstant(sea, t), p);
    std::string text;
    for (const float v : {w.height, w.nx, w.ny, w.nz, w.vx, w.vy, w.vz}) text += hex(v) + " ";
    return text + fmt::format("{} {}", w.rest.x, w.rest.z);
}

void write_field(std::ostream& out, const LandField& field) {
    out << fmt::format("field {} {}\n", field.id().value, field.step_log2());
    for (const auto& block : field.blocks()) {
        out << fmt::format("block {} {}", block->key.x, block->key.z);
        for (const int32_t v : block->shift) out << ' ' << v;
        for (const uint16_t v : block->gain) out << ' ' << v;
        for (const uint16_t v : block->orbit) out << ' ' << v;
        out << '\n';
    }
}

void write_records(std::ostream& out, const Sea& sea) {
    std::set<uint32_t> written;
    for (const auto& box : sea.boxes()) {
        const WaveTrainBox& b = box->record;
        out << fmt::format("box {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {}\n", b.id.value,
                           b.first_train.value, b.origin.x, b.origin.z, b.ux, b.uz, b.length, b.width,
                           b.ramp_rear, b.ramp_front, b.ramp_side, b.begin.us, b.build_up_us, b.end.us,
                           b.decay_us, b.front_speed, b.gain_max, b.raised_us, b.fade_us, b.roundness);
        write_features(out, b);
        for (const WaveTrain& t : b.trains)
            out << fmt::format("train {} {} {} {} {} {} {}\n", t.kx, t.kz, t.omega, t.phase, hex(t.amplitude),
                               hex(t.choppiness), t.field.value);
        for (const auto& top : box->fields)
            for (const LandField* field = top.get(); field != nullptr; field = field->base().get())
                if (written.insert(field->id().value).second) write_field(out, *field);
    }
}

}  // namespace trochoid
