#pragma once
#include <cstdint>

#include "protocol/model/displayed.hpp"
#include "protocol/model/interest_state.hpp"
#include "protocol/model/sea.hpp"

namespace trochoid {

/// What of the sea is shown at a place, and what that loses (rows A9, B6).
struct TrainAccount {
    uint32_t shown = 0;      ///< trains with some share in the picture
    uint32_t known = 0;      ///< trains that reach the patch
    double lost_m = 0;       ///< bound of what the picture's filter takes off: sum of A * g_max * (1 - share)
    double best_lost_m = 0;  ///< what the best choice of as many trains would lose (point_train_budget)
    bool best_proven = true;       ///< no other choice of as many loses less
    double server_left_out_m = 0;  ///< bound of what the server has not sent for this patch
    double patch_side_m = 0;       ///< 0: no patch is known here
    bool operator==(const TrainAccount&) const = default;
};

/// The layers that have something to show in a sea: no wakes without ships, no noise without its octaves.
Layers layers_in(const InterestState& state);

/// Looks at the patch that holds `place`, during the second after `now`, for vertices `spacing_m` apart.
TrainAccount account_of(const InterestState& state, LatticePoint place, SeaTime now, float spacing_m,
                        Layers layers);

}  // namespace trochoid
