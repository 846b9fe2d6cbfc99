#include "server/interest/interest_index.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

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
    int64_t orbit_squared = 0;
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
            orbit_squared = std::max(orbit_squared, steepest(block.orbit));
        }
    const double metres = to_metres(int64_t{1} << step_log2);
    const auto root = [](int64_t squared) {
        return rounding_cover * std::sqrt(static_cast<double>(squared));
    };
    const uint16_t highest = *std::max_element(block.gain.begin(), block.gain.end());
    const uint16_t flattest = *std::max_element(block.orbit.begin(), block.orbit.end());
    return {rounding_cover * highest / unit_node_gain, root(gain_squared) / unit_node_gain / metres,
            root(shift_squared) * two_pi / 65536.0 / metres, rounding_cover * flattest / unit_node_orbit,
            root(orbit_squared) / unit_node_orbit / metres};
}

/// `turn`: wave number over that of the train itself, at most, where crests are round.
void add_train(TrainSums& sums, const TrainConstants& t, double choppiness, double turn) {
    const double a = static_cast<double>(t.a) * rounding_cover;
    const double k = static_cast<double>(t.k) * turn;
    sums.a += a;
    sums.h += choppiness * a;
    sums.ka += k * a;
    sums.kh += choppiness * k * a;
}

/// Round waves add c k across the box at its sides: |k'|^2 = k^2 (1 + c^2 + 2 c |d . v|) there.
double turn_of(const WaveTrainBox& box, const TrainConstants& t) {
    const double c = static_cast<double>(box.roundness) / full_roundness;
    if (c == 0.0) return 1.0;
    const double across = (static_cast<double>(t.dz) * box.ux - static_cast<double>(t.dx) * box.uz) /
                          static_cast<double>(1 << 30);
    return rounding_cover * std::sqrt(1.0 + c * c + 2.0 * c * (across < 0.0 ? -across : across));
}

IndexedField index_field(const LandField& field) {
    IndexedField out;
    out.id = field.id();
    out.step_log2 = field.step_log2();
    // The uppermost field that has a block there counts.
    std::map<BlockKey, FieldBlock> counts;
    for (const LandField* layer = &field; layer != nullptr; layer = layer->base().get())
        for (auto& block : layer->blocks()) {
            const BlockKey key = block->key;
            counts.try_emplace(key, FieldBlock{layer->id(), field.step_log2(), std::move(block), 0});
        }
    if (counts.empty()) return out;
    BlockKey last;
    out.first = last = counts.begin()->first;
    for (auto& [key, block] : counts) {
        out.first = {std::min(out.first.x, key.x), std::min(out.first.z, key.z)};
        last = {std::max(last.x, key.x), std::max(last.z, key.z)};
        block.content = hash_of(*block.block);
        out.bounds.push_back(bounds_of(*block.block, out.step_log2));
        out.blocks.push_back(std::move(block));
    }
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

/// Irregular heights: 1 - (a/A) sin sin, whose gradient is at most a/A times both wave numbers.
void add_modulation(IndexedBox& out) {
    const IrregularHeight& i = out.sea->record.irregular;
    const double share = static_cast<double>(i.share) / full_irregularity;
    const auto wave_number = [](int32_t kx, int32_t kz) {
        return std::sqrt(square(kx) + square(kz)) * (two_pi * lattice_per_metre / 4294967296.0);
    };
    out.modulation = (1.0 + share) * rounding_cover;
    out.modulation_slope = share * (wave_number(i.ukx, i.ukz) + wave_number(i.vkx, i.vkz)) * rounding_cover;
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
        const double turn = turn_of(sea->record, t);
        add_train(out->tail[i], t, choppiness, turn);
        const int16_t index = sea->field_of_train[i];
        if (index >= 0) out->fields[static_cast<size_t>(index)].first_train = i;
        add_train(index < 0 ? out->open : out->fields[static_cast<size_t>(index)].trains, t, choppiness,
                  turn);
    }
    out->ramp_slope = ramp_slope_of(sea->record);
    add_modulation(*out);
    out->wake = wake_extra(sea->record.wake);
    out->longest_noise = longest_wave(sea->record.noise);
    if (!sea->record.noise.displayed_only) out->noise = noise_extra(sea->record.noise);
    out->height = height_bound(sea->record);
    out->displacement = out->wake.displacement + out->open.h * out->modulation;
    for (const IndexedField& field : out->fields) {
        double gain = 1.0, orbit = 1.0;
        for (const BlockBounds& b : field.bounds) {
            gain = std::max(gain, b.gain);
            orbit = std::max(orbit, b.orbit);
        }
        out->displacement += field.trains.h * gain * orbit * out->modulation;
    }
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
