#pragma once
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "protocol/codec/codec.hpp"
#include "protocol/wire/session_rules.hpp"
#include "tests/conformance/framed_stream.hpp"
#include "tests/conformance/held_state.hpp"
#include "tests/conformance/target.hpp"

namespace trochoid::conformance {

/// For goodbyes whose requirement is not looked at.
inline constexpr uint16_t any_requirement = UINT16_MAX;

/// One connection to the server under test. It may send anything; whatever the server sends is judged by the whole standard
/// on its way in: Failed, with the requirement, where it is wrong.
class ServerPeer {
public:
    ServerPeer(const Target& target, Trial& trial, Way way = Way::whole);
    ServerPeer(const ServerPeer&) = delete;
    ServerPeer& operator=(const ServerPeer&) = delete;
    ~ServerPeer() = default;

    // ---- out ----
    bool send_bytes(std::span<const uint8_t> bytes) { return stream_.send_bytes(bytes); }
    bool send_magic() { return stream_.send_magic(); }
    /// Any bytes as one frame.
    bool send_payload(std::span<const uint8_t> payload) { return stream_.send_frame(payload); }
    bool send(const ClientMessage& message) { return send_payload(encode(message)); }
    /// The next number of a sequence that all messages of this connection share.
    uint32_t next_sequence() { return ++sequence_; }

    /// What every valid login says: both versions of ours, no token, a view of nothing.
    static ClientHello usual_hello();
    /// Magic and hello, then the server's hello; Failed where something else comes.
    const ServerHello& log_in(const ClientHello& hello = usual_hello());
    /// The same with a token for that role; Skipped where the options allow none.
    const ServerHello& log_in_as(Role role, ClientHello hello = usual_hello());

    // ---- in ----
    /// What the hello will offer to go on with: the server may take it or not.
    void offer(InterestState state) { offered_ = std::move(state); }
    /// The next message, judged; deltas are applied to `held` and whole results acknowledged. Nothing where none came in time or the
    /// stream has ended.
    std::optional<ServerMessage> receive(Milliseconds within);
    /// The next message of a type, with `wanted` true; others pass by. Failed where none comes.
    template <class Message>
    Message await(
        const char* what,
        const std::function<bool(const Message&)>& wanted = [](const Message&) { return true; }) {
        const Deadline deadline(target_.patience);
        while (auto message = receive(deadline.left()))
            if (auto* found = std::get_if<Message>(&*message); found && wanted(*found))
                return std::move(*found);
        throw_missing(what);
    }
    /// A whole result later than result `after`.
    const Delta& await_result(uint32_t after);
    /// Takes in what comes until nothing has come for so long.
    void settle(Milliseconds quiet = Milliseconds(150));
    ClockReply ask_clock();
    CommandReply ask(Command command);
    BoxList ask_boxes();
    SampleReply ask_samples(SeaTime time, std::vector<LatticePoint> points);

    // ---- judgements ----
    /// The server says goodbye with this code and requirement, and closes: that is the case's close verdict too. What else comes before is
    /// judged as always. `codes`: others that are as good.
    Goodbye expect_goodbye(ErrorCode code, uint16_t requirement, std::vector<ErrorCode> codes = {});
    /// The same, given the requirement that belongs to the code.
    Goodbye expect_goodbye(ErrorCode code) { return expect_goodbye(code, requirement_for(code)); }
    /// The session goes on: the server answers a clock request.
    void expect_service();
    /// The server closes without any message more.
    void expect_silent_end();

    HeldState& held() { return held_; }
    const ServerHello& hello() const { return *hello_; }
    const std::optional<Goodbye>& goodbye() const { return goodbye_; }
    FramedStream& stream() { return stream_; }
    /// Acknowledge whole results as they come (on at first), the first one with this known answer.
    void acknowledge_by_itself(bool on) { acknowledges_ = on; }
    void answer_challenge(std::optional<uint64_t> answer) { known_answer_ = answer; }
    /// Acknowledges the last whole result, with the right hash unless told otherwise.
    void acknowledge(std::optional<uint64_t> hash = {});
    const Target& target() const { return target_; }
    /// Called with every message that comes.
    void watch(std::function<void(const ServerMessage&, int64_t at_us)> watcher) {
        watcher_ = std::move(watcher);
    }

private:
    static uint16_t requirement_for(ErrorCode code);
    [[noreturn]] void throw_missing(const char* what) const;
    void take(const ServerMessage& message);
    void take_clock(const ClockReply& reply);
    CloseReport await_end(int64_t sent_at_us);

    const Target& target_;
    Trial& trial_;
    FramedStream stream_;
    SessionPhase phase_ = SessionPhase::awaiting_hello;
    std::optional<ServerHello> hello_;
    std::optional<Goodbye> goodbye_;
    std::optional<InterestState> offered_;
    HeldState held_;
    bool acknowledges_ = true;
    bool answered_ = false;
    std::optional<uint64_t> known_answer_;
    std::optional<ClockReply> last_clock_;
    uint32_t sequence_ = 0;
    std::function<void(const ServerMessage&, int64_t)> watcher_;
};

}  // namespace trochoid::conformance
