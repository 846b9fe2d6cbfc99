#include <fmt/format.h>

#include "tests/conformance/client/refusals.hpp"
#include "tests/conformance/kit_sea.hpp"

// What a client brings along when it comes again: R-129, tickets and resume data. Clients that do not come again are skipped.
namespace trochoid::conformance::client {

namespace {

const std::vector<uint8_t> ticket(40, 0x71);

void with_ticket(ServerHello& hello) {
    hello.capabilities = capability_resume;
    hello.ticket = ticket;
    hello.ticket_life_ms = 600'000;
}

/// A session in which the small sea is held and the clock's replies have told of the log, then cut off.
void first_session(ClientTrial& trial) {
    ClientPeer& peer = trial.welcome(with_ticket);
    if ((peer.hello().capabilities & capability_resume) == 0)
        throw Skipped{"the client's hello does not offer to resume"};
    peer.expect_service();
    peer.listen(Milliseconds(150));
    peer.stream().finish();
    peer.expect_end();
}

void add_resume(Catalogue& all) {
    all.push_back(client_case(
        "R-157/resume-data", "A client that comes again tells what it holds", [](ClientTrial& trial) {
            first_session(trial);
            ClientPeer& peer = trial.accept_again();
            const ClientHello& hello = peer.await_hello();
            if (!hello.resume) throw Failed{"the hello has no resume data"};
            if (hello.resume->state_hash != hash_of(small_sea()))
                throw Failed{"the resume data's hash is not that of the state sent"};
            if (hello.resume->instance != peer.usual_hello().instance)
                throw Failed{"the resume data names another instance"};
            if (hello.resume->log_position.value != ClientPeer::log_length ||
                hello.resume->log_hash != ClientPeer::log_hash)
                throw Failed{"the resume data's log is not the one that clock replies told of"};
            peer.welcome_now();
            peer.expect_service();
        }));
    all.push_back(client_case(
        "R-157/cut-result", "Of a result that was cut the client keeps nothing", [](ClientTrial& trial) {
            ClientPeer& first = trial.welcome(with_ticket);
            if ((first.hello().capabilities & capability_resume) == 0)
                throw Skipped{"the client's hello does not offer to resume"};
            first.expect_service();
            constexpr size_t small_pieces = 1500;
            const std::vector<Delta> pieces = first.pieces_to(grown_sea(), false, small_pieces);
            for (size_t i = 0; i + 1 < pieces.size(); ++i) first.send(pieces[i]);
            first.listen(Milliseconds(150));
            first.stream().finish();
            first.expect_end();
            ClientPeer& peer = trial.accept_again();
            const ClientHello& hello = peer.await_hello();
            if (!hello.resume) throw Skipped{"the client does not ask to resume"};
            if (hello.resume->state_hash != hash_of(small_sea()))
                throw Failed{"the resume data's hash is not that of the last whole result"};
            peer.welcome_now();
            peer.expect_service();
        }));
    all.push_back(
        client_case("R-158/resumed",
                    "We go on with what the client holds: it counts as result 1, and result 2 builds on it",
                    [](ClientTrial& trial) {
                        first_session(trial);
                        ClientPeer& peer = trial.accept_again();
                        if (!peer.await_hello().resume) throw Skipped{"the client does not ask to resume"};
                        peer.hold(1, small_sea());
                        peer.welcome_now([](ServerHello& hello) {
                            with_ticket(hello);
                            hello.resumed = true;
                        });
                        peer.send_result(grown_sea());
                        peer.await_ack(2);
                    }));
    all.push_back(client_case("R-159/not-resumed",
                              "We do not go on with what the client holds: a snapshot is result 1",
                              [](ClientTrial& trial) {
                                  first_session(trial);
                                  ClientPeer& peer = trial.accept_again();
                                  peer.await_hello();
                                  peer.welcome_now(with_ticket);
                                  peer.send_result(grown_sea(), true);
                                  peer.await_ack(1);
                              }));
    all.push_back(client_case(
        "R-158/resumed-wrong",
        "We go on with another state than the client holds: it says so, and takes a snapshot",
        [](ClientTrial& trial) {
            first_session(trial);
            ClientPeer& peer = trial.accept_again();
            if (!peer.await_hello().resume) throw Skipped{"the client does not ask to resume"};
            peer.hold(1, grown_sea());
            peer.welcome_now([](ServerHello& hello) {
                with_ticket(hello);
                hello.resumed = true;
            });
            peer.send_result(small_sea());
            const Ack ack = peer.await<Ack>("acknowledgement", [](const Ack& it) { return it.result == 2; });
            if (ack.state_hash == hash_of(small_sea()))
                throw Failed{"R-133: a result on a base that is not held was applied"};
            peer.expect_service();
        }));
    all.push_back(client_case(
        "R-158/resumed-unasked", "Our hello says that we go on with a state that the client has not offered",
        [](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome([](ServerHello& hello) { hello.resumed = true; });
            peer.expect_goodbye(unexpected);
        }));
}

void add_tickets(Catalogue& all) {
    all.push_back(
        client_case("R-155/newest-ticket",
                    "A client that comes again shows the ticket of our last hello unchanged, or none",
                    [](ClientTrial& trial) {
                        first_session(trial);
                        ClientPeer& second = trial.accept_again();
                        const std::vector<uint8_t> shown = second.await_hello().ticket;
                        if (!shown.empty() && shown != ticket)
                            throw Failed{"the ticket is not the one of our hello"};
                        const std::vector<uint8_t> newer(64, 0x2f);
                        second.welcome_now([&](ServerHello& hello) {
                            with_ticket(hello);
                            hello.ticket = newer;
                        });
                        second.expect_service();
                        second.stream().finish();
                        second.expect_end();
                        const std::vector<uint8_t> again = trial.accept_again().await_hello().ticket;
                        if (!again.empty() && again != newer)
                            throw Failed{"the ticket is not the one of our last hello: each is good once"};
                    }));
}

void add_instances(Catalogue& all) {
    all.push_back(
        client_case("R-129/new-instance",
                    "Another world instance: the client has dropped what it held, and offers it no more",
                    [](ClientTrial& trial) {
                        const auto other = [](ServerHello& hello) {
                            with_ticket(hello);
                            hello.instance.bytes.fill(9);
                        };
                        first_session(trial);
                        ClientPeer& second = trial.accept_again();
                        second.await_hello();
                        second.welcome_now(other);
                        second.listen(Milliseconds(100));
                        second.stream().finish();
                        second.expect_end();
                        ClientPeer& third = trial.accept_again();
                        if (third.await_hello().resume)
                            throw Failed{"R-129: the client still offers what it held of the other instance"};
                        third.welcome_now(other);
                        third.expect_service();
                    }));
    all.push_back(client_case("R-129/new-instance-result",
                              "Another world instance: its first result is all that is held",
                              [](ClientTrial& trial) {
                                  first_session(trial);
                                  ClientPeer& peer = trial.accept_again();
                                  peer.await_hello();
                                  peer.welcome_now([](ServerHello& hello) { hello.instance.bytes.fill(9); });
                                  peer.send_result(grown_sea(), true);
                                  peer.await_ack(1);
                              }));
}

}  // namespace

void add_return_cases(Catalogue& all) {
    add_resume(all);
    add_tickets(all);
    add_instances(all);
    all.push_back(client_case(
        "R-159/last-code", "The next hello tells how the last session ended", [](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome(with_ticket);
            peer.expect_service();
            Goodbye goodbye;
            goodbye.code = ErrorCode::shutting_down;
            goodbye.message = "back in a moment";
            goodbye.retry = true;
            peer.send(goodbye);
            peer.expect_end();
            const ErrorCode last = trial.accept_again().await_hello().last_code;
            if (last != ErrorCode::shutting_down)
                throw Failed{
                    fmt::format("the hello's last code is {}, not 701", static_cast<unsigned>(last))};
        }));
}

}  // namespace trochoid::conformance::client
