#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tests/conformance/client/refusals.hpp"
#include "tests/conformance/kit_sea.hpp"
#include "tests/conformance/web_stream.hpp"

// how a client begins, and its WebSocket.
namespace trochoid::conformance::client {

namespace {

/// A client at our WebSocket: the protocol over it, and what is below.
struct WebVisit {
    ClientPeer& peer;
    WebStream& web;
};

WebVisit visit(ClientTrial& trial, const WebAnswer& answer = {}) {
    if (!is_web(trial.target().transport)) throw Skipped{"needs a WebSocket: --transport ws or wss"};
    auto stream = accept_web(trial.come(Way::bytes), answer, trial.target().patience);
    WebStream& web = *stream;
    return {trial.meet(std::move(stream)), web};
}
WebVisit logged_in(ClientTrial& trial) {
    const WebVisit at = visit(trial);
    at.peer.welcome();
    return at;
}

void send(const WebVisit& at, uint8_t first, std::span<const uint8_t> payload, bool masked = false) {
    at.web.write_below(web_frame(first, payload, masked));
}

/// The client's end, without a word of ours.
void await_end(const WebVisit& at, ClientTrial& trial) {
    const Deadline deadline(trial.target().patience);
    while (at.web.state() == Stream::State::open && !deadline.passed())
        if (at.peer.goodbye())
            at.peer.stream().next(deadline.left());
        else
            at.peer.receive(deadline.left());
    if (at.web.state() == Stream::State::open) throw Failed{"the client does not end the connection"};
    trial.note(at.web.close_code() == 0 ? "no close frame"
                                        : fmt::format("close code {}", at.web.close_code()));
}

/// A raw stream without its magic breaks R-101.
std::string begins_wrongly(uint8_t first, bool raw) {
    return fmt::format("{}: the stream begins with {:02x}", raw ? "R-101" : "R-104", first);
}

void add_first_bytes(Catalogue& all) {
    const auto fits = [](uint8_t first, Transport transport) {
        if (is_encrypted(transport)) return first == tls_handshake_record;
        return transport == Transport::ws ? first >= 'A' && first <= 'Z' : first == stream_magic[0];
    };
    all.push_back(client_case(
        "R-104/speaks-first", "The client speaks first, with a byte that tells what it speaks",
        [fits](ClientTrial& trial) {
            const auto tcp = trial.come(Way::plain);
            std::array<uint8_t, 1> first{};
            if (tcp->read(first, Milliseconds(Limits{}.hello_deadline_ms)) == 0)
                throw Failed{"nothing came before the hello's deadline"};
            if (!fits(first[0], trial.target().transport))
                throw Failed{begins_wrongly(first[0], trial.target().transport == Transport::tcp)};
        }));
    all.push_back(client_case(
        "R-104/inside-tls", "Inside TLS a raw stream, or an upgrade, begins", [](ClientTrial& trial) {
            if (!trial.target().tls) throw Skipped{"needs TLS: --transport tls or wss"};
            const auto stream = trial.come(Way::bytes);
            std::array<uint8_t, 1> first{};
            stream->read(first, Milliseconds(Limits{}.hello_deadline_ms));
            const uint8_t wanted = is_web(trial.target().transport) ? 'G' : stream_magic[0];
            if (first[0] != wanted) throw Failed{begins_wrongly(first[0], !is_web(trial.target().transport))};
        }));
}

void add_upgrades(Catalogue& all) {
    all.push_back(client_case("R-105/upgrade", "The client asks for version 13 and the subprotocol trochoid",
                              [](ClientTrial& trial) { logged_in(trial).peer.expect_service(); }));
    const auto left = [&](const char* id, const char* title, const WebAnswer& answer) {
        all.push_back(client_case(std::string("R-105/") + id, title, [answer](ClientTrial& trial) {
            const WebVisit at = visit(trial, answer);
            if (at.peer.receive(trial.target().patience) && !at.peer.goodbye())
                throw Failed{"R-105: the client goes on after an answer that it may not take"};
            await_end(at, trial);
        }));
    };
    left("refused-403", "The upgrade is answered 403: the client leaves", {"403 Forbidden", "", ""});
    left("refused-503", "The upgrade is answered 503: the client leaves",
         {"503 Service Unavailable", "", ""});
    left("answered-200", "The upgrade is answered 200: the client leaves", {"200 OK", "", ""});
    left("no-subprotocol", "The answer does not name the subprotocol: the client leaves",
         {"", "Sec-WebSocket-Protocol", ""});
    left("other-subprotocol", "The answer names another subprotocol: the client leaves",
         {"", "Sec-WebSocket-Protocol", "Sec-WebSocket-Protocol: chat"});
    left("no-accept", "The answer does not show that the key was read: the client leaves",
         {"", "Sec-WebSocket-Accept", ""});
    left("other-accept", "The answer is that to another key: the client leaves",
         {"", "Sec-WebSocket-Accept", "Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo="});
    left("extension", "The answer agrees to an extension that nobody knows: the client leaves",
         {"", "", "Sec-WebSocket-Extensions: trochoid-none"});
}

void add_messages(Catalogue& all) {
    const auto add = [&](const char* id, const char* title, ClientBody body) {
        all.push_back(client_case(std::string("R-105/") + id, title, std::move(body)));
    };
    add("masks", "The client masks what it sends, in binary messages without reserved bits",
        [](ClientTrial& trial) {
            const WebVisit at = logged_in(trial);
            at.peer.expect_service();
            at.peer.listen(Milliseconds(500));
        });
    add("fragments", "Our hello comes in fragments with a ping among them", [](ClientTrial& trial) {
        const WebVisit at = visit(trial);
        at.peer.await_hello();
        at.peer.prepare(at.peer.usual_hello());
        const Bytes hello = encode(ServerMessage{at.peer.ours()});
        const std::array<uint8_t, 3> payload{1, 2, 3};
        send(at, web_binary, std::span(hello).first(10));
        send(at, web_last | web_ping, payload);
        send(at, web_continuation, std::span(hello).subspan(10, 10));
        send(at, web_last | web_continuation, std::span(hello).subspan(20));
        at.peer.expect_service();
        const auto fits = [&](const Bytes& pong) {
            return std::equal(pong.begin(), pong.end(), payload.begin(), payload.end());
        };
        if (std::none_of(at.web.pongs().begin(), at.web.pongs().end(), fits))
            throw Failed{"the ping was not answered with its payload"};
    });
    add("unasked-pong", "A pong that nobody asked for is passed by", [](ClientTrial& trial) {
        const WebVisit at = logged_in(trial);
        send(at, web_last | web_pong, std::array<uint8_t, 2>{7, 7});
        at.peer.expect_service();
    });
    add("close", "We close the WebSocket: the client answers that and ends", [](ClientTrial& trial) {
        const WebVisit at = logged_in(trial);
        at.peer.expect_service();
        at.web.finish();
        await_end(at, trial);
        if (at.web.close_code() == 0) throw Failed{"the close frame is not answered"};
    });
    add("goodbye", "A client that leaves says goodbye, then closes the WebSocket", [](ClientTrial& trial) {
        const WebVisit at = logged_in(trial);
        at.peer.send(at.peer.ours());
        await_end(at, trial);
        if (!at.peer.goodbye()) throw Failed{"no goodbye came"};
        if (const std::string wrong = at.web.wrong_end(); !wrong.empty()) throw Failed{wrong};
    });
}

/// What is refused with a goodbye.
void add_refused(Catalogue& all) {
    const auto refused = [&](const char* id, const char* title, Due due,
                             std::function<void(const WebVisit&)> wrong) {
        all.push_back(client_case(id, title, [due, wrong = std::move(wrong)](ClientTrial& trial) {
            const WebVisit at = logged_in(trial);
            wrong(at);
            at.peer.expect_goodbye(due);
        }));
    };
    constexpr Due too_long{ErrorCode::frame_too_long, requirement::frame_length};
    constexpr size_t usual = Limits{}.frame_to_client;
    refused("R-105/text", "A text message", {ErrorCode::malformed_frame, any_due_requirement},
            [](const WebVisit& at) {
                const std::string_view text = "a text of more than eight bytes";
                send(at, web_last | web_text, {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
            });
    refused("R-105/empty-message", "A message of no bytes",
            {ErrorCode::verification_failed, requirement::file_identifier},
            [](const WebVisit& at) { send(at, web_last | web_binary, {}); });
    refused("R-103/long-message", "A WebSocket's message one byte longer than the limit", too_long,
            [](const WebVisit& at) { send(at, web_last | web_binary, Bytes(usual + 1)); });
    refused("R-103/long-in-fragments", "Fragments that make a message longer than the limit", too_long,
            [](const WebVisit& at) {
                send(at, web_binary, Bytes(usual));
                send(at, web_continuation, Bytes(usual));
            });
    refused("R-103/announced-too-long",
            "A message that announces 2^40 bytes, at the latest when more come than may", too_long,
            [](const WebVisit& at) {
                at.web.write_below(Bytes{0x82, 0x7f, 0, 0, 1, 0, 0, 0, 0, 0});
                at.web.write_below(Bytes(usual + 1));
            });
}

/// What is closed with 1002 alone.
void add_broken(Catalogue& all) {
    const auto broken = [&](const char* id, const char* title, std::function<void(const WebVisit&)> wrong) {
        all.push_back(
            client_case(std::string("R-105/") + id, title, [wrong = std::move(wrong)](ClientTrial& trial) {
                constexpr uint16_t protocol_error = 1002;
                const WebVisit at = logged_in(trial);
                wrong(at);
                await_end(at, trial);
                if (at.peer.goodbye())
                    throw Failed{
                        fmt::format("R-105: a goodbye with code {} came, a close frame alone was due",
                                    static_cast<unsigned>(at.peer.goodbye()->code))};
                if (at.web.close_code() != protocol_error)
                    throw Failed{at.web.close_code() == 0
                                     ? std::string("R-105: no close frame came, 1002 was due")
                                     : fmt::format("R-105: the close frame has code {}, not 1002",
                                                   at.web.close_code())};
            }));
    };
    const Bytes reply = encode(ServerMessage{ClockReply{}});
    broken("masked", "A frame of ours that is masked",
           [reply](const WebVisit& at) { send(at, web_last | web_binary, reply, true); });
    broken("reserved-bits", "A frame with a reserved bit",
           [reply](const WebVisit& at) { send(at, 0x40 | web_last | web_binary, reply); });
    broken("reserved-opcode", "A frame of a reserved opcode",
           [](const WebVisit& at) { send(at, web_last | 3, Bytes(4)); });
    broken("message-within-message", "A message that begins within another", [](const WebVisit& at) {
        send(at, web_binary, Bytes(8));
        send(at, web_last | web_binary, Bytes(8));
    });
    broken("continuation-first", "A continuation of nothing",
           [](const WebVisit& at) { send(at, web_last | web_continuation, Bytes(4)); });
    broken("ping-in-fragments", "A ping in fragments",
           [](const WebVisit& at) { send(at, web_ping, Bytes(4)); });
    broken("long-control", "A ping of 126 bytes",
           [](const WebVisit& at) { send(at, web_last | web_ping, Bytes(126)); });
}

}  // namespace

void add_web_cases(Catalogue& all) {
    add_first_bytes(all);
    add_upgrades(all);
    add_messages(all);
    add_refused(all);
    add_broken(all);
}

}  // namespace trochoid::conformance::client
