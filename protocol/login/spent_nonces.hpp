#pragma once
#include <cstddef>
#include <map>
#include <set>
#include <utility>

#include "protocol/login/nonce.hpp"

namespace trochoid {

/// What was used and may not be used again, until it would be refused for its age anyway. Bounded: when full it takes no
/// more rather than forget. What it answers depends on nothing but what it was told.
class SpentNonces {
public:
    enum class Outcome : uint8_t {
        first_time,
        used_before,
        too_old,  ///< its time is over, by this call's clock or an earlier one's
        full,
    };

    explicit SpentNonces(size_t most = 65'536) : most_(most) {}

    /// Uses it up. `until`: the last moment at which it might be accepted again. A clock that was set back makes nothing
    /// good again that was forgotten.
    Outcome spend(const Nonce& nonce, UnixSeconds until, UnixSeconds now);
    size_t size() const { return until_.size(); }

private:
    void forget_before(UnixSeconds now);

    size_t most_;
    UnixSeconds newest_;  // the latest clock seen
    std::map<Nonce, UnixSeconds> until_;
    std::set<std::pair<UnixSeconds, Nonce>> by_age_;  // the same, first to go first
};

}  // namespace trochoid
