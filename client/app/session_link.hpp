#pragma once
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "client/app/session_board.hpp"
#include "client/net/connection.hpp"

namespace trochoid {

/// The network thread's half of a session: one connection after the other, and what passes over them. Every member runs
/// on the loop's thread; results appear on the board.
class SessionLink {
public:
    SessionLink(NetLoop& loop, SessionBoard& board, const SessionOptions& options);
    SessionLink(const SessionLink&) = delete;
    SessionLink& operator=(const SessionLink&) = delete;

    void connect();
    /// Says goodbye; the board's state becomes `ended`.
    void end();
    void view_changed();
    void regions_changed();

    /// A question in flight: `take` gets every message with its sequence and says whether the answer is whole.
    struct Question {
        std::function<bool(ServerMessage& message)> take;
        std::function<void(const Error& error)> fail;
    };
    /// `make` puts the question under the sequence number it is given.
    void ask(const std::function<ClientMessage(uint32_t sequence)>& make, Question question);

    Traffic traffic() const;

private:
    static constexpr uint64_t empty_log = 0;  // rolling hash at position 0

    void receive(ServerMessage message, int64_t received_us);
    void on(const ServerHello& hello, int64_t received_us);
    void on(const ClockReply& reply, int64_t received_us);
    void on(const Delta& delta, int64_t received_us);
    void on(const TerrainTiles& tiles, int64_t received_us);
    void answer(uint32_t sequence, ServerMessage& message);
    void closed(const Goodbye& goodbye, CloseCause cause);
    void log_grew(LogPosition position);
    void ask_clock(uint64_t row, int done);
    // session_probe.cpp: whether what we hold is what the server has sent.
    void probe_after(std::chrono::milliseconds pause);
    void probe(uint64_t row);
    void probed(const Probe& asked, const StoreSnapshot& held, const ProbeReply& reply);
    void show_store();
    ClientHello hello_now();

    NetLoop& loop_;
    SessionBoard& board_;
    const SessionOptions& options_;
    std::shared_ptr<Connection> connection_;
    Traffic past_traffic_;  // of connections that are gone; under the board's mutex
    ClientStore store_;
    uint32_t sequence_ = 0;  // one row for everything, so it names questions of all types
    std::map<uint32_t, Question> questions_;
    int clock_done_ = 0;      // requests before the last one, of the first eight
    uint64_t clock_row_ = 0;  // of the clock requests at hand: timers of earlier rows do nothing
    int64_t watch_clock_until_us_ = 0;
    LogPosition log_position_;
    bool live_ = false;
    bool ending_ = false;
    std::optional<std::string> given_up_;   // why we closed a silent connection
    std::optional<uint64_t> known_answer_;  // goes with the first ack
    // For the next hello: the log as the server told of it last, how the last session ended, and its ticket.
    LogPosition told_position_;
    uint64_t told_log_hash_ = empty_log;
    ErrorCode last_code_ = ErrorCode::none;
    std::vector<uint8_t> ticket_;
    int64_t ticket_until_us_ = 0;  // our monotonic clock
    bool ticket_shown_ = false;    // in the hello at hand
    bool resume_asked_ = false;    // in the hello at hand
    uint64_t probe_row_ = 0;       // timers of earlier rows do nothing
    uint64_t probe_round_ = 0;     // of this session
    ViewState told_view_;
    int64_t told_view_us_ = 0;
    std::vector<SyncRegion> told_regions_;
    bool view_timer_ = false;
    int64_t heard_us_ = 0;
    int64_t live_since_us_ = 0;
    uint32_t failures_ = 0;            // in a row, for the back-off
    double patches_per_second_ = 0.0;  // smoothed, 0 = not known yet
};

}  // namespace trochoid
