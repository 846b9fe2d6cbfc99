#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/net/io_loop.hpp"
#include "server/net/transport.hpp"

namespace trochoid {

/// Where to listen.
struct ListenAddresses {
    std::vector<std::string> addresses{"127.0.0.1", "::1"};
    uint16_t port = 0;  ///< 0: one that is free, the same for all addresses
    /// Other machines may come: there is TLS for them, or the operator takes the risk.
    bool off_loopback = false;
    bool operator==(const ListenAddresses&) const = default;
};

/// Accepts connections on every address given. A machine without IPv6 loses ::1 with a warning, as long as another
/// address remains. Throws OperatorError for an address that is not numeric, for one that is not loopback without
/// `off_loopback`, and for a port that is taken.
class Listener {
public:
    using Accepted = std::function<void(std::unique_ptr<Transport>)>;

    Listener(IoLoop& loop, const ListenAddresses& where, Accepted accepted);
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;
    ~Listener();

    uint16_t port() const;
    /// "127.0.0.1:4600, [::1]:4600"
    std::string text() const;
    /// Accepts nothing more and frees the port.
    void close();

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

}  // namespace trochoid
