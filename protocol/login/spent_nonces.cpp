#include "protocol/login/spent_nonces.hpp"

#include <algorithm>

namespace trochoid {

void SpentNonces::forget_before(UnixSeconds now) {
    while (!by_age_.empty() && by_age_.begin()->first < now) {
        until_.erase(by_age_.begin()->second);
        by_age_.erase(by_age_.begin());
    }
}

SpentNonces::Outcome SpentNonces::spend(const Nonce& nonce, UnixSeconds until, UnixSeconds now) {
    newest_ = std::max(newest_, now);
    forget_before(newest_);
    if (until < newest_) return Outcome::too_old;
    if (until_.contains(nonce)) return Outcome::used_before;
    if (until_.size() >= most_) return Outcome::full;
    until_.emplace(nonce, until);
    by_age_.emplace(until, nonce);
    return Outcome::first_time;
}

}  // namespace trochoid
