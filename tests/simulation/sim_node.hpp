#pragma once
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "protocol/model/interest_state.hpp"
#include "protocol/model/sea.hpp"
#include "tests/simulation/virtual_net.hpp"

namespace trochoid {

class SimWorld;

struct NodeKind {
    uint32_t number = 1;  ///< above 0
    Limits limits;
    std::chrono::milliseconds look_every{50};  ///< at the log
};

/// What a node's sessions came to.
struct SimCounts {
    uint64_t connections = 0;
    uint64_t started = 0;
    uint64_t open = 0;
    uint64_t ended = 0;
    uint64_t ended_without_code = 0;
    uint64_t resyncs = 0;
    uint64_t desyncs = 0;
    std::map<std::string, uint64_t> resumes;  ///< wishes to go on, by what became of them
    bool operator==(const SimCounts&) const = default;
};

/// The real server without its process: world, authority, service and sessions, over a simulated network.
class SimNode {
public:
    SimNode(VirtualNet& net, uint16_t port, SimWorld& world, const NodeKind& kind);
    SimNode(const SimNode&) = delete;
    SimNode& operator=(const SimNode&) = delete;
    /// As a process that is killed: its connections end, its memory is lost.
    ~SimNode();

    /// An admin's. `tracing_us`: what each trace of land takes that it needs.
    void command(decltype(Command::action) action, int64_t tracing_us);
    std::vector<BoxId> boxes() const;
    /// Says goodbye to everybody, as at SIGTERM; takes nobody any more.
    void drain();

    /// Hash of the state that this key stands for; 0 where the key is of another log position.
    uint64_t state_of(const CullKey& key) const;
    /// Whether a client that looks so may be served by this key.
    bool serves(const CullKey& key, const ViewState& view) const;
    std::vector<SurfaceSample> samples(SeaTime time, std::span<const LatticePoint> points) const;
    SeaTime now() const;
    uint32_t rate_q16() const;
    /// Of all that this node knows.
    uint64_t world_hash() const;
    /// Whether it would go on with a client that says to hold this for the key.
    bool resumes(const CullKey& key, uint64_t state_hash) const;
    SimCounts counts() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Once, before anything else: the server's log is not wanted.
void keep_quiet();

}  // namespace trochoid
