#include "server/land/depth_table.hpp"

#include <array>

#include "protocol/model/arithmetic_rules.hpp"
#include "server/land/wide_rows.hpp"

namespace trochoid {

DepthTable::DepthTable(const DepthResponse& response)
    : deep_(static_cast<float>(response.deep())),
      untouched_(static_cast<float>(response.untouched())),
      shallowest_(static_cast<float>(response.shallowest())) {
    // Most cells lie below the shallowest depth, where nothing but breaking changes.
    const double shallowest = response.shallowest();
    const double shallowest_number = response.wave_number(shallowest);
    const double shallowest_growth = response.growth(shallowest);
    const bool flat = !response.growth_falls_to_shore();
    const auto sample = [&](uint32_t node) {
        const double depth = static_cast<double>(std::bit_cast<float>(first_bits + (node << low_bits)));
        const bool shallow = depth <= shallowest;
        const double growth = shallow && flat ? shallowest_growth : response.growth(depth);
        const double gain = response.breaking_gain(depth);
        return FourFloats{static_cast<float>(shallow ? shallowest_number : response.wave_number(depth)),
                          static_cast<float>(growth), static_cast<float>(gain),
                          static_cast<float>(DepthResponse::share_of(gain, growth))};
    };
    FourFloats here = sample(0);
    land_ = here;
    land_[2] = 0.0F;
    land_[3] = 0.0F;
    const uint32_t last_bits = std::max(std::bit_cast<uint32_t>(untouched_), first_bits);
    const uint32_t cells = ((last_bits - first_bits) >> low_bits) + 1;
    rows_.reserve(cells);
    wave_numbers_.reserve(2 * size_t{cells});
    growths_.reserve(2 * size_t{cells});
    for (uint32_t cell = 0; cell < cells; ++cell) {
        const FourFloats next = sample(cell + 1);
        rows_.push_back({here, next - here});
        const FourFloats step = rows_.back().step;
        wave_numbers_.insert(wave_numbers_.end(), {here[0], step[0]});
        growths_.insert(growths_.end(), {here[1], step[1]});
        here = next;
    }
    const auto breaks = [](const Row& row) {
        return row.value[2] != 2.0F || row.value[3] != 1.0F || row.step[2] != 0.0F || row.step[3] != 0.0F;
    };
    uint32_t unbroken = cells;
    while (unbroken > 0 && !breaks(rows_[unbroken - 1])) --unbroken;
    // One cell more: that of the limit itself.
    for (uint32_t cell = 0; cell < std::min(unbroken + 1, cells); ++cell) {
        const Row& row = rows_[cell];
        breaking_gains_.insert(breaking_gains_.end(), {row.value[2], row.step[2]});
        shares_.insert(shares_.end(), {row.value[3], row.step[3]});
    }
    breaking_ = std::min(std::bit_cast<float>(first_bits + (unbroken << low_bits)), untouched_);
}

namespace {

/// Linear between the cells of a table of pairs (value, step) that begins at the float32 of `first_bits`; from `limit` on, which
/// lies in the table, `beyond`. Depths below the table count as its first.
struct CellTable {
    const float* pairs;
    uint32_t first_bits;
    float limit;
    float beyond;
};

/// Depths at a time: their cells and places in them stay in the fastest cache.
constexpr size_t looked_up_together = 128;

struct Places {
    std::array<int32_t, looked_up_together> pair;
    std::array<float, looked_up_together> fraction;
};

TROCHOID_WIDE_ROWS void look_up_part(const CellTable& table, const float* __restrict depths, size_t count,
                                     float factor, Places& places, float* __restrict out) {
    const float* const pairs = table.pairs;
    const auto first = static_cast<int32_t>(table.first_bits);
    const auto last = std::bit_cast<int32_t>(table.limit);
    for (size_t i = 0; i < count; ++i) {
        // As integers negative depths are below all others.
        const int32_t bits = std::max(std::min(std::bit_cast<int32_t>(depths[i]), last), first);
        places.pair[i] = ((bits - first) >> 16) * 2;
        places.fraction[i] = static_cast<float>(bits & 0xffff) * 0x1p-16F;
    }
    size_t i = 0;
    for (; i + 8 <= count; i += 8) {
        const auto cell = [&](size_t n) { return pairs + places.pair[i + n]; };
        EightFloats a;
        EightFloats b;
        EightFloats fraction;
        take_pairs(cell, 0, 1, 4, 5, a);
        take_pairs(cell, 2, 3, 6, 7, b);
        std::memcpy(&fraction, places.fraction.data() + i, sizeof fraction);
        EightFloats value;
        EightFloats step;
        shuffle<0, 2, 8, 10, 4, 6, 12, 14>(a, b, value);
        shuffle<1, 3, 9, 11, 5, 7, 13, 15>(a, b, step);
        const EightFloats here = factor * (value + step * fraction);
        EightFloats depth;
        std::memcpy(&depth, depths + i, sizeof depth);
        const EightFloats chosen = depth < table.limit ? here : EightFloats{} + table.beyond;
        std::memcpy(out + i, &chosen, sizeof chosen);
    }
    for (; i < count; ++i) {
        const float* const cell = pairs + places.pair[i];
        const float here = factor * (cell[0] + cell[1] * places.fraction[i]);
        out[i] = depths[i] < table.limit ? here : table.beyond;
    }
}

TROCHOID_WIDE_ROWS void clear_land(const float* __restrict depths, size_t count, float* __restrict out) {
    for (size_t i = 0; i < count; ++i) out[i] = depths[i] > 0.0F ? out[i] : 0.0F;
}

void look_up(const CellTable& table, const float* depths, size_t count, float factor, float* out) {
    Places places;
    for (size_t i = 0; i < count; i += looked_up_together)
        look_up_part(table, depths + i, std::min(looked_up_together, count - i), factor, places, out + i);
}

}  // namespace

void DepthTable::wave_numbers(const float* depths, size_t count, float open, float* out) const {
    look_up({wave_numbers_.data(), first_bits, deep_, open}, depths, count, open, out);
}

void DepthTable::growths(const float* depths, size_t count, float* out) const {
    look_up({growths_.data(), first_bits, untouched_, 1.0F}, depths, count, 1.0F, out);
}

void DepthTable::breaking_gains(const float* depths, size_t count, float beyond, float* out) const {
    look_up({breaking_gains_.data(), first_bits, breaking_, beyond}, depths, count, 1.0F, out);
    clear_land(depths, count, out);
}

void DepthTable::shares(const float* depths, size_t count, float* out) const {
    look_up({shares_.data(), first_bits, breaking_, 1.0F}, depths, count, 1.0F, out);
    clear_land(depths, count, out);
}

}  // namespace trochoid
