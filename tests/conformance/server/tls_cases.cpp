#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tests/conformance/server/web_peer.hpp"
#include "tests/conformance/tls_stream.hpp"

// what a port does inside TLS, and TLS itself. That sessions in the clear with other machines are refused cannot be tried
// from the server's own.
namespace trochoid::conformance::server {

namespace {

/// The server has to speak TLS for these.
const Endpoint& encrypted(const ServerTrial& trial) {
    const Endpoint& server = trial.target().server;
    if (!is_encrypted(server.transport))
        throw Skipped{"needs TLS: --connect tls://HOST:PORT (or wss://), --ca FILE"};
    return server;
}

TlsOffer offer_to(const Endpoint& server) {
    TlsOffer offer;
    offer.host = server.host;
    offer.ca_file = server.ca_file;
    return offer;
}

std::unique_ptr<TlsStream> shaken(const ServerTrial& trial, const TlsOffer& offer) {
    const Milliseconds patience = trial.target().patience;
    return begin_tls(connect_tcp(encrypted(trial), patience), offer, patience);
}

/// The server has refused the handshake; what else failed is thrown on.
void note_refusal(ServerTrial& trial, const Failed& refused) {
    if (!refused.reason.starts_with("R-106: no TLS handshake") ||
        refused.reason.find("no answer in time") != std::string::npos)
        throw Failed{refused.reason};
    trial.note(refused.reason);
}

void add_handshakes(Catalogue& all) {
    const auto add = [&](const char* id, const char* title, ServerBody body) {
        all.push_back(server_case(std::string("R-106/") + id, title, std::move(body)));
    };
    add("version-1-3", "The handshake ends at TLS 1.3", [](ServerTrial& trial) {
        const std::string version = shaken(trial, offer_to(encrypted(trial)))->agreement().version;
        if (version != "TLSv1.3") throw Failed{"the handshake ended at " + version};
    });
    add("version-1-2", "A client that speaks TLS 1.2 at most is refused", [](ServerTrial& trial) {
        TlsOffer offer = offer_to(encrypted(trial));
        offer.at_most_1_2 = true;
        try {
            shaken(trial, offer);
        } catch (const Failed& refused) {
            note_refusal(trial, refused);
            return;
        }
        throw Failed{"the server agrees to TLS 1.2"};
    });
    const auto agrees = [&](const char* id, const char* title, const std::vector<std::string>& offered,
                            const std::string& agreed) {
        add(id, title, [=](ServerTrial& trial) {
            TlsOffer offer = offer_to(encrypted(trial));
            offer.protocols = offered;
            const std::string protocol = shaken(trial, offer)->agreement().protocol;
            if (protocol != agreed && !protocol.empty())
                throw Failed{fmt::format("the server agrees to '{}' by ALPN", protocol)};
            trial.note(protocol.empty() ? "nothing agreed on by ALPN" : "agreed on " + protocol);
        });
    };
    agrees("alpn-trochoid", "trochoid is offered by ALPN", {"trochoid"}, "trochoid");
    agrees("alpn-http", "http/1.1 is offered by ALPN", {"http/1.1"}, "http/1.1");
    agrees("alpn-none", "Nothing is offered by ALPN", {}, "");
    add("alpn-other", "Where h2 alone is offered by ALPN, the server does not agree to it",
        [](ServerTrial& trial) {
            TlsOffer offer = offer_to(encrypted(trial));
            offer.protocols = {"h2"};
            try {
                if (!shaken(trial, offer)->agreement().protocol.empty())
                    throw Failed{"the server agrees to h2"};
            } catch (const Failed& refused) {
                // As good (RFC 7301).
                note_refusal(trial, refused);
            }
        });
    add("early-data", "The server's tickets allow no early data", [](ServerTrial& trial) {
        const auto stream = shaken(trial, offer_to(encrypted(trial)));
        // Tickets come behind the handshake, before any answer.
        const std::string request = "GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n";
        stream->write({reinterpret_cast<const uint8_t*>(request.data()), request.size()});
        std::array<uint8_t, 4096> answer;
        if (stream->read(answer, trial.target().patience) == 0) throw Failed{"no answer came to GET /livez"};
        if (const uint32_t bytes = stream->agreement().early_bytes; bytes > 0)
            throw Failed{fmt::format("the server's ticket allows {} bytes of early data", bytes)};
    });
}

void add_ends(Catalogue& all) {
    all.push_back(server_case(
        "R-106/close-notify", "A session's end is the goodbye, then close_notify", [](ServerTrial& trial) {
            encrypted(trial);
            ServerPeer& peer = trial.connect(Way::bytes);
            peer.log_in();
            peer.send(ClockRequest{1, INT64_MAX});
            peer.expect_goodbye(ErrorCode::value_out_of_range);
            if (peer.stream().state() != Stream::State::ended)
                throw Failed{"the stream just stopped: whoever cuts it could do that, too"};
        }));
    Case half = server_case("R-106/half-handshake", "Half a handshake ends with the hello's deadline",
                            [](ServerTrial& trial) {
                                const Endpoint& server = encrypted(trial);
                                const Milliseconds deadline(trial.target().hello.limits.hello_deadline_ms);
                                if (deadline > trial.target().longest_wait)
                                    throw Skipped{"the hello's deadline is too far: --longest-wait"};
                                auto tcp = connect_tcp(server, trial.target().patience);
                                tcp->write(Bytes{0x16, 3, 1, 2, 0, 1, 0, 1, 0xfc, 3, 3});
                                std::array<uint8_t, 4096> answer;
                                const Deadline patience(deadline + trial.target().patience);
                                while (!patience.passed() && tcp->state() == Stream::State::open)
                                    tcp->read(answer, patience.left());
                                if (tcp->state() == Stream::State::open)
                                    throw Failed{"the connection stays open beyond the hello's deadline"};
                            });
    half.course = Course::waiting;
    all.push_back(std::move(half));
}

void add_choices(Catalogue& all) {
    all.push_back(server_case("R-104/raw-inside-tls", "Inside TLS a raw stream is told by its first bytes",
                              [](ServerTrial& trial) {
                                  encrypted(trial);
                                  ServerPeer& peer = trial.connect(Way::bytes);
                                  peer.log_in();
                                  peer.expect_service();
                              }));
    all.push_back(server_case(
        "R-104/web-inside-tls", "Inside TLS a WebSocket is told by its first bytes", [](ServerTrial& trial) {
            encrypted(trial);
            WebPeer web(trial);
            if (const std::string head = web.upgrade(); status_of(head) != 101)
                throw Failed{fmt::format("the upgrade is answered '{}'", head.substr(0, head.find('\r')))};
            web.send(ServerPeer::usual_hello());
            if (!std::holds_alternative<ServerHello>(web.receive_message()))
                throw Failed{"R-121: the first message is no hello"};
        }));
    all.push_back(server_case("R-104/tls-inside-tls", "Inside TLS, TLS does not begin once more",
                              [](ServerTrial& trial) {
                                  encrypted(trial);
                                  ServerPeer& peer = trial.connect(Way::bytes);
                                  Bytes record{0x16, 3, 1, 0, 100};
                                  record.resize(105, 0x5a);
                                  peer.send_bytes(record);
                                  peer.expect_goodbye(ErrorCode::wrong_magic);
                              }));
    all.push_back(server_case(
        "R-104/plain-beside-tls", "The same port still tells who lives, without TLS", [](ServerTrial& trial) {
            encrypted(trial);
            ServerPeer& peer = trial.connect(Way::plain);
            const std::string request = "GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n";
            peer.send_bytes({reinterpret_cast<const uint8_t*>(request.data()), request.size()});
            const Bytes answer = peer.stream().next_bytes(trial.target().patience);
            if (status_of({answer.begin(), answer.end()}) != 200)
                throw Failed{"GET /livez is not answered 200 in the clear"};
        }));
}

}  // namespace

void add_tls_cases(Catalogue& all) {
    add_handshakes(all);
    add_ends(all);
    add_choices(all);
}

}  // namespace trochoid::conformance::server
