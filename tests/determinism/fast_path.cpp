#include "tests/determinism/fast_path.hpp"

#include <fmt/format.h>

#include <bit>
#include <vector>

#include "protocol/model/simd/sea_grid.hpp"
#include "protocol/model/simd/vector_target.hpp"
#include "protocol/model/simd/water_batch.hpp"
#include "tests/determinism/fault.hpp"
#include "tests/determinism/places.hpp"
#include "tests/determinism/surface_fields.hpp"

namespace trochoid {
namespace {

/// Not a multiple of any vector's width, so that the last vector of a row is a part of one.
constexpr int32_t columns = 19;
constexpr int32_t rows = 3;

/// What one way of computing says of one place.
struct Answers {
    std::vector<SurfaceSample> grid;
    std::vector<WaterPoint> water;
};

LatticeGrid grid_around(LatticePoint place) {
    return {{place.x - 9 * 3511, place.z - 2903}, 3511, 2903, columns, rows};
}

Answers by_scalars(const SeaInstant& sea, const LatticeGrid& grid, std::span<const LatticePoint> places) {
    Answers answers;
    for (int32_t j = 0; j < rows; ++j)
        for (int32_t i = 0; i < columns; ++i) answers.grid.push_back(sea.evaluate(grid.at(i, j)));
    for (const LatticePoint place : places) answers.water.push_back(water_at(sea, place));
    return answers;
}

Answers by_vectors(const SeaInstant& sea, const LatticeGrid& grid, std::span<const LatticePoint> places,
                   Workers& workers) {
    Answers answers{std::vector<SurfaceSample>(grid.size()), std::vector<WaterPoint>(places.size())};
    evaluate_grid(sea, grid, std::span(answers.grid), workers);
    water_at_batch(sea, places, answers.water, workers);
    return answers;
}

/// Compares the values of one point; the first that differ are named with both.
template <class Values, size_t n>
void compare(Trace& trace, const std::array<NamedField<Values>, n>& fields, const Values& fast,
             const Values& scalar, const std::string& target) {
    for (const auto& [name, value] : fields) {
        const auto mine = std::bit_cast<uint32_t>(fast.*value);
        const auto reference = std::bit_cast<uint32_t>(scalar.*value);
        if (mine != reference)
            trace.disagree(name, fmt::format("{} computes {} ({:08x}), the scalar reference {} ({:08x})",
                                             target, fast.*value, mine, scalar.*value, reference));
    }
}

/// One place at one time, by every instruction set; the values of the best go into the trace.
class Comparison {
public:
    Comparison(Trace& trace, Workers& workers, bool spoil)
        : trace_(trace), workers_(workers), spoil_(spoil) {}

    void at(const SeaInstant& sea, LatticePoint place, SeaTime tick, bool spoil_here) {
        const LatticeGrid grid = grid_around(place);
        std::vector<LatticePoint> places;
        for (int32_t i = 0; i < columns; i += 2) places.push_back(grid.at(i, i % rows));
        const Answers scalar = by_scalars(sea, grid, places);
        bool best = true;
        for (const std::string& target : vector_targets()) {
            force_vector_target(target);
            Answers fast = by_vectors(sea, grid, places, workers_);
            if (spoil_ && spoil_here && best) fast.grid[7].ay = one_ulp_off(fast.grid[7].ay);
            look(grid, places, fast, scalar, tick, target, best);
            best = false;
        }
        force_vector_target("");
    }

private:
    void look(const LatticeGrid& grid, std::span<const LatticePoint> places, const Answers& fast,
              const Answers& scalar, SeaTime tick, const std::string& target, bool best) {
        for (size_t i = 0; i < fast.grid.size(); ++i) {
            const auto [j, column] = std::div(static_cast<int>(i), columns);
            trace_.name_place(tile_and_point(grid.at(column, j)), tick);
            compare(trace_, surface_fields, fast.grid[i], scalar.grid[i], target);
            if (!best) continue;
            trace_.mix_place();
            for (const auto& [name, value] : surface_fields) trace_.f32(name, fast.grid[i].*value);
        }
        for (size_t i = 0; i < places.size(); ++i) {
            trace_.name_place(tile_and_point(places[i]), tick);
            compare(trace_, water_fields, fast.water[i], scalar.water[i], target);
            if (fast.water[i].rest != scalar.water[i].rest)
                trace_.disagree("water.rest", fmt::format("{} finds another rest point", target));
            if (!best) continue;
            trace_.mix_place();
            for (const auto& [name, value] : water_fields) trace_.f32(name, fast.water[i].*value);
        }
    }

    Trace& trace_;
    Workers& workers_;
    bool spoil_;
};

}  // namespace

void trace_fast_path(Trace& trace, const std::string& stage, const Sea& sea, std::span<const SeaTime> ticks,
                     uint32_t threads) {
    trace.begin_stage(stage);
    Workers workers(threads);
    Comparison comparison(trace, workers, fault_in(stage));
    for (size_t i = 0; i < ticks.size(); ++i) {
        const SeaInstant instant(sea, ticks[i], i % 2 == 0 ? authoritative_layers : displayed_layers);
        const auto places = places_to_look_at(instant);
        for (const LatticePoint place : places)
            comparison.at(instant, place, ticks[i], i == 2 && place == places.front());
    }
}

std::string fast_path_targets() { return fmt::format("{}", fmt::join(vector_targets(), " ")); }

}  // namespace trochoid
