#include "protocol/model/simd/vector_target.hpp"

#include "protocol/model/simd/highway.hpp"
// After the choice of targets.
#include <hwy/base.h>
#include <hwy/targets.h>

namespace trochoid {

std::vector<std::string> vector_targets() {
    std::vector<std::string> names;
    // HWY_TARGETS are those that this build has code for.
    for (int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1)
        names.emplace_back(hwy::TargetName(left & -left));
    return names;
}

std::string vector_target() { return vector_targets().front(); }

bool force_vector_target(const std::string& name) {
    hwy::SetSupportedTargetsForTest(0);
    bool found = name.empty();
    for (int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0 && !found; left &= left - 1) {
        if (name != hwy::TargetName(left & -left)) continue;
        hwy::SetSupportedTargetsForTest(left & -left);
        found = true;
    }
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return found;
}

}  // namespace trochoid
