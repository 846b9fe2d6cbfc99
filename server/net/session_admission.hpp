#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "protocol/wire/rate_limit.hpp"
#include "server/net/peer_address.hpp"

namespace trochoid {

/// How fast connections of one address may begin sessions, whatever they then ask for: `per_second` on the average, four seconds' worth
/// at once; two seconds' worth more wait for their turn, first come, first served. Pure rules: no sockets, no clocks.
class SessionAdmission {
public:
    static constexpr uint32_t burst_s = 4;
    static constexpr uint32_t most_waiting_s = 2;
    /// Addresses told apart at once; what comes from more shares one place.
    static constexpr size_t most_addresses = 65'536;

    enum class Verdict : uint8_t { at_once, later, never };

    /// 0: any number, at once.
    explicit SessionAdmission(uint32_t per_second) : per_second_(per_second) {}

    /// A session of this number would begin at monotonic time now_us. `later`: `due` names it when its turn has come.
    Verdict ask(const PeerAddress& address, uint64_t session, int64_t now_us);
    /// Whose turn has come; to be called some ten times a second.
    std::vector<uint64_t> due(int64_t now_us);
    /// Addresses that are known now.
    size_t addresses() const { return addresses_.size(); }

private:
    struct Address {
        RateLimit rate;
        int64_t asked_us = 0;
        std::deque<uint64_t> waiting;
    };
    Address& of(const PeerAddress& address, int64_t now_us);

    uint32_t per_second_;
    std::map<PeerAddress, Address> addresses_;
};

}  // namespace trochoid
