#pragma once
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <utility>

#include "server/net/peer_address.hpp"

namespace trochoid {

/// What waits for its turn: first in, first out for one address, and the addresses one after the other, so that an address with much to
/// ask for holds up nobody but itself.
template <class T>
class FairQueue {
public:
    bool empty() const { return turns_.empty(); }
    size_t size() const { return size_; }
    void push(const PeerAddress& address, T what) {
        std::deque<T>& waiting = waiting_[address];
        if (waiting.empty()) turns_.push_back(address);
        waiting.push_back(std::move(what));
        ++size_;
    }
    std::optional<T> pop() {
        if (turns_.empty()) return std::nullopt;
        const PeerAddress address = turns_.front();
        turns_.pop_front();
        const auto at = waiting_.find(address);
        T first = std::move(at->second.front());
        at->second.pop_front();
        if (at->second.empty())
            waiting_.erase(at);
        else
            turns_.push_back(address);
        --size_;
        return first;
    }

private:
    std::map<PeerAddress, std::deque<T>> waiting_;
    std::deque<PeerAddress> turns_;  // each address of waiting_ once
    size_t size_ = 0;
};

}  // namespace trochoid
