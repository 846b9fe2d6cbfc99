#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "protocol/model/interest_state.hpp"
#include "protocol/model/sea.hpp"
#include "tests/simulation/virtual_net.hpp"

namespace trochoid {

class InMemoryEventLog;

/// What all nodes of a simulated world have in common: its log and its name.
class SimWorld {
public:
    SimWorld();
    SimWorld(const SimWorld&) = delete;
    SimWorld& operator=(const SimWorld&) = delete;
    ~SimWorld();
    InMemoryEventLog& log() { return *log_; }
    uint64_t events() const;

private:
    std::unique_ptr<InMemoryEventLog> log_;
};

/// What a node's sessions came to.
struct SimCounts {
    uint64_t connections = 0;
    uint64_t started = 0;
    uint64_t open = 0;
    uint64_t ended = 0;
    uint64_t ended_without_code = 0;
    uint64_t resyncs = 0;
    std::map<std::string, uint64_t> resumes;  ///< wishes to go on, by what became of them
    bool operator==(const SimCounts&) const = default;
};

/// The real server without its process: world, authority, service and sessions, over a simulated network.
class SimNode {
public:
    /// `number`: above 0, another one in each life of each node.
    SimNode(VirtualNet& net, uint16_t port, SimWorld& world, uint32_t number);
    SimNode(const SimNode&) = delete;
    SimNode& operator=(const SimNode&) = delete;
    /// As a process that is killed: its connections end, its memory is lost.
    ~SimNode();

    /// A director changes the sea: a wind of a few trains, or the end of one. True where it was done.
    bool change_sea(uint64_t dice);
    /// Says goodbye to everybody, as at SIGTERM; takes nobody any more.
    void drain();

    /// Hash of the state that this key stands for; 0 where the key is of another log position.
    uint64_t state_of(const CullKey& key) const;
    /// Whether a client that looks so may be served by this key.
    bool serves(const CullKey& key, const ViewState& view) const;
    std::vector<SurfaceSample> samples(SeaTime time, std::span<const LatticePoint> points) const;
    SeaTime now() const;
    SimCounts counts() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Once, before anything else: the server's log is not wanted.
void keep_quiet();

}  // namespace trochoid
