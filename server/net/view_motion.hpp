#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "protocol/model/view.hpp"

namespace trochoid {

/// How fast a client's camera turns, as its last views tell: they carry a velocity but no rate of turn.
class ViewMotion {
public:
    /// A view that replaces another; now_us: monotonic time at which it came.
    void take(const ViewState& before, const ViewState& after, int64_t now_us) {
        // Views that come in one read are not a turn without end.
        constexpr double least_interval_s = 0.02;
        const double dot =
            static_cast<double>(before.qx) * after.qx + static_cast<double>(before.qy) * after.qy +
            static_cast<double>(before.qz) * after.qz + static_cast<double>(before.qw) * after.qw;
        const double angle = 2.0 * std::acos(std::min(1.0, std::abs(dot)));
        const double interval_s = static_cast<double>(now_us - taken_us_) * 1e-6;
        turn_ = taken_us_ == 0 ? 0.0 : angle / std::max(interval_s, least_interval_s);
        taken_us_ = now_us;
    }
    /// rad/s; 0 after a second without views, which come on change only.
    double turn(int64_t now_us) const { return now_us - taken_us_ > 1'000'000 ? 0.0 : turn_; }

private:
    int64_t taken_us_ = 0;
    double turn_ = 0.0;
};

}  // namespace trochoid
