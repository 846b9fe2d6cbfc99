#pragma once
#include <vector>

#include "protocol/model/interest_state.hpp"
#include "server/interest/frustum.hpp"

namespace trochoid {

/// In which order patches reach a client: by the size that an error of one metre on them has on the screen, that is by
/// nearness; patches that only the padding brought in come after what is in view.
class PatchPriority {
public:
    explicit PatchPriority(const ViewState& view);
    /// Larger goes first; above 0.
    double operator()(PatchKey key) const;

private:
    LatticePoint anchor_;
    double altitude_;
    SixPlanes planes_;
};

double priority(const PatchDescriptor& patch, const ViewState& view);
/// Highest priority first; equals by key, so the order is the same everywhere.
void sort_by_priority(std::vector<PatchDescriptor>& patches, const ViewState& view);

}  // namespace trochoid
