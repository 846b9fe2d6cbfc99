#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "client/net/endpoint.hpp"
#include "client/scene/scene_input.hpp"
#include "client/store/client_store.hpp"
#include "protocol/units/result.hpp"

namespace trochoid {

struct SessionOptions {
    Endpoint server;
    std::string software;  ///< name and version for the hello
    /// Asked for a token before each connection, on the network thread; none, or an empty token: viewer.
    std::function<std::string()> fresh_token;
    std::string world;  ///< empty: whichever the server has
    ViewState view;
    std::vector<SyncRegion> regions;
    bool reconnect = true;  ///< false: the first end of the connection is the session's
};

enum class LinkState : uint8_t {
    connecting,
    live,     ///< hellos exchanged
    waiting,  ///< the server is gone; another try follows
    ended,    ///< no more tries: the server refused us, or reconnect is off
};

/// What a session tells about itself.
struct SessionStatistics {
    LinkState state = LinkState::connecting;
    std::string sentence;  ///< the state for people: "connected", "server gone …, trying again in 2 s"
    std::string server_version;   ///< as the server's hello named it, empty before
    uint64_t bytes_received = 0;  ///< on the socket, over all connections
    uint64_t bytes_sent = 0;
    double bytes_per_second = 0.0;  ///< received, over the last three seconds
    int64_t clock_error_us = 0;     ///< bound of the sea clock's error, microseconds of real time
    int64_t round_trip_us = 0;
    Fidelity fidelity = Fidelity::unknown;
    StoreCounters store;
    uint64_t log_position = 0;
    float error_in_force_px = 1.0F;
    uint32_t connections = 0;  ///< that reached a server's hello
    uint64_t views_sent = 0;
};

/// Called once, on the network thread, with the answer or why there is none.
template <class Reply>
using AnswerTo = std::function<void(Result<Reply>)>;

/// A client's place in a running sea: joins connection, store and clock on a network thread of its own, connects again
/// when the server goes, and answers from any thread. What has been told survives the server.
class OceanSession {
public:
    /// Starts to connect; `statistics` tells how that went.
    explicit OceanSession(SessionOptions options);
    OceanSession(const OceanSession&) = delete;
    OceanSession& operator=(const OceanSession&) = delete;
    /// Says goodbye and waits until it has left, a second at most.
    ~OceanSession();

    std::shared_ptr<const StoreSnapshot> snapshot() const;
    /// The hello of the session at hand or the last one; null before the first.
    std::shared_ptr<const ServerHello> hello() const;
    /// 0 before the first hello; then never steps back within an epoch of the world's time.
    SeaTime sea_time_now();
    SessionStatistics statistics();

    /// Both are told to the server when they change, views at most ten times a second, the latest only.
    void set_view(const ViewState& view);
    void set_regions(std::vector<SyncRegion> regions);

    void rays(BoxId box, AnswerTo<RaysReply> answer);
    void sample(SeaTime time, std::vector<LatticePoint> points, AnswerTo<SampleReply> answer);
    /// Not for ListBoxes. The sequence is the session's to give.
    void command(Command command, AnswerTo<CommandReply> answer);
    void list(AnswerTo<BoxList> answer);

    /// Waits until `holds`, which is looked at again after every change of what the members above say. False at the
    /// deadline.
    bool wait_until(const std::function<bool()>& holds, std::chrono::milliseconds patience);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace trochoid
