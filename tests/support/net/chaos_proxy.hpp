#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "tests/support/net/chaos_schedule.hpp"

namespace trochoid {

/// What became of a connection through a proxy.
struct ProxiedConnection {
    uint64_t number = 0;
    ConnectionFaults faults;
    int64_t accepted_us = 0;  ///< on the monotonic clock
    uint64_t bytes_up = 0;    ///< delivered
    uint64_t bytes_down = 0;
    bool over = false;
    std::optional<CutKind> cut;  ///< by us
    bool operator==(const ProxiedConnection&) const = default;
};

/// A TCP proxy on loopback, with a thread of its own, that makes its connections suffer. All members may be called from any
/// thread.
class ChaosProxy {
public:
    /// Towards the server at this port of 127.0.0.1.
    ChaosProxy(uint16_t server_port, ChaosSchedule schedule);
    ChaosProxy(const ChaosProxy&) = delete;
    ChaosProxy& operator=(const ChaosProxy&) = delete;
    /// Ends every connection.
    ~ChaosProxy();

    uint16_t port() const;
    /// For connections that come from now on; they are still counted on.
    void set(const ChaosSchedule& schedule);
    /// Connections that come from now on go to another server.
    void lead_to(uint16_t server_port);
    /// Cuts all that stand.
    void cut_all(CutKind kind);
    /// Of all connections, oldest first.
    std::vector<ProxiedConnection> connections() const;

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

}  // namespace trochoid
