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

SlotRange slots_touching(const IndexedField& field, const LatticeRect& rect) {
    const BlockRange range = blocks_touching(rect, field.step_log2);
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
bool for_blocks(const IndexedField& field, const LatticeRect& rect, Visit visit) {
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
BlockBounds bounds_over(const IndexedField& field, const LatticeRect& rect) {
    BlockBounds all{0.0, 0.0, 0.0};
    const bool whole = for_blocks(field, rect, [&](size_t block) {
        const BlockBounds& b = field.bounds[block];
        all.gain = std::max(all.gain, b.gain);
        all.gain_slope = std::max(all.gain_slope, b.gain_slope);
        all.shift_slope = std::max(all.shift_slope, b.shift_slope);
    });
    // Where no block lies the gain reads 1.
    if (!whole) all.gain = std::max(all.gain, 1.0);
    return all;
}

/// What the full sea may do on a patch: sums over boxes, their time share included.
struct SlopeBounds {
    double slope = 0.0;      ///< sum of k A g + A |grad g|
    double steepness = 0.0;  ///< sum of chi (k A g + A |grad g|)
    void add(const TrainSums& t, const BlockBounds& land, double ramp_slope, double share) {
        const double gain_slope = land.gain_slope + ramp_slope * land.gain;
        slope += share * ((t.ka + land.shift_slope * t.a) * land.gain + gain_slope * t.a);
        steepness += share * ((t.kh + land.shift_slope * t.h) * land.gain + gain_slope * t.h);
    }
};

/// What is missing on a patch.
struct Missing {
    double lift = 0.0;   ///< E, m
    double shift = 0.0;  ///< E_h, m
};

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
    if (marks.empty()) marks.resize(fields[field].blocks.size());
    for_blocks(fields[field], rect, [&](size_t block) { marks[block] = 1; });
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
                const FieldBlock& block = box.fields[f].blocks[b];
                state.blocks.emplace_hint(state.blocks.end(), FieldBlockKey{block.field, block.block->key},
                                          block);
            }
    }
}

PatchDescriptor describe(const Selection& selection, const SelectedPatch& patch, double spacing,
                         Referred& referred, uint32_t& left_out) {
    PatchDescriptor out;
    out.key = patch.key;
    const LatticeRect rect = widened(rect_of(patch.key), patch.reach);
    bool something_missing = false;
    for (const uint32_t i : selection.boxes_of(patch)) {
        const IndexedBox& box = *selection.footprints[i].box;
        const size_t kept = kept_trains(box, spacing);
        left_out += static_cast<uint32_t>(box.longest.size() - kept);
        something_missing = something_missing || box.tail[kept].a > 0.0;
        if (kept == 0) continue;
        out.boxes.push_back({box.sea->record.id, static_cast<uint16_t>(kept)});
        referred.box(i);
        for (size_t f = 0; f < box.fields.size(); ++f)
            if (box.fields[f].first_train < kept) referred.blocks(i, f, rect);
    }
    if (!something_missing) return out;

    Missing missing;
    SlopeBounds bounds;
    for (const uint32_t i : selection.boxes_of(patch)) {
        const BoxFootprint& footprint = selection.footprints[i];
        const IndexedBox& box = *footprint.box;
        double gain = box.open.a > 0.0 ? 1.0 : 0.0;
        bounds.add(box.open, {}, box.ramp_slope, footprint.share);
        for (const IndexedField& field : box.fields) {
            const BlockBounds land = bounds_over(field, rect);
            gain = std::max(gain, land.gain);
            bounds.add(field.trains, land, box.ramp_slope, footprint.share);
        }
        const TrainSums& tail = box.tail[kept_trains(box, spacing)];
        missing.lift += tail.a * gain * footprint.share;
        missing.shift += tail.h * gain * footprint.share;
    }
    const double slope = bounds.slope / (1.0 - std::min(bounds.steepness, steepness_guard));
    out.left_out = static_cast<float>(missing.lift * float_cover);
    out.height_error = static_cast<float>((missing.lift + missing.shift * slope) * float_cover);
    return out;
}

}  // namespace trochoid
