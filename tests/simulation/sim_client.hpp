#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "client/store/client_store.hpp"
#include "protocol/model/interest_state.hpp"
#include "protocol/model/sea.hpp"
#include "tests/simulation/virtual_net.hpp"

namespace trochoid {

/// The real client without its thread: link, connection, store and clock, over a simulated network.
class SimClient {
public:
    SimClient(VirtualNet& net, uint16_t port, const ViewState& view, std::vector<SyncRegion> regions);
    SimClient(const SimClient&) = delete;
    SimClient& operator=(const SimClient&) = delete;
    ~SimClient();

    void look(const ViewState& view);
    void ask_regions(std::vector<SyncRegion> regions);
    /// A bit of what it holds turns over in memory; false where it holds nothing.
    bool rot();
    void leave();

    bool live() const;
    /// No more tries.
    bool ended() const;
    std::string sentence() const;
    uint32_t connections() const;
    uint32_t resumed() const;  ///< sessions that went on from what the client held
    uint64_t results() const;
    const StoreCounters& counters() const;
    /// Why its sessions ended, in words, as far as somebody has looked between two of them.
    const std::vector<std::string>& ends() const;
    LogPosition position() const;
    SeaTime watermark() const;
    /// How far the watermark has fallen without the log position falling, at worst; microseconds.
    int64_t watermark_fell_us() const;
    const CullKey& key() const;
    /// Hash of what the client holds; 0 before its first result.
    uint64_t state() const;
    const std::vector<SyncRegion>& regions() const;
    /// What it holds, in numbers.
    std::string holdings() const;
    std::vector<SurfaceSample> samples(SeaTime time, std::span<const LatticePoint> points) const;
    /// How far the client's sea time is off, microseconds, and the bound that it states.
    int64_t clock_error_us(SeaTime truth) const;
    int64_t clock_bound_us() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace trochoid
