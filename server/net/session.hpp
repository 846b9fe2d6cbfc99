#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "protocol/codec/codec.hpp"
#include "protocol/wire/frame.hpp"
#include "protocol/wire/rate_limit.hpp"
#include "protocol/wire/session_rules.hpp"
#include "server/net/answer_lane.hpp"
#include "server/net/control_lane.hpp"
#include "server/net/io_loop.hpp"
#include "server/net/sea_provider.hpp"
#include "server/net/server_stats.hpp"
#include "server/net/session_share.hpp"
#include "server/net/state_lane.hpp"
#include "server/net/terrain_lane.hpp"
#include "server/net/transport.hpp"
#include "server/net/view_motion.hpp"

namespace trochoid {

class Session;

/// What all sessions of a server share; outlives them.
struct SessionSurroundings {
    IoLoop& loop;
    SeaProvider& sea;
    ServerStats& stats;
    Limits limits;
    /// Reading happens into one buffer for all: an idle session owns none.
    std::span<uint8_t> read_buffer;
    /// Called once when a session is over, last thing.
    std::function<void(uint64_t id, ErrorCode code)> ended;
    /// How an earlier session of this node ended; none where it has not, or where too many have since.
    std::function<ErrorCode(uint64_t id)> how_ended;
    /// Calls the session's `compute_aside` when its turn has come.
    std::function<void(const std::shared_ptr<Session>& session)> wants_turn;
    ServerShare io_share = {};
};

/// One client, from its first byte to its end, on the io thread: magic, hello, then four lanes out by priority (control,
/// state, answers, terrain). Whatever a peer sends, a session answers it or ends with a code; it never throws for it.
class Session : public std::enable_shared_from_this<Session> {
public:
    Session(SessionSurroundings& around, uint64_t id, std::unique_ptr<Transport> transport);
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    /// Begins to read; until then the connection waits. `since_us`: when it came (monotonic, microseconds), waiting apart; the hello
    /// deadline runs from then.
    void start(int64_t since_us);
    /// Says goodbye and ends. Without effect on a session that is already ending.
    void part(Goodbye goodbye);
    /// The world has changed: the next result is decided as soon as it can be written.
    void sea_changed();
    /// Computes a result aside, and calls `done` once that is over, maybe before this returns.
    void compute_aside(const std::function<void()>& done);
    /// Deadlines and spans that run out; to be called about ten times a second.
    void sweep(int64_t now_us);

    uint64_t id() const { return id_; }
    /// How it ends, known from when it parts; none before.
    ErrorCode end_code() const { return end_code_; }
    const std::string& peer() const { return peer_; }
    bool live() const { return stage_ == Stage::live; }
    bool waiting() const { return stage_ == Stage::waiting; }

private:
    enum class Stage : uint8_t { waiting, hello, live, parting, ended };

    // session.cpp: beginning and end.
    void end(ErrorCode code, const std::string& reason);
    void wind_up(ErrorCode code, const std::string& reason);
    void refuse(const Error& error, uint32_t offending_sequence = 0);
    void log_start() const;
    bool waits_for_client() const;

    // session_input.cpp: from bytes to messages and what they mean.
    void arm_reading();
    void on_readable();
    void take_frames(std::span<const uint8_t> bytes);
    void take_frame(std::span<const uint8_t> payload);
    void handle(ClientHello& hello);
    void handle(const ViewUpdate& update);
    void handle(SyncRegions& update);
    void handle(const ClockRequest& request);
    void handle(const Ack& ack);
    void handle(const Command& command);
    void handle(SampleRequest& request);
    void handle(const RaysRequest& request);
    void handle(Probe& probe);
    void handle(const Desync& desync);
    void handle(const Goodbye& goodbye);
    Result<Done> probes_promised() const;
    void resume(const ResumeState& claim);
    Result<LoginDecision> welcome(const ClientHello& hello) const;
    Result<Done> fits(const std::vector<SyncRegion>& regions) const;
    Result<Done> in_time(const ClientMessage& message);
    void check_known_answer(uint64_t answer);
    ServerHello server_hello(const ClientHello& hello);

    // session_output.cpp: from lanes to bytes.
    void send(const ServerMessage& message);
    void flush();
    void arm_writing();
    void arm_view_timer(int64_t now_us);
    void on_writable();
    bool due(int64_t now_us) const;
    bool bulk_to_write(int64_t now_us) const;
    void write_bulk();
    void consider(int64_t now_us);
    void spend(int64_t us);
    ResultRequest begin_considering(int64_t now_us);
    void take_result(std::optional<MadeResult> made);
    bool write_state(int64_t now_us);
    bool write_answer();
    bool write_terrain(int64_t now_us);
    size_t put(const ServerMessage& message, uint64_t& lane_bytes);
    std::deque<ServerMessage> answer_to(const Question& question);
    ProbeReply answer_to(const Probe& probe);

    SessionSurroundings& around_;
    uint64_t id_;
    std::unique_ptr<Transport> transport_;
    std::string peer_;
    std::string software_;
    Role role_ = Role::viewer;
    uint64_t last_session_ = 0;  // that the client comes back from; 0: none, or not known
    uint16_t protocol_ = 0;      // version in use, from the hello on
    Stage stage_ = Stage::waiting;
    int64_t started_us_ = 0;
    int64_t heard_us_ = 0;     // last bytes from the client
    int64_t progress_us_ = 0;  // last time that the client took something, or that nothing waited for it
    int64_t parting_until_us_ = 0;
    ErrorCode end_code_ = ErrorCode::none;
    std::string end_reason_;

    FrameReader frames_;
    Bytes unread_;  // what was read but not taken, because questions wait for their answers
    bool reading_armed_ = false;
    bool taking_ = false;     // in the middle of what has been read; a flush follows
    int64_t read_at_us_ = 0;  // when the bytes being handled were read
    RateLimit view_rate_;
    RateLimit command_rate_;
    RateLimit message_rate_;
    RateLimit probe_rate_;
    int64_t desync_at_us_ = INT64_MIN / 2;  // when the client told of a difference last
    SequenceRule sequence_;

    ViewState view_;
    ViewMotion view_motion_;
    std::vector<SyncRegion> regions_;
    bool view_news_ = false;   // a view or regions that no result was decided from yet
    bool view_waits_ = false;  // a view among them
    bool sea_news_ = false;    // anything else that calls for a result
    bool aside_ = false;       // a result is being computed aside, or waits for that
    SessionShare io_share_;
    int64_t considered_us_ = 0;  // when a result was decided last
    int64_t refresh_at_us_ = INT64_MAX;
    LoopTimer view_timer_;
    bool view_timer_armed_ = false;
    uint64_t challenge_seed_ = 0;
    bool challenge_open_ = false;
    Verdict verdict_ = Verdict::pending;
    int resyncs_in_a_row_ = 0;
    bool resumed_ = false;
    bool result_owed_ = false;  // after a resume the client is told something even where nothing has changed

    ControlLane control_;
    StateLane state_;
    AnswerLane answers_;
    TerrainLane terrain_;
    bool has_terrain_ = false;
    bool terrain_news_ = false;  // the view has moved since tiles were asked for
    Bytes outgoing_;             // what the socket is taking now, at most one frame or the control lane
    size_t outgoing_taken_ = 0;
    bool writing_armed_ = false;
    bool finished_ = false;     // goodbye written, nothing more follows
    size_t dropped_bytes_ = 0;  // that came while parting
    uint64_t bytes_in_ = 0;
    uint64_t bytes_out_ = 0;
};

}  // namespace trochoid
