#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocol/model/point_train_budget.hpp"
#include "protocol/model/simd/coarse_grid.hpp"
#include "protocol/model/view.hpp"

namespace trochoid {

/// `side` x `side` rest points, evenly over the largest square inside the disc. Nothing where the disc is too small for a lattice
/// unit between them. `side` from 2 on.
std::optional<LatticeGrid> grid_within(const SyncRegion& region, uint32_t side);

/// What a budget of point-trains buys on a grid (row A9), with what was seen of its loss.
struct BudgetAnswer {
    struct Box {
        BoxId box;
        uint32_t trains = 0;         ///< of the box
        std::vector<uint16_t> kept;  ///< indices of its record, ascending
        double longest_m = 0.0;      ///< of the kept ones; 0 where none is
        double shortest_m = 0.0;
        bool operator==(const Box&) const = default;
    };
    SeaTime time;
    size_t points = 0;
    double point_trains = 0.0;  ///< the budget
    BudgetChoice choice;
    std::vector<Box> boxes;    ///< that reach the grid, ascending id
    double height_seen = 0.0;  ///< m, largest difference of ay on the grid against everything
    /// A tenth of a millimetre is left to the rounding of float32 sums.
    bool keeps_bound() const;
};
BudgetAnswer spend_budget(const Sea& sea, SeaTime time, const LatticeGrid& grid, double point_trains);

/// What coarse evaluation of long waves (row B8) saves on a grid, and what it errs.
struct CoarseAnswer {
    SeaTime time;
    size_t points = 0;
    uint32_t trains = 0;  ///< of boxes that are not still
    CoarseOptions options;
    CoarseBound bound;
    double exact_ms = 0.0;         ///< one core, displacement and derivatives, the best of five
    double coarse_ms = 0.0;        ///< the same
    double height_seen = 0.0;      ///< m, largest difference of ay
    double horizontal_seen = 0.0;  ///< m, of ax and az
    double slope_seen = 0.0;       ///< of yx and yz
    bool keeps_bound() const {
        return height_seen <= bound.height && horizontal_seen <= bound.horizontal &&
               slope_seen <= bound.slope;
    }
};
CoarseAnswer evaluate_coarsely(const Sea& sea, SeaTime time, const LatticeGrid& grid,
                               const CoarseOptions& options);

/// For people, ended by a newline.
std::string text_of(const BudgetAnswer& answer);
std::string text_of(const CoarseAnswer& answer);
/// For programs: one JSON object each, one line.
std::string json_line(const BudgetAnswer& answer);
std::string json_line(const CoarseAnswer& answer);

}  // namespace trochoid
