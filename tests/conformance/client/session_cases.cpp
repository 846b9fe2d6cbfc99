#include <fmt/format.h>

#include "tests/conformance/client/refusals.hpp"
#include "tests/conformance/kit_sea.hpp"

// hellos, goodbyes, and servers that say nothing.
namespace trochoid::conformance::client {

namespace {

constexpr Due out_of_turn{ErrorCode::unexpected_message, requirement::hello_first};

Goodbye leaving(ErrorCode code, bool retry = false, uint32_t retry_after_ms = 0) {
    Goodbye goodbye;
    goodbye.code = code;
    goodbye.message = "the test is over";
    goodbye.retry = retry;
    goodbye.retry_after_ms = retry_after_ms;
    return goodbye;
}

/// A legal goodbye is nothing to complain about.
void expect_quiet_end(ClientPeer& peer) {
    peer.expect_end();
    if (peer.goodbye() && peer.goodbye()->code != ErrorCode::none)
        throw Failed{fmt::format("the client answers a goodbye with code {} ({})",
                                 static_cast<unsigned>(peer.goodbye()->code), peer.goodbye()->message)};
}

void add_hellos(Catalogue& all) {
    for (const LegalMessage& it : legal_messages())
        if (!std::holds_alternative<ServerHello>(it.message) && !std::holds_alternative<Goodbye>(it.message))
            all.push_back(refused_first(fmt::format("R-121/first-{}", it.name),
                                        fmt::format("A {} in the place of our hello", it.name),
                                        encode(it.message), out_of_turn));
    all.push_back(client_case("R-121/two-hellos", "Our hello comes twice", [](ClientTrial& trial) {
        ClientPeer& peer = trial.welcome();
        peer.send(peer.ours());
        peer.expect_goodbye(out_of_turn);
    }));
    all.push_back(client_case("R-121/hello-after-result", "Our hello comes again after a result",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = trial.welcome();
                                  peer.expect_service();
                                  peer.send(peer.ours());
                                  peer.expect_goodbye(out_of_turn);
                              }));
}

void add_goodbyes(Catalogue& all) {
    for (const ErrorCode code :
         {ErrorCode::shutting_down, ErrorCode::too_many_sessions, ErrorCode::no_progress,
          ErrorCode::value_out_of_range, ErrorCode::internal_error})
        all.push_back(client_case(fmt::format("R-121/goodbye-{}", static_cast<unsigned>(code)),
                                  fmt::format("We say goodbye with code {}", static_cast<unsigned>(code)),
                                  [code](ClientTrial& trial) {
                                      ClientPeer& peer = trial.welcome();
                                      peer.expect_service();
                                      peer.send(leaving(code));
                                      expect_quiet_end(peer);
                                  }));
    for (const ErrorCode code :
         {ErrorCode::protocol_version, ErrorCode::token_required, ErrorCode::wrong_world,
          ErrorCode::too_many_connections, ErrorCode::encryption_required})
        all.push_back(client_case(
            fmt::format("R-121/first-goodbye-{}", static_cast<unsigned>(code)),
            fmt::format("A goodbye with code {} in the place of our hello", static_cast<unsigned>(code)),
            [code](ClientTrial& trial) {
                ClientPeer& peer = trial.accept();
                peer.await_hello();
                peer.send(leaving(code));
                expect_quiet_end(peer);
            }));
    for (const unsigned code : {199U, 299U, 399U, 499U, 599U, 699U, 799U})
        all.push_back(
            client_case(fmt::format("R-175/goodbye-{}", code),
                        fmt::format("A goodbye with the unknown code {} of a known class is taken", code),
                        [code](ClientTrial& trial) {
                            ClientPeer& peer = trial.welcome();
                            peer.send(leaving(static_cast<ErrorCode>(code)));
                            expect_quiet_end(peer);
                        }));
    all.push_back(
        client_case("R-121/after-goodbye", "Something follows our goodbye: whoever has left may not hear it",
                    [](ClientTrial& trial) {
                        ClientPeer& peer = trial.welcome();
                        peer.send(leaving(ErrorCode::shutting_down));
                        peer.send(ClockReply{});
                        peer.expect_end();
                        if (peer.goodbye() && peer.goodbye()->code != ErrorCode::none &&
                            peer.goodbye()->code != ErrorCode::unexpected_message)
                            throw Failed{"the client answers with another code than unexpected_message"};
                    }));
}

void add_returns(Catalogue& all) {
    all.push_back(client_case(
        "R-121/retry-later", "A goodbye that says to try again in 1.5 s: the client does not come before",
        [](ClientTrial& trial) {
            constexpr uint32_t later_ms = 1500;
            ClientPeer& peer = trial.welcome();
            peer.send(leaving(ErrorCode::shutting_down, true, later_ms));
            expect_quiet_end(peer);
            const int64_t begin_us = monotonic_us();
            trial.accept_again();
            const int64_t after_ms = (monotonic_us() - begin_us) / 1000;
            trial.note(fmt::format("it came again after {} ms", after_ms));
            constexpr int64_t slack_ms = 100;
            if (after_ms < later_ms - slack_ms)
                throw Failed{fmt::format("the client came again after {} ms, before the {} asked for",
                                         after_ms, later_ms)};
        }));
    all.push_back(client_case(
        "R-121/no-retry", "A goodbye that says not to try again: the client does not come",
        [](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome();
            peer.send(leaving(ErrorCode::internal_error));
            expect_quiet_end(peer);
            constexpr Milliseconds span{2500};
            if (trial.comes_within(span))
                throw Failed{"the client came again although the goodbye says that this cannot help"};
        }));
}

void add_silence(Catalogue& all) {
    all.push_back(client_case("R-128/closed-without-goodbye", "The stream ends without a goodbye",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = trial.welcome();
                                  peer.expect_service();
                                  peer.stream().finish();
                                  peer.expect_end();
                              }));
    all.push_back(client_case("R-128/reset", "The connection is reset", [](ClientTrial& trial) {
        ClientPeer& peer = trial.welcome();
        peer.expect_service();
        peer.stream().abort();
        constexpr Milliseconds span{300};
        trial.ended_by_itself(span);
    }));
    all.push_back(
        client_case("R-128/closed-before-hello", "The stream ends before our hello", [](ClientTrial& trial) {
            ClientPeer& peer = trial.accept();
            peer.await_hello();
            peer.stream().finish();
            peer.expect_end();
        }));
    Case silent = client_case(
        "R-122/no-hello",
        "No hello comes from us: the client may wait or leave, and says nothing but a goodbye",
        [](ClientTrial& trial) {
            ClientPeer& peer = trial.accept();
            peer.await_hello();
            constexpr Milliseconds span{6500};
            const int64_t begin_us = monotonic_us();
            if (const auto message = peer.receive(span); message && !peer.goodbye())
                throw Failed{"R-121: a message follows the hello before ours has come"};
            const bool left = peer.stream().state() != Stream::State::open || peer.goodbye();
            trial.note(left ? fmt::format("it left after {} ms", (monotonic_us() - begin_us) / 1000)
                            : "it still waits");
        });
    silent.course = Course::waiting;
    all.push_back(std::move(silent));
}

/// What is judged of all that comes (client_conduct.hpp), over a second and a half in which the sea changes.
void add_conduct(Catalogue& all, const char* id, const char* title) {
    all.push_back(client_case(id, title, [](ClientTrial& trial) {
        ClientPeer& peer = trial.welcome();
        peer.expect_service();
        for (int i = 0; i < 15; ++i) {
            peer.send_result(i % 2 == 0 ? grown_sea() : small_sea());
            peer.listen(Milliseconds(100));
        }
        peer.await_ack(peer.result());
    }));
}

/// The standard says nothing of answers that nobody has asked for.
void add_unasked(Catalogue& all) {
    constexpr uint32_t nobodys = 60000;
    CommandReply command;
    command.sequence = nobodys;
    command.code = static_cast<ErrorCode>(599);
    BoxList boxes;
    boxes.sequence = nobodys;
    SampleReply samples;
    samples.sequence = nobodys;
    RaysReply rays;
    rays.sequence = nobodys;
    ProbeReply probe;
    probe.sequence = nobodys;
    probe.stale = true;
    const std::vector<LegalMessage> answers{{"CommandReply", command},
                                            {"BoxList", boxes},
                                            {"SampleReply", samples},
                                            {"RaysReply", rays},
                                            {"ProbeReply", probe}};
    for (const LegalMessage& it : answers)
        all.push_back(client_case(
            fmt::format("R-125/unasked-{}", it.name),
            fmt::format("A {} to a request that never was: it may be refused or ignored", it.name),
            [message = it.message](ClientTrial& trial) {
                ClientPeer& peer = trial.welcome();
                peer.send(message);
                peer.expect_goodbye_or_service({unexpected});
            }));
}

}  // namespace

void add_session_cases(Catalogue& all) {
    add_hellos(all);
    add_goodbyes(all);
    add_returns(all);
    add_silence(all);
    add_conduct(all, "R-125/sequences", "Sequence numbers ascend, acknowledgements never go back");
    add_conduct(all, "R-126/rates", "Views, regions and messages keep their rates");
    add_conduct(all, "R-127/viewer", "A viewer gives no commands that its role does not allow");
    add_unasked(all);
}

}  // namespace trochoid::conformance::client
