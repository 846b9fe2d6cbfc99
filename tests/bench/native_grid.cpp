#include "tests/bench/native_grid.hpp"

#include <memory>

#include "tests/bench/grid_case.hpp"

extern "C" double trochoid_native_grid(int trains, int points_per_side) {
    static std::unique_ptr<trochoid::GridCase> grid;
    static trochoid::Workers workers(1);
    if (!grid) grid = std::make_unique<trochoid::GridCase>(trains, points_per_side);
    grid->evaluate(workers);
    return static_cast<double>(grid->plane(1)[0]);
}
