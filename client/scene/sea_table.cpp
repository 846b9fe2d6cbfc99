#include "client/scene/sea_table.hpp"

#include <algorithm>
#include <bit>

namespace trochoid {

namespace {

int32_t bits(float v) { return std::bit_cast<int32_t>(v); }
int32_t bits(uint32_t v) { return std::bit_cast<int32_t>(v); }

/// Anchors farther than this from a box's origin cannot see the reach of its axes (2^31 lattice units).
constexpr int64_t axes_reach = int64_t{1} << 31;

int32_t clamped(int64_t v) { return static_cast<int32_t>(std::clamp<int64_t>(v, INT32_MIN, INT32_MAX)); }

int32_t reciprocal(int32_t length) {
    return bits(static_cast<uint32_t>((uint64_t{1} << 40) / static_cast<uint64_t>(length)));
}

/// A box at an instant as seven texels:
///   0  u of the anchor before its shift by 30 (low, high word), v alike
///   1  ux, uz (Q2.30), which sides are limited (1 along u, 2 along v), time gain (Q0.24)
///   2  reach of the axes relative to the anchor: least x, least z, greatest x, greatest z
///   3  ramps at rear, front, sides; leading edge (lattice units along u)
///   4  their reciprocals 2^40 / ramp; width (lattice units)
///   5  slopes of the ramps per metre (float bits); number of trains
///   6  ux, uz as floats (bits); texel of the first train; 0
void append_box(std::vector<RecordTexel>& out, const WaveTrainBox& box, LatticePoint anchor, SeaTime now,
                int first_texel) {
    BoxInstant instant = instant_of(box, now);
    const bool limited = box.length != 0 || box.width != 0;
    int64_t dx = anchor.x - box.origin.x;
    int64_t dz = anchor.z - box.origin.z;
    const int64_t farthest = axes_reach + anchor_reach;
    if (limited && std::max(std::abs(dx), std::abs(dz)) > farthest) instant.time_gain = 0;
    if (!limited || instant.time_gain == 0) dx = dz = 0;
    const auto u = static_cast<uint64_t>(dx * box.ux + dz * box.uz);
    const auto v = static_cast<uint64_t>(dz * box.ux - dx * box.uz);
    const auto low = [](uint64_t w) { return bits(static_cast<uint32_t>(w)); };
    const auto high = [](uint64_t w) { return bits(static_cast<uint32_t>(w >> 32)); };
    const auto slope = [](int32_t ramp) { return 1024.0F / static_cast<float>(ramp); };
    out.push_back({low(u), high(u), low(v), high(v)});
    out.push_back(
        {box.ux, box.uz, (box.length != 0 ? 1 : 0) | (box.width != 0 ? 2 : 0), bits(instant.time_gain)});
    out.push_back({clamped(-axes_reach - dx), clamped(-axes_reach - dz), clamped(axes_reach - dx),
                   clamped(axes_reach - dz)});
    out.push_back({box.ramp_rear, box.ramp_front, box.ramp_side, clamped(instant.front)});
    out.push_back({reciprocal(box.ramp_rear), reciprocal(box.ramp_front), reciprocal(box.ramp_side),
                   clamped(box.width)});
    out.push_back({bits(slope(box.ramp_rear)), bits(slope(box.ramp_front)), bits(slope(box.ramp_side)),
                   static_cast<int32_t>(box.trains.size())});
    out.push_back({bits(static_cast<float>(box.ux) * 0x1p-30F), bits(static_cast<float>(box.uz) * 0x1p-30F),
                   first_texel, 0});
}

}  // namespace

void SeaTable::add_box(const std::shared_ptr<const WaveTrainBox>& record, const LandTable& land) {
    Box box;
    box.record = record;
    for (const WaveTrain& train : record->trains) {
        box.constants.push_back(derive_constants(train));
        box.fields.push_back(land.row_of(train.field));
        const TrainConstants& c = box.constants.back();
        box.slope_variance.push_back(0.5F * (c.k * c.a) * (c.k * c.a));
    }
    box.bounds = {static_cast<float>(height_bound(*record)), static_cast<float>(displacement_bound(*record))};
    train_count_ += record->trains.size();
    boxes_.push_back(std::move(box));
}

int SeaTable::add_list(const std::vector<ListTexel>& entries) {
    const auto [at, added] = list_starts_.try_emplace(entries, static_cast<int>(lists_.size()));
    if (added) {
        lists_.push_back({static_cast<int32_t>(entries.size()), 0});
        lists_.insert(lists_.end(), entries.begin(), entries.end());
        WaveBounds bounds;
        for (const ListTexel& entry : entries) {
            const WaveBounds& box = boxes_[static_cast<size_t>(entry[0] / box_row_texels)].bounds;
            bounds.height += box.height;
            bounds.displacement += box.displacement;
        }
        bounds_[at->second] = bounds;
    }
    return at->second;
}

void SeaTable::rebuild(const InterestState& state, const LandTable& land) {
    *this = SeaTable{};
    std::map<BoxId, int32_t> row_of;
    std::vector<ListTexel> entries;
    for (const auto& [id, record] : state.boxes) {
        row_of[id] = static_cast<int32_t>(boxes_.size()) * box_row_texels;
        entries.push_back({row_of[id], static_cast<int32_t>(record->trains.size())});
        add_box(record, land);
    }
    int texel = static_cast<int>(boxes_.size()) * box_row_texels;
    for (Box& box : boxes_) {
        box.first_texel = texel;
        texel += static_cast<int>(box.constants.size()) * train_row_texels;
    }
    add_list(entries);
    for (const auto& [key, patch] : state.patches) {
        entries.clear();
        for (const PatchBox& box : patch.boxes) {
            // A patch may name a box that a later piece of the delta brings.
            const auto row = row_of.find(box.box);
            if (row == row_of.end() || box.train_count == 0) continue;
            const auto known = static_cast<int32_t>(
                boxes_[static_cast<size_t>(row->second / box_row_texels)].constants.size());
            entries.push_back({row->second, std::min<int32_t>(known, box.train_count)});
        }
        list_of_patch_[key] = add_list(entries);
    }
}

std::vector<RecordTexel> SeaTable::records(const LandTable& land, LatticePoint anchor, SeaTime now) const {
    std::vector<RecordTexel> out;
    out.reserve(boxes_.size() * box_row_texels + train_count_ * train_row_texels +
                land.field_count() * field_row_texels);
    for (const Box& box : boxes_) append_box(out, *box.record, anchor, now, box.first_texel);
    // A train as three texels: kx, kz, phase at the origin (turns Q0.32), texel of its land field or -1;
    // kx, kz (rad/m), amplitude, hx (m); hz, wavelength (m), its slope variance, that of it and all shorter ones.
    const auto land_texel = static_cast<int>(out.size() + train_count_ * train_row_texels);
    for (const Box& box : boxes_) {
        std::vector<float> from_here(box.slope_variance);
        for (size_t i = from_here.size(); i-- > 1;) from_here[i - 1] += from_here[i];
        for (size_t i = 0; i < box.constants.size(); ++i) {
            const WaveTrain& train = box.record->trains[i];
            const TrainConstants& c = box.constants[i];
            const int field = box.fields[i] < 0 ? -1 : land_texel + box.fields[i] * field_row_texels;
            out.push_back({train.kx, train.kz, bits(phase_at_origin(train, now.us)), field});
            out.push_back({bits(c.kx), bits(c.kz), bits(c.a), bits(c.hx)});
            out.push_back({bits(c.hz), bits(c.wavelength), bits(box.slope_variance[i]), bits(from_here[i])});
        }
    }
    land.append_fields(out, anchor);
    return out;
}

int SeaTable::list_of(PatchKey key) const {
    const auto at = list_of_patch_.find(key);
    return at == list_of_patch_.end() ? 0 : at->second;
}

glm::vec2 SeaTable::heading_at(LatticePoint p, SeaTime now) const {
    glm::vec2 sum(0.0F);
    for (const Box& box : boxes_) {
        const Envelope e = envelope_at(*box.record, instant_of(*box.record, now), p);
        const float gain = static_cast<float>(e.gain) * 0x1p-24F;
        for (size_t i = 0; i < box.constants.size(); ++i)
            sum +=
                glm::vec2(box.constants[i].dx, box.constants[i].dz) * (gain * gain * box.slope_variance[i]);
    }
    return sum;
}

WaveBounds SeaTable::bounds_of_list(int list) const {
    const auto at = bounds_.find(list);
    return at == bounds_.end() ? WaveBounds{} : at->second;
}

}  // namespace trochoid
