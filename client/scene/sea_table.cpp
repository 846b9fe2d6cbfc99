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

/// Where the rows of a box's features begin; -1 where it has none or the layers leave it out.
struct FeatureTexels {
    int irregular = -1;
    int wake = -1;
    int round = -1;
    int octaves = -1;
    int octave_count = 0;
};

/// A box at an instant as eight texels:
///   0  u of the anchor before its shift by 30 (low, high word), v alike
///   1  ux, uz (Q2.30), which sides are limited (1 along u, 2 along v), time gain (Q0.24)
///   2  reach of the axes relative to the anchor: least x, least z, greatest x, greatest z
///   3  ramps at rear, front, sides; leading edge (lattice units along u)
///   4  their reciprocals 2^40 / ramp; width (lattice units)
///   5  slopes of the ramps per metre (float bits); number of trains
///   6  ux, uz as floats (bits); texel of the first train; octaves of noise
///   7  texels of irregular heights, wake, round waves, noise; -1 = none
void append_box(std::vector<RecordTexel>& out, const WaveTrainBox& box, BoxInstant instant,
                LatticePoint anchor, int first_texel, const FeatureTexels& features) {
    const bool limited = box.length != 0 || box.width != 0;
    int64_t dx = anchor.x - instant.origin.x;
    int64_t dz = anchor.z - instant.origin.z;
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
                   first_texel, features.octave_count});
    out.push_back({features.irregular, features.wake, features.round, features.octaves});
}

/// The two wave vectors with their phases at the origin, share a/A; the same vectors in rad/m, as modulation_at takes them.
void append_irregular(std::vector<RecordTexel>& out, const IrregularHeight& irregular, SeaTime now) {
    constexpr float two_pi = 0x1.921fb6p+2F;
    const auto radians = [](int32_t k) { return bits(two_pi * (static_cast<float>(k) * 0x1p-22F)); };
    const IrregularPhases at = phases_at_origin(irregular, now);
    const float share = static_cast<float>(irregular.share) * 0x1p-15F;
    out.push_back({irregular.ukx, irregular.ukz, bits(at.u), bits(share)});
    out.push_back({irregular.vkx, irregular.vkz, bits(at.v), 0});
    out.push_back(
        {radians(irregular.ukx), radians(irregular.ukz), radians(irregular.vkx), radians(irregular.vkz)});
}

/// 2^40 / lambda0, the box's length, half of its width, how far behind the pattern ends and begins (lattice units);
/// amplitudes and chi times them (m); 1 / lambda0 and k0 as wake_at takes them; lambda0 (m).
void append_wake(std::vector<RecordTexel>& out, const WaveTrainBox& box, const BoxInstant& instant) {
    constexpr float two_pi = 0x1.921fb6p+2F;
    const ShipWake& wake = box.wake;
    const float inverse = static_cast<float>(wake.inverse_length) * 0x1p-30F;
    out.push_back(
        {bits(wake.inverse_length), clamped(box.length), clamped(box.width / 2), clamped(instant.wake_rear)});
    out.push_back({clamped(instant.wake_front), bits(wake.transverse), bits(wake.diverging), bits(inverse)});
    out.push_back({bits(wake.choppiness * wake.transverse), bits(wake.choppiness * wake.diverging),
                   bits(two_pi * inverse), bits(1.0F / inverse)});
}

/// 2^40 / width; then (wave number * roundness) >> 15 of each train, four a texel, as round_shift takes them.
void append_round(std::vector<RecordTexel>& out, const WaveTrainBox& box,
                  const std::vector<TrainConstants>& trains) {
    const uint64_t reciprocal =
        (uint64_t{1} << 40) / static_cast<uint64_t>(std::max<int64_t>(box.width, 1 << 10));
    out.push_back({bits(static_cast<uint32_t>(reciprocal)), 0, 0, 0});
    for (size_t i = 0; i < trains.size(); i += 4) {
        RecordTexel texel{};
        for (size_t j = i; j < std::min(i + 4, trains.size()); ++j)
            texel[j - i] = bits(static_cast<uint32_t>((uint64_t{trains[j].whole} * box.roundness) >> 15));
        out.push_back(texel);
    }
}

/// Hashes of the time layers before and after, log2 of the lattice step, position between the layers; its fade and the fade's
/// slope, height, slope; length of the wave that it fades like, slope variance, that of it and all finer ones.
void append_octaves(std::vector<RecordTexel>& out, const std::vector<NoiseOctave>& octaves) {
    float finer = 0.0F;
    for (const NoiseOctave& o : octaves) finer += octave_mean_square * o.slope * o.slope;
    for (const NoiseOctave& o : octaves) {
        const float variance = octave_mean_square * o.slope * o.slope;
        const float length = static_cast<float>(uint32_t{2} << o.step_log2) * 0x1p-10F;
        out.push_back({bits(o.early), bits(o.late), o.step_log2, bits(o.since)});
        out.push_back({bits(o.fade), bits(o.fade_slope), bits(o.height), bits(o.slope)});
        out.push_back({bits(length), bits(variance), bits(finer), 0});
        finer -= variance;
    }
}

FeatureTexels append_features(std::vector<RecordTexel>& features, int first_feature, const WaveTrainBox& box,
                              const std::vector<TrainConstants>& constants, const BoxInstant& instant,
                              SeaTime now, Layers layers) {
    FeatureTexels at;
    const auto next = [&] { return first_feature + static_cast<int>(features.size()); };
    if (box.irregular.share != 0 && layers.has(Layer::irregular)) {
        at.irregular = next();
        append_irregular(features, box.irregular, now);
    }
    if (has_wake(box.wake) && layers.has(Layer::wakes)) {
        at.wake = next();
        append_wake(features, box, instant);
    }
    if (box.roundness != 0 && layers.has(Layer::round)) {
        at.round = next();
        append_round(features, box, constants);
    }
    const Layer noise_layer = box.noise.displayed_only ? Layer::displayed_noise : Layer::noise;
    if (box.noise.amplitude != 0.0F && layers.has(noise_layer)) {
        const std::vector<NoiseOctave> octaves = octaves_at(box.noise, now);
        at.octaves = next();
        at.octave_count = static_cast<int>(octaves.size());
        append_octaves(features, octaves);
    }
    return at;
}

}  // namespace

void SeaTable::add_box(const std::shared_ptr<const WaveTrainBox>& record, const LandTable& land) {
    Box box;
    box.record = record;
    for (const WaveTrain& train : record->trains) {
        box.constants.push_back(derive_constants(train));
        box.fields.push_back(train.field.value == 0 ? -1 : land.row_of(*record, train.field));
        const TrainConstants& c = box.constants.back();
        box.slope_variance.push_back(0.5F * (c.k * c.a) * (c.k * c.a));
    }
    box.bounds = {static_cast<float>(height_bound(*record)),
                  static_cast<float>(displacement_bound(*record)) * land.largest_orbit()};
    box.reach = trochoid::bounds_of(*record);
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
            const Box& box = boxes_[static_cast<size_t>(entry[0] / box_row_texels)];
            const bool more = has_wake(box.record->wake) || box.record->noise.amplitude != 0.0F;
            if (entry[1] == 0 && !more) continue;
            bounds.height += box.bounds.height;
            bounds.displacement += box.bounds.displacement;
        }
        bounds_[at->second] = bounds;
    }
    return at->second;
}

void SeaTable::rebuild(const InterestState& state, const LandTable& land) {
    *this = SeaTable{};
    std::vector<ListTexel> entries;
    for (const auto& [id, record] : state.boxes) {
        entries.push_back({static_cast<int32_t>(boxes_.size()) * box_row_texels,
                           static_cast<int32_t>(record->trains.size())});
        add_box(record, land);
    }
    int texel = static_cast<int>(boxes_.size()) * box_row_texels;
    for (Box& box : boxes_) {
        box.first_texel = texel;
        texel += static_cast<int>(box.constants.size()) * train_row_texels;
    }
    add_list(entries);
    for (const auto& [key, patch] : state.patches) list_of_patch_[key] = add_list(entries_of(patch));
}

std::vector<ListTexel> SeaTable::entries_of(const PatchDescriptor& patch) const {
    std::vector<ListTexel> entries;
    const LatticeRect square = rect_of(patch.key);
    // A patch may name a box that a later piece of the delta brings; those it does not name, but which reach it, lend it the
    // roughness of their faded waves alone, so that no border shows where the server begins to leave them out.
    auto named = patch.boxes.begin();
    for (size_t i = 0; i < boxes_.size(); ++i) {
        const Box& box = boxes_[i];
        while (named != patch.boxes.end() && named->box < box.record->id) ++named;
        const bool told = named != patch.boxes.end() && named->box == box.record->id;
        if (!told && !overlap(box.reach, square)) continue;
        const int32_t trains =
            told ? std::min(static_cast<int32_t>(box.constants.size()), int32_t{named->train_count}) : 0;
        entries.push_back({static_cast<int32_t>(i) * box_row_texels, trains});
    }
    return entries;
}

std::vector<RecordTexel> wake_texels() {
    const WakeTable& table = wake_table();
    std::vector<RecordTexel> out;
    out.reserve(2 * (wake_cells + 1) + wake_root_cells + 1);
    for (const auto* nodes : {&table.transverse, &table.diverging})
        for (const WakeNode& n : *nodes) out.push_back({n.phase, n.along, n.outwards, n.gain});
    for (const int32_t root : table.root) out.push_back({root, 0, 0, 0});
    return out;
}

std::vector<RecordTexel> SeaTable::records(const LandTable& land, LatticePoint anchor, SeaTime now,
                                           Layers layers) const {
    // Features come last, yet boxes name them.
    std::vector<RecordTexel> features;
    const auto first_feature = static_cast<int>(boxes_.size()) * box_row_texels +
                               static_cast<int>(train_count_) * train_row_texels +
                               static_cast<int>(land.field_count()) * field_row_texels;
    std::vector<RecordTexel> out;
    out.reserve(boxes_.size() * box_row_texels + train_count_ * train_row_texels +
                land.field_count() * field_row_texels);
    for (const Box& box : boxes_) {
        const WaveTrainBox& record = *box.record;
        const BoxInstant instant = instant_of(record, now);
        const FeatureTexels at =
            append_features(features, first_feature, record, box.constants, instant, now, layers);
        append_box(out, record, instant, anchor, box.first_texel, at);
    }
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
    out.insert(out.end(), features.begin(), features.end());
    return out;
}

int SeaTable::list_of(PatchKey key) const {
    const auto at = list_of_patch_.find(key);
    return at == list_of_patch_.end() ? 0 : at->second;
}

WaveBounds SeaTable::bounds_of_list(int list) const {
    const auto at = bounds_.find(list);
    return at == bounds_.end() ? WaveBounds{} : at->second;
}

}  // namespace trochoid
