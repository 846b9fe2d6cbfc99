#include "server/interest/interest_index.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

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

/// The blocks of this very field, or nullptr.
std::shared_ptr<const IndexedBlocks> blocks_of(const IndexedBox* box, const LandField* field) {
    if (box == nullptr) return nullptr;
    const auto same = [&](const IndexedField& known) { return known.land->field.get() == field; };
    const auto known = std::find_if(box->fields.begin(), box->fields.end(), same);
    return known == box->fields.end() ? nullptr : known->land;
}

/// What counts at a place of the lattice.
struct Counting {
    FieldBlock block;
    BlockBounds bounds;
};

/// The uppermost field that has a block there counts; `below` holds what counts under the field's own blocks (nullptr: all is
/// looked at).
std::map<BlockKey, Counting> counting_blocks(const LandField& field, const IndexedBlocks* below) {
    std::map<BlockKey, Counting> counts;
    for (const LandField* layer = &field; layer != nullptr; layer = layer->base().get()) {
        if (below != nullptr && below->field.get() == layer) {
            for (size_t i = 0; i < below->blocks.size(); ++i)
                counts.try_emplace(below->blocks[i].block->key, Counting{below->blocks[i], below->bounds[i]});
            break;
        }
        for (const auto& block : layer->blocks()) {
            if (counts.contains(block->key)) continue;
            counts.emplace(block->key, Counting{{layer->id(), field.step_log2(), block, hash_of(*block)},
                                                bounds_of(*block, field.step_log2())});
        }
    }
    return counts;
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

/// `blocks` gives what counts in a field.
template <class Blocks>
std::shared_ptr<const IndexedBox> index_box(const std::shared_ptr<const PreparedBox>& sea, Blocks blocks) {
    auto out = std::make_shared<IndexedBox>();
    out->sea = sea;
    for (const auto& field : sea->fields) out->fields.push_back({blocks(field), {}, 0});
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
        for (const BlockBounds& b : field.land->bounds) {
            gain = std::max(gain, b.gain);
            orbit = std::max(orbit, b.orbit);
        }
        out->displacement += field.trains.h * gain * orbit * out->modulation;
    }
    return out;
}

}  // namespace

std::shared_ptr<const IndexedBlocks> index_blocks(std::shared_ptr<const LandField> field,
                                                  const IndexedBox* before) {
    auto out = std::make_shared<IndexedBlocks>();
    const auto below = field->base() ? blocks_of(before, field->base().get()) : nullptr;
    const auto counts = counting_blocks(*field, below.get());
    out->field = std::move(field);
    if (counts.empty()) return out;
    BlockKey last;
    out->first = last = counts.begin()->first;
    for (const auto& [key, counting] : counts) {
        out->first = {std::min(out->first.x, key.x), std::min(out->first.z, key.z)};
        last = {std::max(last.x, key.x), std::max(last.z, key.z)};
        out->bounds.push_back(counting.bounds);
        out->blocks.push_back(counting.block);
    }
    out->columns = int64_t{last.x} - out->first.x + 1;
    out->rows = int64_t{last.z} - out->first.z + 1;
    out->slots.assign(static_cast<size_t>(out->columns * out->rows), -1);
    for (size_t i = 0; i < out->blocks.size(); ++i) {
        const BlockKey key = out->blocks[i].block->key;
        const int64_t slot = (int64_t{key.z} - out->first.z) * out->columns + (int64_t{key.x} - out->first.x);
        out->slots[static_cast<size_t>(slot)] = static_cast<int32_t>(i);
    }
    return out;
}

InterestIndex::InterestIndex(const WorldState& world, const InterestIndex* previous, const IndexedLand& ahead)
    : log_position_(world.log_position) {
    std::map<FieldId, std::shared_ptr<const IndexedBlocks>> made;
    for (const auto& land : ahead.fields) made.emplace(land->field->id(), land);
    // Both run by ascending id, so the previous box is found by walking along.
    size_t old = 0;
    for (const auto& [id, box] : world.boxes) {
        const IndexedBox* same_box = nullptr;
        if (previous != nullptr) {
            const auto& before = previous->boxes_;
            while (old < before.size() && before[old]->sea->record.id < id) ++old;
            if (old < before.size() && before[old]->sea == box->sea) {
                boxes_.push_back(before[old]);
                continue;
            }
            if (old < before.size() && before[old]->sea->record.id == id) same_box = before[old].get();
        }
        // A box that ends keeps its fields, and most of those of one that is succeeded serve the successor too.
        const IndexedBox* predecessor = previous == nullptr ? nullptr : previous->find(box->predecessor);
        boxes_.push_back(index_box(box->sea, [&](const std::shared_ptr<const LandField>& field) {
            if (const auto known = made.find(field->id());
                known != made.end() && known->second->field == field)
                return known->second;
            if (auto known = blocks_of(same_box, field.get())) return known;
            if (auto known = blocks_of(predecessor, field.get())) return known;
            return index_blocks(field, predecessor);
        }));
    }
    if (!world.terrain) return;
    const auto of_world = [&](const auto& minima) { return minima && minima->grid() == world.terrain; };
    if (previous != nullptr && of_world(previous->terrain_))
        terrain_ = previous->terrain_;
    else
        terrain_ =
            of_world(ahead.terrain) ? ahead.terrain : std::make_shared<const TerrainMinima>(world.terrain);
}

const IndexedBox* InterestIndex::find(BoxId box) const {
    const auto place = std::lower_bound(boxes_.begin(), boxes_.end(), box, [](const auto& known, BoxId id) {
        return known->sea->record.id < id;
    });
    return place != boxes_.end() && (*place)->sea->record.id == box ? place->get() : nullptr;
}

}  // namespace trochoid
