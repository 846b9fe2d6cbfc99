#include "server/interest/interest_index.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "protocol/model/arithmetic_rules.hpp"

namespace trochoid {

namespace {

constexpr double two_pi = 0x1.921fb54442d18p+2;
/// Covers the roundings of the float32 evaluation that a bound is compared with.
constexpr double rounding_cover = 1.0001;

double square(double v) { return v * v; }

BlockBounds bounds_of(const LandBlock& block, uint8_t step_log2) {
    // Inside a cell the bilinear gradient lies between those on its edges.
    int64_t shift_squared = 0;
    int64_t gain_squared = 0;
    for (size_t row = 0; row < block_cells; ++row)
        for (size_t column = 0; column < block_cells; ++column) {
            const size_t nw = row * block_nodes + column;
            const size_t sw = nw + block_nodes;
            const auto steepest = [&](const auto& v) {
                const auto step = [&](size_t a, size_t b) { return std::abs(int64_t{v[b]} - int64_t{v[a]}); };
                const int64_t x = std::max(step(nw, nw + 1), step(sw, sw + 1));
                const int64_t z = std::max(step(nw, sw), step(nw + 1, sw + 1));
                return x * x + z * z;
            };
            shift_squared = std::max(shift_squared, steepest(block.shift));
            gain_squared = std::max(gain_squared, steepest(block.gain));
        }
    const double metres = to_metres(int64_t{1} << step_log2);
    const uint16_t highest = *std::max_element(block.gain.begin(), block.gain.end());
    return {rounding_cover * highest / unit_node_gain,
            rounding_cover * std::sqrt(static_cast<double>(gain_squared)) / unit_node_gain / metres,
            rounding_cover * std::sqrt(static_cast<double>(shift_squared)) * two_pi / 65536.0 / metres};
}

void add_train(TrainSums& sums, const TrainConstants& t, double choppiness) {
    const double a = static_cast<double>(t.a) * rounding_cover;
    const double k = static_cast<double>(t.k);
    sums.a += a;
    sums.h += choppiness * a;
    sums.ka += k * a;
    sums.kh += choppiness * k * a;
}

IndexedField index_field(const LandField& field) {
    IndexedField out;
    out.id = field.id();
    out.step_log2 = field.step_log2();
    BlockKey last;
    for (auto& block : field.blocks()) {
        const BlockKey key = block->key;
        if (out.blocks.empty()) out.first = last = key;
        out.first = {std::min(out.first.x, key.x), std::min(out.first.z, key.z)};
        last = {std::max(last.x, key.x), std::max(last.z, key.z)};
        out.bounds.push_back(bounds_of(*block, field.step_log2()));
        const uint64_t content = hash_of(*block);
        out.blocks.push_back({field.id(), field.step_log2(), std::move(block), content});
    }
    if (out.blocks.empty()) return out;
    out.columns = int64_t{last.x} - out.first.x + 1;
    out.rows = int64_t{last.z} - out.first.z + 1;
    out.slots.assign(static_cast<size_t>(out.columns * out.rows), -1);
    for (size_t i = 0; i < out.blocks.size(); ++i) {
        const BlockKey key = out.blocks[i].block->key;
        const int64_t slot = (int64_t{key.z} - out.first.z) * out.columns + (int64_t{key.x} - out.first.x);
        out.slots[static_cast<size_t>(slot)] = static_cast<int32_t>(i);
    }
    return out;
}

/// Largest gradient of the product of the four side ramps, 1/m.
double ramp_slope_of(const WaveTrainBox& box) {
    const double along =
        box.length == 0 ? 0.0 : 1.0 / to_metres(box.ramp_rear) + 1.0 / to_metres(box.ramp_front);
    const double across = box.width == 0 ? 0.0 : 2.0 / to_metres(box.ramp_side);
    return std::sqrt(square(along) + square(across)) * rounding_cover;
}

std::shared_ptr<const IndexedBox> index_box(const std::shared_ptr<const PreparedBox>& sea) {
    auto out = std::make_shared<IndexedBox>();
    out->sea = sea;
    for (const auto& field : sea->fields) out->fields.push_back(index_field(*field));
    const size_t count = sea->constants.size();
    out->longest.resize(count);
    out->tail.resize(count + 1);
    double longest = 0.0;
    for (size_t i = count; i-- > 0;) {
        const TrainConstants& t = sea->constants[i];
        const double choppiness = static_cast<double>(sea->record.trains[i].choppiness);
        longest = std::max(longest, static_cast<double>(t.wavelength));
        out->longest[i] = longest;
        out->tail[i] = out->tail[i + 1];
        add_train(out->tail[i], t, choppiness);
        const int16_t index = sea->field_of_train[i];
        if (index >= 0) out->fields[static_cast<size_t>(index)].first_train = i;
        add_train(index < 0 ? out->open : out->fields[static_cast<size_t>(index)].trains, t, choppiness);
    }
    out->ramp_slope = ramp_slope_of(sea->record);
    out->gain_max = static_cast<double>(sea->record.gain_max) / unit_node_gain;
    return out;
}

}  // namespace

InterestIndex::InterestIndex(const WorldState& world, const InterestIndex* previous)
    : log_position_(world.log_position) {
    // Both run by ascending id, so the previous box is found by walking along.
    size_t old = 0;
    for (const auto& [id, box] : world.boxes) {
        std::shared_ptr<const IndexedBox> known;
        if (previous != nullptr) {
            const auto& before = previous->boxes_;
            while (old < before.size() && before[old]->sea->record.id < id) ++old;
            if (old < before.size() && before[old]->sea == box->sea) known = before[old];
        }
        boxes_.push_back(known ? known : index_box(box->sea));
    }
    if (!world.terrain) return;
    const bool same =
        previous != nullptr && previous->terrain_ && previous->terrain_->grid() == world.terrain;
    terrain_ = same ? previous->terrain_ : std::make_shared<const TerrainMinima>(world.terrain);
}

}  // namespace trochoid
