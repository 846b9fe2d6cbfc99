#include "protocol/model/sea.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/model/sincos.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {

namespace {

/// Accumulators of the ordered sum. Every update is acc = (coefficient * value) + acc, each rounded on its own.
struct Sums {
    float ax = 0.0F, ay = 0.0F, az = 0.0F;
    float bx = 0.0F, bz = 0.0F;
    float mxx = 0.0F, mxz = 0.0F, mzx = 0.0F, mzz = 0.0F;
    float vx = 0.0F, vy = 0.0F, vz = 0.0F;
};

/// Gain and shift of one field (or none) at the point, already combined with the box's envelope.
struct Local {
    uint32_t shift = 0;
    float g = 0.0F;              // gain
    float gx = 0.0F, gz = 0.0F;  // gradient of the gain, 1/m
    float qx = 0.0F, qz = 0.0F;  // gradient of the shift, rad/m
};

/// 24 significant bits at most, so the conversion is exact on every device.
float gain_to_float(uint32_t gain) { return static_cast<float>(gain >> 2) * 0x1p-22F; }

Local combine(const Envelope& e, const LandSample& land) {
    Local l;
    l.shift = land.shift;
    l.g = gain_to_float(static_cast<uint32_t>((static_cast<uint64_t>(e.gain) * land.gain) >> 24));
    const float box_gain = gain_to_float(e.gain);
    const float land_gain = gain_to_float(land.gain);
    l.gx = e.dg_dx * land_gain + box_gain * land.dgain_dx;
    l.gz = e.dg_dz * land_gain + box_gain * land.dgain_dz;
    l.qx = land.dshift_dx;
    l.qz = land.dshift_dz;
    return l;
}

void add_train(Sums& acc, const TrainConstants& t, const Local& l, uint32_t phase) {
    const SinCos wave = sincos_turns(phase);
    const float s = l.g * wave.sin;
    const float c = l.g * wave.cos;
    // Wave vector of the phase as evaluated: refraction turns the derivatives, the displacement keeps d.
    const float kx = t.kx + l.qx;
    const float kz = t.kz + l.qz;
    acc.ax = t.hx * s + acc.ax;
    acc.ay = t.a * c + acc.ay;
    acc.az = t.hz * s + acc.az;
    acc.bx = (t.a * kx) * s + acc.bx;
    acc.bz = (t.a * kz) * s + acc.bz;
    acc.mxx = (t.hx * kx) * c + acc.mxx;
    acc.mxz = (t.hx * kz) * c + acc.mxz;
    acc.mzx = (t.hz * kx) * c + acc.mzx;
    acc.mzz = (t.hz * kz) * c + acc.mzz;
    if (l.gx != 0.0F || l.gz != 0.0F) {
        acc.bx = (t.a * -l.gx) * wave.cos + acc.bx;
        acc.bz = (t.a * -l.gz) * wave.cos + acc.bz;
        acc.mxx = (t.hx * l.gx) * wave.sin + acc.mxx;
        acc.mxz = (t.hx * l.gz) * wave.sin + acc.mxz;
        acc.mzx = (t.hz * l.gx) * wave.sin + acc.mzx;
        acc.mzz = (t.hz * l.gz) * wave.sin + acc.mzz;
    }
    acc.vx = (t.omega * t.hx) * c + acc.vx;
    acc.vy = (t.omega * t.a) * s + acc.vy;
    acc.vz = (t.omega * t.hz) * c + acc.vz;
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

}  // namespace

std::shared_ptr<const PreparedBox> prepare(WaveTrainBox record,
                                           std::span<const std::shared_ptr<const LandField>> fields) {
    auto box = std::make_shared<PreparedBox>();
    for (const WaveTrain& train : record.trains) {
        box->constants.push_back(derive_constants(train));
        int16_t index = -1;
        if (train.field.value != 0) {
            const auto same = [&](const auto& f) { return f->id() == train.field; };
            const auto known = std::find_if(box->fields.begin(), box->fields.end(), same);
            const auto given = std::find_if(fields.begin(), fields.end(), same);
            if (known != box->fields.end()) {
                index = static_cast<int16_t>(known - box->fields.begin());
            } else if (given != fields.end()) {
                index = static_cast<int16_t>(box->fields.size());
                box->fields.push_back(*given);
            }
        }
        box->field_of_train.push_back(index);
    }
    box->record = std::move(record);
    return box;
}

Sea::Sea(std::vector<std::shared_ptr<const PreparedBox>> boxes) : boxes_(std::move(boxes)) {
    std::sort(boxes_.begin(), boxes_.end(),
              [](const auto& a, const auto& b) { return a->record.id < b->record.id; });
    for (size_t i = 1; i < boxes_.size(); ++i)
        TROCHOID_ASSERT(boxes_[i - 1]->record.id < boxes_[i]->record.id, "box {} twice",
                        boxes_[i]->record.id.value);
}

SeaInstant::SeaInstant(const Sea& sea, SeaTime t) : time_(t) {
    for (const auto& box : sea.boxes()) {
        const BoxInstant instant = instant_of(box->record, t);
        if (instant.time_gain == 0) continue;
        Live live{box, instant, {}};
        live.phase.reserve(box->record.trains.size());
        for (const WaveTrain& train : box->record.trains) live.phase.push_back(phase_at_origin(train, t.us));
        live_.push_back(std::move(live));
    }
}

SurfaceSample SeaInstant::evaluate(LatticePoint p) const {
    Sums acc;
    std::vector<Local> locals;
    for (const Live& live : live_) {
        const PreparedBox& box = *live.box;
        const Envelope e = envelope_at(box.record, live.instant, p);
        if (e.gain == 0) continue;
        const Local open = combine(e, LandSample{});
        locals.clear();
        for (const auto& field : box.fields) locals.push_back(combine(e, field->sample(p)));
        for (size_t i = 0; i < box.constants.size(); ++i) {
            const int16_t field = box.field_of_train[i];
            const Local& local = field < 0 ? open : locals[static_cast<size_t>(field)];
            const uint32_t phase =
                phase_from_place(box.record.trains[i], p.x, p.z) + live.phase[i] + local.shift;
            add_train(acc, box.constants[i], local, phase);
        }
    }
    return finish(acc);
}

uint64_t hash_of(std::span<const SurfaceSample> samples) {
    Hash64 hash;
    for (const SurfaceSample& s : samples)
        for (const float v :
             {s.ax, s.ay, s.az, s.pxx, s.pxz, s.pzx, s.pzz, s.yx, s.yz, s.nx, s.ny, s.nz, s.vx, s.vy, s.vz})
            hash.f32(v);
    return hash.value();
}

}  // namespace trochoid
