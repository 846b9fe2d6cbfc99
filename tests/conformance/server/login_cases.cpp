#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "protocol/login/login_token.hpp"
#include "tests/conformance/server/refusals.hpp"

// tokens, tickets, and what a client may go on with.
namespace trochoid::conformance::server {

namespace {

using Change = std::function<void(LoginToken&)>;

/// Logs in with this token; the goodbye has to be token_refused.
void refuse_token(ServerTrial& trial, const std::string& token) {
    ServerPeer& peer = trial.connect();
    ClientHello hello = ServerPeer::usual_hello();
    hello.token = token;
    peer.send_magic();
    peer.send(hello);
    peer.expect_goodbye(ErrorCode::token_refused, any_requirement);
}

std::string signed_token(const ServerTrial& trial, const Change& change) {
    LoginToken token = usual_token(Role::director, trial.target().hello.world);
    change(token);
    return sign_token(token, trial.target().tokens.key());
}

void add_tokens(Catalogue& all) {
    for (const auto& [name, role] : {std::pair{"viewer", Role::viewer}, std::pair{"director", Role::director},
                                     std::pair{"admin", Role::admin}})
        all.push_back(server_case(
            fmt::format("R-127/role-{}", name), fmt::format("A token for a {} makes one", name),
            [given = role](ServerTrial& trial) {
                ClientHello hello = ServerPeer::usual_hello();
                hello.token =
                    sign_token(usual_token(given, trial.target().hello.world), trial.target().tokens.key());
                if (trial.log_in(hello).hello().role != given) throw Failed{"the hello tells another role"};
            }));
    const auto bad = [&](const char* id, const char* title, Change change) {
        all.push_back(
            server_case(fmt::format("R-153/{}", id), title, [change = std::move(change)](ServerTrial& trial) {
                refuse_token(trial, signed_token(trial, change));
            }));
    };
    constexpr uint64_t hour = 3600;
    bad("expired", "A token that expired an hour ago",
        [=](LoginToken& t) { t.issued.value -= 2 * hour, t.expiry.value = t.issued.value + 60; });
    bad("not-yet", "A token issued an hour from now",
        [=](LoginToken& t) { t.issued.value += hour, t.expiry.value = t.issued.value + 60; });
    bad("other-world", "A token for another world", [](LoginToken& t) { t.world += " of others"; });
    all.push_back(
        server_case("R-153/other-key", "A token that another key has signed", [](ServerTrial& trial) {
            trial.target().tokens.key();
            refuse_token(trial, sign_token(usual_token(Role::director, trial.target().hello.world),
                                           SigningKey::generate()));
        }));
    const auto altered = [&](const char* id, const char* title, std::function<void(std::string&)> change) {
        all.push_back(server_case(id, title, [change = std::move(change)](ServerTrial& trial) {
            std::string token = signed_token(trial, [](LoginToken&) {});
            change(token);
            refuse_token(trial, token);
        }));
    };
    altered("R-153/altered-payload", "A token whose payload was altered after signing",
            [](std::string& t) { t[t.find('.') + 8] = t[t.find('.') + 8] == 'A' ? 'B' : 'A'; });
    altered("R-153/altered-signature", "A token whose signature was altered",
            [](std::string& t) { t[t.rfind('.') + 8] = t[t.rfind('.') + 8] == 'A' ? 'B' : 'A'; });
    altered("R-152/cut", "A token that was cut", [](std::string& t) { t.resize(t.size() - 6); });
    altered("R-152/longer", "A token with something behind it", [](std::string& t) { t += "A"; });
    altered("R-152/other-version", "A token of another version", [](std::string& t) { t[8] = '9'; });
    altered("R-152/padded", "A token with padding", [](std::string& t) { t += "=="; });
    altered("R-152/no-signature", "A token without its signature",
            [](std::string& t) { t.resize(t.rfind('.') + 1); });
    all.push_back(server_case("R-152/words", "A token that is none at all",
                              [](ServerTrial& trial) { refuse_token(trial, "let me in"); }));
    all.push_back(server_case("R-154/replay", "A token is good for one login", [](ServerTrial& trial) {
        ClientHello hello = ServerPeer::usual_hello();
        hello.token = signed_token(trial, [](LoginToken&) {});
        trial.log_in(hello);
        refuse_token(trial, hello.token);
    }));
    all.back().connections = 2;
    all.push_back(server_case("R-154/replay-after-end", "A token is spent after its session has ended, too",
                              [](ServerTrial& trial) {
                                  ClientHello hello = ServerPeer::usual_hello();
                                  hello.token = signed_token(trial, [](LoginToken&) {});
                                  ServerPeer& peer = trial.log_in(hello);
                                  peer.send(Goodbye{.message = "done"});
                                  peer.expect_silent_end();
                                  refuse_token(trial, hello.token);
                              }));
    all.back().connections = 2;
    all.push_back(server_case("R-154/eight-at-once", "Of eight logins with one token at once, one succeeds",
                              [](ServerTrial& trial) {
                                  ClientHello hello = ServerPeer::usual_hello();
                                  hello.token = signed_token(trial, [](LoginToken&) {});
                                  std::vector<ServerPeer*> peers;
                                  for (int i = 0; i < 8; ++i) {
                                      peers.push_back(&trial.connect());
                                      peers.back()->send_magic();
                                  }
                                  for (ServerPeer* peer : peers) peer->send(hello);
                                  int welcome = 0;
                                  for (ServerPeer* peer : peers) {
                                      const auto first = peer->receive(trial.target().patience);
                                      welcome += first && std::holds_alternative<ServerHello>(*first);
                                  }
                                  if (welcome != 1)
                                      throw Failed{fmt::format("{} of eight logins succeeded", welcome)};
                              }));
    all.back().connections = 8;
}

/// The hello of whoever comes back with a ticket.
ClientHello hello_with(const std::vector<uint8_t>& ticket) {
    ClientHello hello = ServerPeer::usual_hello();
    hello.ticket = ticket;
    hello.capabilities = capability_probes | capability_resume;
    return hello;
}

std::vector<uint8_t> ticket_of(const ServerHello& hello) {
    if (hello.ticket.empty()) throw Skipped{"the server gives no tickets"};
    if (hello.ticket_life_ms == 0) throw Failed{"a ticket comes with a life of 0 ms"};
    return hello.ticket;
}

void leave(ServerPeer& peer) {
    peer.send(Goodbye{.message = "back soon"});
    peer.expect_silent_end();
}

/// How the server says that a session ended whose sequence went back, so long after it has closed.
ErrorCode last_code_after_going_back(ServerTrial& trial, Milliseconds pause) {
    ServerPeer& first = trial.log_in();
    const auto ticket = ticket_of(first.hello());
    first.send(ClockRequest{2, 1});
    first.send(ClockRequest{1, 1});
    const Deadline deadline(trial.target().patience);
    while (!first.goodbye() && first.receive(deadline.left())) {
    }
    if (!first.goodbye() || first.goodbye()->code != ErrorCode::sequence_not_monotone)
        throw Skipped{"the server lets sequences go back (R-125)"};
    first.stream().finish();
    while (first.stream().state() == Stream::State::open && first.receive(deadline.left())) {
    }
    std::this_thread::sleep_for(pause);
    return trial.log_in(hello_with(ticket)).hello().last_code;
}

void add_tickets(Catalogue& all) {
    all.push_back(server_case("R-155/role", "A ticket gives its session's role back", [](ServerTrial& trial) {
        ServerPeer& first = trial.log_in_as(Role::director);
        const auto ticket = ticket_of(first.hello());
        leave(first);
        ServerPeer& second = trial.log_in(hello_with(ticket));
        if (second.hello().role != first.hello().role) throw Failed{"the ticket gives another role"};
        if (second.hello().last_session != first.hello().session)
            throw Failed{"the hello names another session as the last one"};
        if (second.hello().ticket == ticket) throw Failed{"the ticket was not renewed"};
    }));
    all.back().connections = 2;
    all.push_back(server_case(
        "R-155/last-code-501", "The hello tells how the last session ended: by its client",
        [](ServerTrial& trial) {
            ServerPeer& first = trial.log_in();
            const auto ticket = ticket_of(first.hello());
            leave(first);
            const ServerHello& hello = trial.log_in(hello_with(ticket)).hello();
            if (hello.last_code != ErrorCode::client_closed)
                throw Failed{fmt::format("last_code is {}, not 501", static_cast<unsigned>(hello.last_code))};
        }));
    all.back().connections = 2;
    all.push_back(server_case(
        "R-155/last-code-109", "The hello tells how the last session ended: for a sequence that went back",
        [](ServerTrial& trial) {
            // A server may need a while to note an end.
            ErrorCode last = ErrorCode::none;
            for (const int pause_ms : {0, 100, 500}) {
                last = last_code_after_going_back(trial, Milliseconds(pause_ms));
                if (last == ErrorCode::sequence_not_monotone) return;
            }
            throw Failed{fmt::format("last_code is {}, not 109", static_cast<unsigned>(last))};
        }));
    all.back().connections = 6;
    all.push_back(
        server_case("R-155/used-twice", "A director's ticket is good for one login", [](ServerTrial& trial) {
            ServerPeer& first = trial.log_in_as(Role::director);
            const auto ticket = ticket_of(first.hello());
            trial.log_in(hello_with(ticket));
            ServerPeer& again = trial.connect();
            again.send_magic();
            again.send(hello_with(ticket));
            const auto answer = again.receive(trial.target().patience);
            if (!answer) throw Failed{"no answer came"};
            if (const auto* hello = std::get_if<ServerHello>(&*answer); hello && hello->role != Role::viewer)
                throw Failed{"the ticket gave its role twice"};
        }));
    all.back().connections = 3;
    const auto broken = [&](const char* id, const char* title,
                            std::function<void(std::vector<uint8_t>&)> change) {
        all.push_back(
            server_case(fmt::format("R-155/{}", id), title, [change = std::move(change)](ServerTrial& trial) {
                ServerPeer& first = trial.log_in_as(Role::director);
                auto ticket = ticket_of(first.hello());
                change(ticket);
                ServerPeer& second = trial.connect();
                second.send_magic();
                second.send(hello_with(ticket));
                const auto answer = second.receive(trial.target().patience);
                if (!answer) throw Failed{"no answer came"};
                if (const auto* hello = std::get_if<ServerHello>(&*answer);
                    hello && (hello->role != Role::viewer || hello->last_session != 0))
                    throw Failed{"a ticket that was tampered with gave a role or a session"};
            }));
        all.back().connections = 2;
    };
    broken("altered", "A ticket of which a bit was turned", [](auto& t) { t[t.size() / 2] ^= 1; });
    broken("cut", "A ticket that was cut", [](auto& t) { t.resize(t.size() - 1); });
    broken("longer", "A ticket with a byte behind it", [](auto& t) { t.push_back(0); });
    broken("noise", "512 bytes of noise", [](auto& t) { t.assign(512, 0xa5); });
}

/// A session that has applied a result, and what it could go on with.
struct Earlier {
    std::vector<uint8_t> ticket;
    ResumeState resume;
    InterestState state;
    ViewState view;
};

Earlier earlier_session(ServerTrial& trial) {
    Earlier earlier;
    ClientHello hello = hello_with({});
    earlier.view = hello.view = view_of_water(trial.target());
    ServerPeer& peer = trial.log_in(hello);
    if ((peer.hello().capabilities & capability_resume) == 0)
        throw Skipped{"the server's hello does not offer to go on with what a client holds"};
    peer.await_result(0);
    peer.settle();
    earlier.ticket = ticket_of(peer.hello());
    const ClockReply clock = peer.ask_clock();
    // Of a result that is cut nothing is kept.
    while (!peer.held().between_results())
        if (!peer.receive(trial.target().patience)) throw Failed{"R-134: a result was begun and not ended"};
    earlier.resume = {peer.hello().instance, peer.held().last()->key, peer.held().hash(), clock.log_position,
                      clock.log_hash};
    earlier.state = peer.held().state();
    leave(peer);
    return earlier;
}

/// Comes back and gets along, whether or not the server goes on with what is offered.
ServerPeer& come_back(ServerTrial& trial, const Earlier& earlier,
                      const std::function<void(ClientHello&)>& change) {
    ClientHello hello = hello_with(earlier.ticket);
    hello.view = earlier.view;
    hello.resume = earlier.resume;
    change(hello);
    ServerPeer& peer = trial.connect();
    peer.offer(earlier.state);
    peer.log_in(hello);
    peer.await_result(peer.hello().resumed ? 1 : 0);
    peer.expect_service();
    return peer;
}

void add_resumes(Catalogue& all) {
    all.push_back(server_case("R-158/resumed", "A client that comes back at once goes on with what it holds",
                              [](ServerTrial& trial) {
                                  const Earlier earlier = earlier_session(trial);
                                  ServerPeer& peer = come_back(trial, earlier, [](ClientHello&) {});
                                  trial.note(fmt::format("{} bytes came until the next result",
                                                         peer.stream().bytes_received()));
                                  if (!peer.hello().resumed) {
                                      if (peer.hello().log_position != earlier.resume.log_position)
                                          throw Skipped{"the sea was changed meanwhile"};
                                      throw Failed{"the server did not go on with a state that is right"};
                                  }
                              }));
    const auto not_resumed = [&](const char* id, const char* title,
                                 std::function<void(ClientHello&)> change) {
        all.push_back(
            server_case(fmt::format("R-159/{}", id), title, [change = std::move(change)](ServerTrial& trial) {
                const Earlier earlier = earlier_session(trial);
                if (come_back(trial, earlier, change).hello().resumed)
                    throw Failed{"the server goes on with it"};
            }));
        all.back().connections = 2;
    };
    not_resumed("other-hash", "A state of another hash is not gone on with",
                [](ClientHello& h) { h.resume->state_hash ^= 1; });
    not_resumed("other-instance", "A state of another instance is not gone on with",
                [](ClientHello& h) { h.resume->instance.bytes[0] ^= 1; });
    not_resumed("other-log", "A state of another log is not gone on with",
                [](ClientHello& h) { h.resume->log_hash ^= 1; });
    not_resumed("future", "A state from the future is not gone on with",
                [](ClientHello& h) { h.resume->log_position.value += 1000; });
    not_resumed("other-key", "A state of another key is not gone on with",
                [](ClientHello& h) { h.resume->key.anchor.position.x += int64_t{1} << 30; });
    not_resumed("no-resume", "A client that offers nothing gets a snapshot",
                [](ClientHello& h) { h.resume.reset(); });
    not_resumed("version-2", "In version 2 nothing is gone on with",
                [](ClientHello& h) { h.protocol_max = h.protocol_min = 2; });
}

}  // namespace

void add_login_cases(Catalogue& all) {
    add_tokens(all);
    add_tickets(all);
    add_resumes(all);
    for (Case& it : all)
        if (it.id == "R-158/resumed") it.connections = 2;
}

}  // namespace trochoid::conformance::server
