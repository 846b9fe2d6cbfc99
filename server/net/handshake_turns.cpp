#include "server/net/handshake_turns.hpp"

namespace trochoid {

HandshakeTurns::Rank HandshakeTurns::rank_of(const Waiting::value_type& waiting) const {
    const auto known = begun_.find(waiting.first);
    return {known == begun_.end() ? 0 : known->second, *waiting.second.begin()};
}

void HandshakeTurns::wait(const PeerAddress& address, uint64_t id) {
    const auto at = waiting_.try_emplace(address).first;
    if (!at->second.empty()) order_.erase(rank_of(*at));
    at->second.insert(id);
    order_.emplace(rank_of(*at), address);
}

// Its rank is out of the order already.
void HandshakeTurns::drop(Waiting::iterator at, uint64_t id) {
    at->second.erase(id);
    if (at->second.empty())
        waiting_.erase(at);
    else
        order_.emplace(rank_of(*at), at->first);
}

void HandshakeTurns::forget(const PeerAddress& address, uint64_t id) {
    const auto at = waiting_.find(address);
    if (at == waiting_.end() || !at->second.contains(id)) return;
    order_.erase(rank_of(*at));
    drop(at, id);
}

std::optional<uint64_t> HandshakeTurns::next() {
    if (order_.empty()) return std::nullopt;
    const auto first = order_.begin();
    const uint64_t id = first->first.oldest;
    const auto at = waiting_.find(first->second);
    order_.erase(first);
    ++begun_[at->first];
    drop(at, id);
    return id;
}

void HandshakeTurns::forget_begun() {
    if (begun_.empty()) return;
    begun_.clear();
    order_.clear();
    for (const auto& waiting : waiting_) order_.emplace(rank_of(waiting), waiting.first);
}

}  // namespace trochoid
