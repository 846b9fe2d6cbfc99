#include "protocol/model/ordered_sum.hpp"

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/model/gain.hpp"
#include "protocol/model/sincos.hpp"

namespace trochoid {

Local combine(const Envelope& e, const LandSample& land, const HeightModulation& m) {
    const float gain =
        gain_to_float(static_cast<uint32_t>((static_cast<uint64_t>(e.gain) * land.gain) >> 24));
    const float box_gain = gain_to_float(e.gain);
    const float land_gain = gain_to_float(land.gain);
    const float gain_dx = e.dg_dx * land_gain + box_gain * land.dgain_dx;
    const float gain_dz = e.dg_dz * land_gain + box_gain * land.dgain_dz;
    Local l;
    l.shift = land.shift;
    l.g = gain * m.factor;
    l.gx = gain_dx * m.factor + gain * m.dx;
    l.gz = gain_dz * m.factor + gain * m.dz;
    l.gh = l.g * land.orbit;
    l.ghx = l.gx * land.orbit + l.g * land.dorbit_dx;
    l.ghz = l.gz * land.orbit + l.g * land.dorbit_dz;
    l.qx = land.dshift_dx;
    l.qz = land.dshift_dz;
    return l;
}

namespace {

void add_train(Sums& acc, const TrainConstants& t, const Local& l, uint32_t phase) {
    const SinCos wave = sincos_turns(phase);
    const float s = l.g * wave.sin;
    const float c = l.g * wave.cos;
    const float sh = l.gh * wave.sin;
    const float ch = l.gh * wave.cos;
    // Wave vector of the phase as evaluated: refraction turns the derivatives, the displacement keeps d.
    const float kx = t.kx + l.qx;
    const float kz = t.kz + l.qz;
    acc.ax = t.hx * sh + acc.ax;
    acc.ay = t.a * c + acc.ay;
    acc.az = t.hz * sh + acc.az;
    acc.bx = (t.a * kx) * s + acc.bx;
    acc.bz = (t.a * kz) * s + acc.bz;
    acc.mxx = (t.hx * kx) * ch + acc.mxx;
    acc.mxz = (t.hx * kz) * ch + acc.mxz;
    acc.mzx = (t.hz * kx) * ch + acc.mzx;
    acc.mzz = (t.hz * kz) * ch + acc.mzz;
    if (l.gx != 0.0F || l.gz != 0.0F || l.ghx != 0.0F || l.ghz != 0.0F) {
        acc.bx = (t.a * -l.gx) * wave.cos + acc.bx;
        acc.bz = (t.a * -l.gz) * wave.cos + acc.bz;
        acc.mxx = (t.hx * l.ghx) * wave.sin + acc.mxx;
        acc.mxz = (t.hx * l.ghz) * wave.sin + acc.mxz;
        acc.mzx = (t.hz * l.ghx) * wave.sin + acc.mzx;
        acc.mzz = (t.hz * l.ghz) * wave.sin + acc.mzz;
    }
    acc.vx = (t.omega * t.hx) * ch + acc.vx;
    acc.vy = (t.omega * t.a) * s + acc.vy;
    acc.vz = (t.omega * t.hz) * ch + acc.vz;
}

/// Box axes in the world, float32.
struct Axes {
    float ux = 1.0F, uz = 0.0F;
};

Axes axes_of(const WaveTrainBox& box) {
    return {static_cast<float>(box.ux) * 0x1p-30F, static_cast<float>(box.uz) * 0x1p-30F};
}

void add_wake_wave(Sums& acc, const ShipWake& wake, float amplitude, const WakeWave& w, const Axes& axes,
                   const Envelope& e) {
    if (amplitude == 0.0F || w.gain == 0) return;
    TrainConstants t;
    t.dx = w.du * axes.ux - w.dv * axes.uz;
    t.dz = w.du * axes.uz + w.dv * axes.ux;
    t.kx = w.ku * axes.ux - w.kv * axes.uz;
    t.kz = w.ku * axes.uz + w.kv * axes.ux;
    t.a = amplitude;
    const float h = wake.choppiness * amplitude;
    t.hx = h * t.dx;
    t.hz = h * t.dz;
    t.omega = wake_speed(wake) * w.ku;
    LandSample as_land;
    as_land.gain = w.gain;
    as_land.dgain_dx = w.dgain_du * axes.ux - w.dgain_dv * axes.uz;
    as_land.dgain_dz = w.dgain_du * axes.uz + w.dgain_dv * axes.ux;
    add_train(acc, t, combine(e, as_land, {}), w.phase);
}

/// The field's sample with what the layers leave out made neutral.
LandSample layered(LandSample land, Layers layers) {
    if (!layers.has(Layer::shelter)) {
        land.gain = LandSample{}.gain;
        land.dgain_dx = land.dgain_dz = 0.0F;
    }
    if (!layers.has(Layer::refraction)) {
        land.shift = 0;
        land.dshift_dx = land.dshift_dz = 0.0F;
    }
    if (!layers.has(Layer::orbits)) {
        land.orbit = 1.0F;
        land.dorbit_dx = land.dorbit_dz = 0.0F;
    }
    return land;
}

}  // namespace

void add_trains(Sums& acc, const LiveBox& live, const Envelope& e, LatticePoint p, Layers layers,
                std::vector<Local>& locals) {
    const PreparedBox& box = *live.box;
    const HeightModulation m = layers.has(Layer::irregular)
                                   ? modulation_at(box.record.irregular, live.irregular, p)
                                   : HeightModulation{};
    const Local open = combine(e, LandSample{}, m);
    locals.clear();
    for (const auto& field : box.fields) locals.push_back(combine(e, layered(field->sample(p), layers), m));
    const bool round = box.record.roundness != 0 && layers.has(Layer::round);
    const int64_t v = round ? box_position(box.record, live.instant, p).v : 0;
    const Axes axes = axes_of(box.record);
    for (size_t i = 0; i < box.constants.size(); ++i) {
        const int16_t field = box.field_of_train[i];
        Local local = field < 0 ? open : locals[static_cast<size_t>(field)];
        if (round) {
            const RoundShift bent =
                round_shift(box.record.roundness, box.constants[i].whole, box.record.width, v);
            local.shift += bent.shift;
            local.qx = bent.slope * -axes.uz + local.qx;
            local.qz = bent.slope * axes.ux + local.qz;
        }
        const uint32_t phase = phase_from_place(box.record.trains[i], p.x, p.z) + live.phase[i] + local.shift;
        add_train(acc, box.constants[i], local, phase);
    }
}

void add_wake(Sums& acc, const LiveBox& live, const Envelope& e, LatticePoint p) {
    const WaveTrainBox& box = live.box->record;
    const BoxPosition at = box_position(box, live.instant, p);
    const WakeSample w = wake_at(box.wake, box.length - at.u, at.v - box.width / 2, live.instant.wake_rear,
                                 live.instant.wake_front);
    const Axes axes = axes_of(box);
    add_wake_wave(acc, box.wake, box.wake.transverse, w.transverse, axes, e);
    add_wake_wave(acc, box.wake, box.wake.diverging, w.diverging, axes, e);
}

void add_noise(Sums& acc, std::span<const NoiseOctave> octaves, const Envelope& e, LatticePoint p) {
    const NoiseSample n = noise_at(octaves, p);
    const float g = gain_to_float(e.gain);
    acc.ay = g * n.height + acc.ay;
    acc.bx = -g * n.dx + acc.bx;
    acc.bz = -g * n.dz + acc.bz;
    acc.bx = -e.dg_dx * n.height + acc.bx;
    acc.bz = -e.dg_dz * n.height + acc.bz;
    acc.vy = g * n.dt + acc.vy;
}

SurfaceSample finish(const Sums& acc) {
    SurfaceSample out;
    out.ax = acc.ax;
    out.ay = acc.ay;
    out.az = acc.az;
    out.pxx = 1.0F - acc.mxx;
    out.pxz = -acc.mxz;
    out.pzx = -acc.mzx;
    out.pzz = 1.0F - acc.mzz;
    out.yx = -acc.bx;
    out.yz = -acc.bz;
    out.nx = out.yz * out.pzx - out.pzz * out.yx;
    out.ny = out.pzz * out.pxx - out.pxz * out.pzx;
    out.nz = out.pxz * out.yx - out.yz * out.pxx;
    out.vx = acc.vx;
    out.vy = acc.vy;
    out.vz = acc.vz;
    return out;
}

}  // namespace trochoid
