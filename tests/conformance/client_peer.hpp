#pragma once
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/codec/codec.hpp"
#include "protocol/wire/session_rules.hpp"
#include "tests/conformance/client_conduct.hpp"
#include "tests/conformance/framed_stream.hpp"

namespace trochoid::conformance {

/// The world that clients under test come to.
inline constexpr const char* kit_world = "conformance";

/// For goodbyes whose requirement is not looked at.
inline constexpr uint16_t any_due_requirement = UINT16_MAX;

/// What a client has to say to something wrong.
struct Due {
    ErrorCode code = ErrorCode::none;
    uint16_t requirement = 0;
};

/// One connection of the client under test, which takes us for a server. We may send anything; whatever the client sends is judged by the
/// whole standard on its way in: Failed, with the requirement, where it is wrong.
class ClientPeer {
public:
    ClientPeer(std::unique_ptr<Stream> stream, Milliseconds patience, Trial& trial);
    ClientPeer(const ClientPeer&) = delete;
    ClientPeer& operator=(const ClientPeer&) = delete;
    ~ClientPeer() = default;

    // ---- in ----
    /// The next message, judged and, where that is not turned off, answered. Nothing where none came in time or the stream has ended.
    std::optional<ClientMessage> receive(Milliseconds within);
    template <class Message>
    Message await(
        const char* what,
        const std::function<bool(const Message&)>& wanted = [](const Message&) { return true; }) {
        const Deadline deadline(patience_);
        while (auto message = receive(deadline.left()))
            if (auto* found = std::get_if<Message>(&*message); found && wanted(*found))
                return std::move(*found);
        throw_missing(what);
    }
    const ClientHello& await_hello();
    /// The acknowledgement of a result. Failed where its hash is not that of the state sent.
    Ack await_ack(uint32_t result);
    /// Takes in what comes for so long.
    void listen(Milliseconds span);

    // ---- out ----
    bool send_bytes(std::span<const uint8_t> bytes) { return stream_.send_bytes(bytes); }
    bool send_payload(std::span<const uint8_t> payload) { return stream_.send_frame(payload); }
    bool send(const ServerMessage& message) { return send_payload(encode(message)); }
    /// What a valid server answers the hello that has come.
    ServerHello usual_hello() const;
    /// The client's hello, then this one of ours (the usual one, changed as told).
    const ServerHello& welcome(const std::function<void(ServerHello&)>& change = [](ServerHello&) {});

    /// Ours alone, where the client's has come.
    const ServerHello& welcome_now(const std::function<void(ServerHello&)>& change = [](ServerHello&) {});
    /// What we are about to say, for cases that write it themselves.
    void prepare(const ServerHello& hello) { ours_ = hello; }

    /// The pieces of the next result: this state, on the last one sent or (snapshot) on nothing.
    std::vector<Delta> pieces_to(const InterestState& state, bool snapshot,
                                 size_t piece_bytes = usual_piece_bytes) const;
    /// Sends them as they are, and counts the state as held.
    void send_result(const InterestState& state, bool snapshot = false,
                     size_t piece_bytes = usual_piece_bytes);
    /// The next result has this number and builds on this state.
    void hold(uint32_t result, InterestState state) {
        result_ = result;
        state_ = std::move(state);
    }
    uint32_t result() const { return result_; }
    const InterestState& state() const { return state_; }

    // ---- judgements ----
    /// The client says goodbye with this code and requirement (or one of the others), and closes: that is the case's close verdict too.
    Goodbye expect_goodbye(Due due, const std::vector<Due>& others = {});
    /// The session goes on: a snapshot is acknowledged with its hash.
    void expect_service();
    /// Either: the standard leaves it open.
    void expect_goodbye_or_service(const std::vector<Due>& dues);
    /// The client ends the stream; what it says before is judged as always.
    void expect_end();

    /// Nothing before it has come.
    const std::optional<ClientHello>& said_hello() const { return hello_; }
    const ClientHello& hello() const { return *hello_; }
    const ServerHello& ours() const { return ours_; }
    const std::optional<Goodbye>& goodbye() const { return goodbye_; }
    FramedStream& stream() { return stream_; }
    SeaTime sea_time_now() const { return sea_time_at(ours_.clock, monotonic_us()); }

    /// Answer clock requests, samples, probes and commands as they come (on at first).
    void answer_by_itself(bool on) { answers_ = on; }
    /// Send a result whenever the client asks for other regions or another view (off at first).
    void follow_interest(bool on) { follows_ = on; }
    /// Called with each clock reply before it is sent.
    void bend_clock(std::function<void(ClockReply&)> bend) { bend_clock_ = std::move(bend); }
    /// Called with each probe's reply before it is sent.
    void bend_probe(std::function<void(ProbeReply&)> bend) { bend_probe_ = std::move(bend); }
    /// What clock replies say of the known answer.
    void set_verdict(trochoid::Verdict verdict) { verdict_ = verdict; }
    const std::vector<ClockRequest>& clock_requests() const { return clock_requests_; }
    const std::vector<int64_t>& clock_requests_at_us() const { return clock_requests_at_us_; }
    const std::vector<Ack>& acks() const { return acks_; }
    /// Whether the client has reported a difference.
    bool reported() const { return reported_; }

    static constexpr size_t usual_piece_bytes = 8192;
    static constexpr uint64_t log_length = 3;
    static constexpr uint64_t log_hash = 0x5eaf00d;

private:
    static constexpr uint8_t instance_byte = 0x5e;

    [[noreturn]] void throw_missing(const char* what) const;
    void take(const ClientMessage& message, int64_t at_us);
    void answer(const ClientMessage& message, int64_t at_us);
    void answer_clock(const ClockRequest& request, int64_t at_us);
    void answer_samples(const SampleRequest& request);
    void answer_probe(const Probe& probe);
    CloseReport await_end(int64_t sent_at_us);
    CullKey key() const;

    Milliseconds patience_;
    Trial& trial_;
    FramedStream stream_;
    SessionPhase phase_ = SessionPhase::awaiting_hello;
    SequenceRule sequences_;
    ClientConduct conduct_;
    std::optional<ClientHello> hello_;
    std::optional<Goodbye> goodbye_;
    ServerHello ours_;
    ViewState view_;
    std::vector<SyncRegion> regions_;
    InterestState state_;
    uint32_t result_ = 0;  // the last one sent whole
    bool answers_ = true;
    bool follows_ = false;
    bool reported_ = false;
    trochoid::Verdict verdict_ = trochoid::Verdict::pending;
    std::function<void(ClockReply&)> bend_clock_;
    std::function<void(ProbeReply&)> bend_probe_;
    std::vector<ClockRequest> clock_requests_;
    std::vector<int64_t> clock_requests_at_us_;
    std::vector<Ack> acks_;
};

}  // namespace trochoid::conformance
