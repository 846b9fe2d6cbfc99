#include "server/net/address_crowd.hpp"

namespace trochoid {

AddressCrowd::Rank AddressCrowd::rank_of(const std::set<uint64_t>& ids) {
    return {UINT64_MAX - ids.size(), *ids.begin()};
}

void AddressCrowd::enter(const PeerAddress& address, uint64_t id) {
    std::set<uint64_t>& ids = by_address_[address];
    if (!ids.empty()) ranks_.erase(rank_of(ids));
    if (ids.insert(id).second) ++size_;
    ranks_.emplace(rank_of(ids), address);
}

void AddressCrowd::leave(const PeerAddress& address, uint64_t id) {
    const auto at = by_address_.find(address);
    if (at == by_address_.end() || !at->second.contains(id)) return;
    std::set<uint64_t>& ids = at->second;
    ranks_.erase(rank_of(ids));
    ids.erase(id);
    --size_;
    if (ids.empty())
        by_address_.erase(at);
    else
        ranks_.emplace(rank_of(ids), address);
}

std::optional<uint64_t> AddressCrowd::first_to_go() const {
    if (ranks_.empty()) return std::nullopt;
    return ranks_.begin()->first.oldest;
}

}  // namespace trochoid
