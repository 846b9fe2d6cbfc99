#include "server/interest/wave_train_filter.hpp"

#include <algorithm>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/model/displayed.hpp"

namespace trochoid {

namespace {

/// Largest steepness that the world lets boxes reach together (model: "Sum over trains").
constexpr double steepness_guard = 0.8;
/// A client's distances and wavelengths are float32: a train this much below the limit is surely weightless there too.
constexpr double weightless_margin = 1.001;
/// Makes rounding a bound to float32 round up.
constexpr double float_cover = 1.000001;

struct SlotRange {
    int64_t first_column = 0, last_column = -1, first_row = 0, last_row = -1;
    bool whole = false;  ///< nothing of the rectangle lies outside the window
};

SlotRange slots_touching(const IndexedBlocks& field, const LatticeRect& rect) {
    const BlockRange range = blocks_touching(rect, field.field->step_log2());
    SlotRange s{int64_t{range.first.x} - field.first.x, int64_t{range.last.x} - field.first.x,
                int64_t{range.first.z} - field.first.z, int64_t{range.last.z} - field.first.z, false};
    s.whole =
        s.first_column >= 0 && s.first_row >= 0 && s.last_column < field.columns && s.last_row < field.rows;
    s.first_column = std::max<int64_t>(s.first_column, 0);
    s.first_row = std::max<int64_t>(s.first_row, 0);
    s.last_column = std::min(s.last_column, field.columns - 1);
    s.last_row = std::min(s.last_row, field.rows - 1);
    return s;
}

/// Calls visit(index of block) for every block that touches the rectangle; false where a part of it has none.
template <class Visit>
bool for_blocks(const IndexedBlocks& field, const LatticeRect& rect, Visit visit) {
    const SlotRange range = slots_touching(field, rect);
    bool whole = range.whole;
    for (int64_t row = range.first_row; row <= range.last_row; ++row)
        for (int64_t column = range.first_column; column <= range.last_column; ++column) {
            const int32_t block = field.slots[static_cast<size_t>(row * field.columns + column)];
            if (block < 0)
                whole = false;
            else
                visit(static_cast<size_t>(block));
        }
    return whole;
}

/// Largest gain and gradients of the field over the rectangle.
BlockBounds bounds_over(const IndexedBlocks& field, const LatticeRect& rect) {
    BlockBounds all{0.0, 0.0, 0.0, 0.0, 0.0};
    const bool whole = for_blocks(field, rect, [&](size_t block) {
        const BlockBounds& b = field.bounds[block];
        all.gain = std::max(all.gain, b.gain);
        all.gain_slope = std::max(all.gain_slope, b.gain_slope);
        all.shift_slope = std::max(all.shift_slope, b.shift_slope);
        all.orbit = std::max(all.orbit, b.orbit);
        all.orbit_slope = std::max(all.orbit_slope, b.orbit_slope);
    });
    // Where no block lies gain and orbit read 1.
    if (!whole) {
        all.gain = std::max(all.gain, 1.0);
        all.orbit = std::max(all.orbit, 1.0);
    }
    return all;
}

/// What the full sea may do on a patch: sums over boxes, their time share included. With the gain g of envelope, land and
/// irregular heights and the orbit o: |grad y| <= k A g + A |grad g|, |grad a| <= chi (k A g o + A |grad (g o)|).
struct SlopeBounds {
    double slope = 0.0;
    double steepness = 0.0;
    void add(const TrainSums& t, const BlockBounds& land, const IndexedBox& box, double share) {
        const double gain = land.gain * box.modulation;
        const double gain_slope = (land.gain_slope + box.ramp_slope * land.gain) * box.modulation +
                                  land.gain * box.modulation_slope;
        const double orbit_slope = gain_slope * land.orbit + gain * land.orbit_slope;
        slope += share * ((t.ka + land.shift_slope * t.a) * gain + gain_slope * t.a);
        steepness += share * ((t.kh + land.shift_slope * t.h) * gain * land.orbit + orbit_slope * t.h);
    }
    void add(const ExtraBounds& extra, double ramp_slope, double share) {
        slope += share * (extra.slope + ramp_slope * extra.height);
        steepness += share * (extra.steepness + ramp_slope * extra.displacement);
    }
};

/// What is missing on a patch.
struct Missing {
    double lift = 0.0;   ///< E, m
    double shift = 0.0;  ///< E_h, m
};

bool shows(double longest_wave, double spacing) {
    return longest_wave > static_cast<double>(spacings_of_first_show) * spacing / weightless_margin;
}

/// What a patch is told of a box: its first trains, and with a box that is named its wake, its noise and its hull.
struct Told {
    size_t trains = 0;
    bool named = false;
};
Told told_of(const IndexedBox& box, double spacing) {
    const size_t trains = kept_trains(box, spacing);
    // A hull may be as short as half a pixel.
    const double hull = 4.0 * static_cast<double>(box.sea->record.hull.length);
    return {trains, trains > 0 || shows(box.wake.longest, spacing) || shows(box.longest_noise, spacing) ||
                        shows(hull, spacing)};
}

LatticeRect widened(const LatticeRect& r, double metres) {
    const int64_t by = to_lattice(metres) + 1;
    return {{r.min.x - by, r.min.z - by}, {r.max.x + by, r.max.z + by}};
}

}  // namespace

size_t kept_trains(const IndexedBox& box, double spacing) {
    const double limit = static_cast<double>(spacings_of_first_show) * spacing / weightless_margin;
    const auto weightless =
        std::partition_point(box.longest.begin(), box.longest.end(), [=](double w) { return w > limit; });
    const auto count = static_cast<size_t>(weightless - box.longest.begin());
    const size_t group = filter_group(box.longest.size());
    return std::min((count + group - 1) / group * group, box.longest.size());
}

Referred::Referred(const InterestIndex& index)
    : index_(index), boxes_(index.boxes().size()), marks_(index.boxes().size()) {}

void Referred::blocks(size_t box, size_t field, const LatticeRect& rect) {
    const auto& fields = index_.boxes()[box]->fields;
    if (marks_[box].empty()) marks_[box].resize(fields.size());
    auto& marks = marks_[box][field];
    if (marks.empty()) marks.resize(fields[field].land->blocks.size());
    for_blocks(*fields[field].land, rect, [&](size_t block) { marks[block] = 1; });
}

void Referred::collect(InterestState& state) const {
    for (size_t i = 0; i < boxes_.size(); ++i) {
        const IndexedBox& box = *index_.boxes()[i];
        if (boxes_[i] != 0)
            state.boxes.emplace_hint(state.boxes.end(), box.sea->record.id,
                                     std::shared_ptr<const WaveTrainBox>(box.sea, &box.sea->record));
        for (size_t f = 0; f < marks_[i].size(); ++f)
            for (size_t b = 0; b < marks_[i][f].size(); ++b) {
                if (marks_[i][f][b] == 0) continue;
                const FieldBlock& block = box.fields[f].land->blocks[b];
                state.blocks.emplace_hint(state.blocks.end(), FieldBlockKey{block.field, block.block->key},
                                          block);
            }
    }
}

PatchDescriptor describe(const Selection& selection, const SelectedPatch& patch, double spacing,
                         Referred& referred, LeftOut& left_out) {
    PatchDescriptor out;
    out.key = patch.key;
    const LatticeRect rect = widened(rect_of(patch.key), patch.reach);
    bool something_missing = false;
    for (const uint32_t i : selection.boxes_of(patch)) {
        const IndexedBox& box = *selection.footprints[i].box;
        const Told told = told_of(box, spacing);
        // A ship that lies still has a train that adds nothing.
        const bool less = box.tail[told.trains].a > 0.0;
        left_out.trains += less ? static_cast<uint32_t>(box.longest.size() - told.trains) : 0U;
        something_missing = something_missing || less;
        if (!told.named) {
            const WaveTrainBox& record = box.sea->record;
            left_out.wakes += has_wake(record.wake) ? 1U : 0U;
            left_out.noises += record.noise.amplitude != 0.0F ? 1U : 0U;
            something_missing = something_missing || box.wake.height + box.noise.height > 0.0;
            continue;
        }
        out.boxes.push_back({box.sea->record.id, static_cast<uint16_t>(told.trains)});
        referred.box(i);
        for (size_t f = 0; f < box.fields.size(); ++f)
            if (box.fields[f].first_train < told.trains) referred.blocks(i, f, rect);
    }
    if (!something_missing) return out;

    Missing missing;
    SlopeBounds bounds;
    for (const uint32_t i : selection.boxes_of(patch)) {
        const BoxFootprint& footprint = selection.footprints[i];
        const IndexedBox& box = *footprint.box;
        const double share = footprint.share;
        double gain = box.open.a > 0.0 ? 1.0 : 0.0;
        double orbit = 1.0;
        bounds.add(box.open, {}, box, share);
        for (const IndexedField& field : box.fields) {
            const BlockBounds land = bounds_over(*field.land, rect);
            gain = std::max(gain, land.gain);
            orbit = std::max(orbit, land.orbit);
            bounds.add(field.trains, land, box, share);
        }
        bounds.add(box.wake, box.ramp_slope, share);
        bounds.add(box.noise, box.ramp_slope, share);
        const Told told = told_of(box, spacing);
        const TrainSums& tail = box.tail[told.trains];
        missing.lift += tail.a * gain * box.modulation * share;
        missing.shift += tail.h * gain * orbit * box.modulation * share;
        if (told.named) continue;
        missing.lift += (box.wake.height + box.noise.height) * share;
        missing.shift += (box.wake.displacement + box.noise.displacement) * share;
    }
    const double slope = bounds.slope / (1.0 - std::min(bounds.steepness, steepness_guard));
    out.left_out = static_cast<float>(missing.lift * float_cover);
    out.height_error = static_cast<float>((missing.lift + missing.shift * slope) * float_cover);
    return out;
}

}  // namespace trochoid
