#include "server/net/session_admission.hpp"

namespace trochoid {

namespace {

// After so long without a question an address has its whole burst again: nothing more is known of it than of a new one.
constexpr int64_t forget_us = int64_t{SessionAdmission::burst_s} * 1'000'000;

// Where too many are known; no peer has it, as no loopback address is IPv6 with such a network.
constexpr PeerAddress all_others{true, true, UINT64_MAX};

}  // namespace

SessionAdmission::Address& SessionAdmission::of(const PeerAddress& address, int64_t now_us) {
    const bool known = addresses_.contains(address);
    const PeerAddress& place = known || addresses_.size() < most_addresses ? address : all_others;
    const auto at = addresses_.try_emplace(place, Address{{per_second_, burst_s * per_second_}, now_us, {}});
    return at.first->second;
}

SessionAdmission::Verdict SessionAdmission::ask(const PeerAddress& address, uint64_t session,
                                                int64_t now_us) {
    if (per_second_ == 0) return Verdict::at_once;
    Address& known = of(address, now_us);
    if (known.waiting.size() >= size_t{most_waiting_s} * per_second_) return Verdict::never;
    known.asked_us = now_us;
    if (known.waiting.empty() && known.rate.take(now_us)) return Verdict::at_once;
    known.waiting.push_back(session);
    return Verdict::later;
}

std::vector<uint64_t> SessionAdmission::due(int64_t now_us) {
    std::vector<uint64_t> sessions;
    for (auto at = addresses_.begin(); at != addresses_.end();) {
        Address& known = at->second;
        while (!known.waiting.empty() && known.rate.take(now_us)) {
            sessions.push_back(known.waiting.front());
            known.waiting.pop_front();
            known.asked_us = now_us;
        }
        const bool forgotten = known.waiting.empty() && now_us - known.asked_us >= forget_us;
        at = forgotten ? addresses_.erase(at) : std::next(at);
    }
    return sessions;
}

}  // namespace trochoid
