#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "tests/conformance/server/refusals.hpp"
#include "tests/conformance/server/web_peer.hpp"

// one port for all kinds of streams, HTTP and WebSockets.
namespace trochoid::conformance::server {

namespace {

void add_http(Catalogue& all) {
    const auto answered = [&](const char* id, const char* title, const std::string& request,
                              const std::vector<int>& statuses, const std::string& word = "") {
        all.push_back(server_case(std::string("R-104/") + id, title, [=](ServerTrial& trial) {
            const std::string answer = WebPeer(trial).request(request);
            const int status = status_of(answer);
            trial.note(answer.substr(0, answer.find('\r')));
            if (std::find(statuses.begin(), statuses.end(), status) == statuses.end())
                throw Failed{fmt::format("the answer is '{}'", answer.substr(0, answer.find('\r')))};
            if (answer.find(word) == std::string::npos)
                throw Failed{fmt::format("the answer has no '{}'", word)};
        }));
    };
    const std::string host = "Host: localhost\r\n\r\n";
    answered("livez", "It answers whether it lives", "GET /livez HTTP/1.1\r\n" + host, {200});
    answered("readyz", "It answers whether it is ready", "GET /readyz HTTP/1.1\r\n" + host, {200});
    answered("metrics", "It tells its figures", "GET /metrics HTTP/1.1\r\n" + host, {200}, "# TYPE");
    answered("head", "HEAD is answered without a body", "HEAD /livez HTTP/1.1\r\n" + host, {200});
    answered("http-1-0", "HTTP 1.0 is answered", "GET /livez HTTP/1.0\r\n\r\n", {200});
    answered("query", "A query behind the path is let pass, or not known",
             "GET /livez?x=1 HTTP/1.1\r\n" + host, {200, 400, 404});
    answered("root", "A page is told what this is", "GET / HTTP/1.1\r\n" + host, {200, 400, 426});
    answered("elsewhere", "Another path is not known", "GET /elsewhere HTTP/1.1\r\n" + host, {404});
    answered("dots", "A path that climbs is not known", "GET /../../etc/passwd HTTP/1.1\r\n" + host,
             {400, 404});
    answered("post", "POST is not allowed", "POST /livez HTTP/1.1\r\nContent-Length: 0\r\n" + host, {405});
    answered("trace", "TRACE is not allowed, though it begins like the magic", "TRACE / HTTP/1.1\r\n" + host,
             {405});
    answered("connect", "CONNECT is not allowed", "CONNECT a:1 HTTP/1.1\r\nHost: a:1\r\n\r\n", {400, 405});
    answered("nonsense", "Nonsense in capitals is a bad request", "NONSENSE\r\n\r\n", {400, 405});
    answered("no-host", "HTTP 1.1 without a host is a bad request", "GET /livez HTTP/1.1\r\n\r\n",
             {200, 400});
    answered("long-header", "A head of 64 KiB is too long",
             "GET / HTTP/1.1\r\nX: " + std::string(65536, 'x') + "\r\n" + host, {400, 413, 414, 431});
    answered("long-path", "A path of 32 KiB is too long",
             "GET /" + std::string(32768, 'x') + " HTTP/1.1\r\n" + host, {400, 404, 413, 414, 431});
    answered("bad-length", "Two lengths are a bad request",
             "GET / HTTP/1.1\r\nContent-Length: 5\r\nContent-Length: 6\r\n" + host, {400, 413, 426});
    for (const uint8_t first : {uint8_t{0}, uint8_t{'t'}, uint8_t{0x80}, uint8_t{0xff}})
        all.push_back(server_case(fmt::format("R-104/first-byte-{:02x}", first),
                                  "A stream that begins like none of them is refused by its magic",
                                  [first](ServerTrial& trial) {
                                      ServerPeer& peer = trial.connect(Way::bytes);
                                      std::array<uint8_t, 16> bytes{};
                                      bytes.fill(first);
                                      peer.send_bytes(bytes);
                                      peer.expect_goodbye(ErrorCode::wrong_magic);
                                  }));
    all.push_back(server_case("R-106/no-handshake",
                              "A TLS record with nothing right in it ends the connection",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.connect(Way::plain);
                                  Bytes record{0x16, 3, 1, 0, 100};
                                  record.resize(105, 0x5a);
                                  peer.send_bytes(record);
                                  const Deadline deadline(trial.target().patience);
                                  while (!deadline.passed() && peer.stream().state() == Stream::State::open)
                                      peer.stream().next_bytes(deadline.left());
                                  if (peer.stream().state() == Stream::State::open)
                                      throw Failed{"the connection stays open"};
                              }));
}

WebPeer upgraded(ServerTrial& trial) {
    WebPeer web(trial);
    const std::string head = web.upgrade();
    if (status_of(head) != 101)
        throw Failed{fmt::format("the upgrade is answered '{}'", head.substr(0, head.find('\r')))};
    return web;
}

WebPeer logged_in(ServerTrial& trial) {
    WebPeer web = upgraded(trial);
    web.send(ServerPeer::usual_hello());
    if (!std::holds_alternative<ServerHello>(web.receive_message()))
        throw Failed{"R-121: the first message is no hello"};
    return web;
}

/// Passes deltas by.
template <class Message>
Message await(WebPeer& web) {
    for (int i = 0; i < 100; ++i) {
        const ServerMessage message = web.receive_message();
        if (const auto* found = std::get_if<Message>(&message)) return *found;
    }
    throw Failed{"no answer came among 100 messages"};
}

void add_upgrades(Catalogue& all) {
    all.push_back(server_case(
        "R-105/upgrade", "A WebSocket of the subprotocol trochoid, without compression though it is offered",
        [](ServerTrial& trial) {
            const std::string head =
                WebPeer(trial).upgrade("", "Sec-WebSocket-Extensions: permessage-deflate");
            if (status_of(head) != 101)
                throw Failed{fmt::format("the upgrade is answered '{}'", head.substr(0, head.find('\r')))};
            std::string lower = head;
            for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
            if (lower.find("sec-websocket-protocol: trochoid") == std::string::npos)
                throw Failed{"the answer does not name the subprotocol"};
            if (lower.find("sec-websocket-accept: s3pplmbitxaq9kygzzhzrbk+xoo=") == std::string::npos)
                throw Failed{"the answer has not the key's Sec-WebSocket-Accept"};
            if (lower.find("permessage-deflate") != std::string::npos)
                throw Failed{"the server agrees to compression"};
        }));
    const auto refused = [&](const char* id, const char* title, const char* except, const char* more,
                             const std::vector<int>& statuses) {
        all.push_back(server_case(std::string("R-105/") + id, title, [=](ServerTrial& trial) {
            const std::string head = WebPeer(trial).upgrade(except, more);
            const int status = status_of(head);
            if (std::find(statuses.begin(), statuses.end(), status) == statuses.end())
                throw Failed{fmt::format("the upgrade is answered '{}'", head.substr(0, head.find('\r')))};
        }));
    };
    refused("no-subprotocol", "An upgrade without the subprotocol", "Sec-WebSocket-Protocol", "", {400, 426});
    refused("other-subprotocol", "An upgrade to another subprotocol", "Sec-WebSocket-Protocol",
            "Sec-WebSocket-Protocol: chat", {400, 426});
    refused("some-subprotocols", "An upgrade that offers others too", "Sec-WebSocket-Protocol",
            "Sec-WebSocket-Protocol: chat, trochoid", {101});
    refused("other-origin", "A page of another site", "", "Origin: https://elsewhere.example", {403});
    refused("null-origin", "A page without a site", "", "Origin: null", {403});
    refused("other-host", "Another name of this machine, as after rebinding", "Host",
            "Host: elsewhere.example", {403, 421});
    refused("no-host", "An upgrade without a host", "Host", "", {400, 403});
    refused("version-12", "Another version of WebSockets", "Sec-WebSocket-Version",
            "Sec-WebSocket-Version: 12", {400, 426});
    refused("no-key", "An upgrade without a key", "Sec-WebSocket-Key", "", {400, 426});
    refused("short-key", "An upgrade with a key of 3 bytes", "Sec-WebSocket-Key", "Sec-WebSocket-Key: YWJj",
            {400, 426});
}

void expect_code(uint16_t code, const std::vector<uint16_t>& codes) {
    if (std::find(codes.begin(), codes.end(), code) != codes.end()) return;
    throw Failed{code == 0
                     ? fmt::format("R-105: the stream ended without a close frame; {} was due", codes.front())
                     : fmt::format("R-105: the close frame has code {}, not {}", code, codes.front())};
}

void add_messages(Catalogue& all) {
    const auto add = [&](const char* id, const char* title, ServerBody body) {
        all.push_back(server_case(std::string("R-105/") + id, title, std::move(body)));
    };
    add("unasked-pong", "A pong that nobody asked for is passed by", [](ServerTrial& trial) {
        WebPeer web = logged_in(trial);
        web.send_frame(web_last | web_pong, std::array<uint8_t, 2>{7, 7});
        web.send(ClockRequest{1, 77});
        await<ClockReply>(web);
    });
    add("ping-between-fragments", "A ping between the fragments of a message is answered",
        [](ServerTrial& trial) {
            WebPeer web = logged_in(trial);
            const Bytes message = encode(ClientMessage{ClockRequest{1, 77}});
            web.send_frame(web_binary, std::span(message).first(10));
            web.send_frame(web_last | web_ping, std::array<uint8_t, 1>{9});
            web.send_frame(web_last | web_continuation, std::span(message).subspan(10));
            bool pong = false;
            for (int i = 0; i < 100; ++i) {
                const auto frame = web.receive();
                if (!frame) throw Failed{"no clock reply came"};
                pong = pong || frame->opcode == web_pong;
                if (frame->opcode != web_binary) continue;
                const auto decoded = decode_server(frame->payload);
                if (decoded && std::holds_alternative<ClockReply>(*decoded)) break;
            }
            if (!pong) throw Failed{"the ping was not answered before the message's own reply"};
        });
    add("session", "Hello, clock and list over a WebSocket", [](ServerTrial& trial) {
        WebPeer web = logged_in(trial);
        web.send(ClockRequest{1, 77});
        if (await<ClockReply>(web).client_sent_us != 77) throw Failed{"the clock reply echoes another stamp"};
        Command list;
        list.sequence = 1;
        list.action = ListBoxes{};
        web.send(list);
        await<BoxList>(web);
    });
    add("goodbye", "A wrong message: the goodbye comes as a message, then the WebSocket closes",
        [](ServerTrial& trial) {
            WebPeer web = logged_in(trial);
            web.send(ClockRequest{1, INT64_MAX});
            if (await<Goodbye>(web).code != ErrorCode::value_out_of_range)
                throw Failed{"the goodbye has another code than 106"};
            // 4000 + code, as none of RFC 6455's own codes says it.
            constexpr uint16_t wanted = 4000 + static_cast<uint16_t>(ErrorCode::value_out_of_range);
            expect_code(web.expect_end().close_code, {wanted, 1011});
        });
    add("ping", "A ping is answered with its payload", [](ServerTrial& trial) {
        WebPeer web = logged_in(trial);
        const std::array<uint8_t, 3> payload{1, 2, 3};
        web.send_frame(0x80 | web_ping, payload);
        for (int i = 0; i < 100; ++i) {
            const auto message = web.receive();
            if (!message) throw Failed{"no pong came"};
            if (message->opcode != web_pong) continue;
            if (!std::equal(payload.begin(), payload.end(), message->payload.begin(), message->payload.end()))
                throw Failed{"the pong has another payload"};
            return;
        }
        throw Failed{"no pong came among 100 messages"};
    });
    add("fragments", "A message in fragments within the limit is put together", [](ServerTrial& trial) {
        WebPeer web = logged_in(trial);
        const Bytes message = encode(ClientMessage{ClockRequest{1, 77}});
        const auto whole = std::span(message);
        web.send_frame(web_binary, whole.first(10));
        web.send_frame(web_continuation, whole.subspan(10, 10));
        web.send_frame(0x80 | web_continuation, whole.subspan(20));
        await<ClockReply>(web);
    });
}

void add_web_ends(Catalogue& all) {
    const auto ends = [&](const char* id, const char* title, std::function<void(WebPeer&)> wrong,
                          std::vector<uint16_t> codes = {1002}, ErrorCode told = ErrorCode::none) {
        all.push_back(server_case(
            std::string("R-105/") + id, title,
            [wrong = std::move(wrong), codes = std::move(codes), told](ServerTrial& trial) {
                WebPeer web = logged_in(trial);
                wrong(web);
                const WebEnd end = web.expect_end();
                trial.note(fmt::format("close code {}, goodbye {}", end.close_code,
                                       static_cast<unsigned>(end.told)));
                expect_code(end.close_code, codes);
                if (told != ErrorCode::none && end.told != told)
                    throw Failed{fmt::format("R-105: before the end comes goodbye {} (0: none), not {}",
                                             static_cast<unsigned>(end.told), static_cast<unsigned>(told))};
            }));
    };
    ends(
        "text", "A text message ends the session",
        [](WebPeer& web) {
            web.send_frame(0x80 | web_text, encode(ClientMessage{ClockRequest{1, 1}}));
        },
        {1003, 4102}, ErrorCode::malformed_frame);
    ends("not-masked", "A frame that is not masked ends the session", [](WebPeer& web) {
        web.send_frame(0x80 | web_binary, encode(ClientMessage{ClockRequest{1, 1}}), false);
    });
    ends("reserved-bits", "A frame with a reserved bit ends the session", [](WebPeer& web) {
        web.send_frame(0xc0 | web_binary, encode(ClientMessage{ClockRequest{1, 1}}));
    });
    ends("reserved-opcode", "A frame of a reserved opcode ends the session",
         [](WebPeer& web) { web.send_frame(0x83, Bytes(4)); });
    ends(
        "too-long", "A message of more than frames may have ends the session",
        [](WebPeer& web) { web.send_frame(0x80 | web_binary, Bytes(65536 + 8)); }, {1009, 4101},
        ErrorCode::frame_too_long);
    ends(
        "too-long-in-fragments", "Fragments that make a message of more than frames may have end the session",
        [](WebPeer& web) {
            for (int i = 0; i < 3; ++i) web.send_frame(i == 0 ? web_binary : web_continuation, Bytes(30'000));
        },
        {1009, 4101}, ErrorCode::frame_too_long);
    ends(
        "announced-too-long",
        "A frame that announces 2^40 bytes ends the session, at the latest when more come than may",
        [](WebPeer& web) {
            web.stream().send_bytes(Bytes{0x82, 0xff, 0, 0, 1, 0, 0, 0, 0, 0, 1, 2, 3, 4});
            web.stream().send_bytes(Bytes(65'536 + 8));
        },
        {1009, 4101}, ErrorCode::frame_too_long);
    ends("message-within-message", "A message that begins within another ends the session", [](WebPeer& web) {
        web.send_frame(web_binary, Bytes(8));
        web.send_frame(web_last | web_binary, Bytes(8));
    });
    ends("ping-in-fragments", "A ping in fragments ends the session",
         [](WebPeer& web) { web.send_frame(web_ping, Bytes(4)); });
    ends("long-control", "A ping of 126 bytes ends the session",
         [](WebPeer& web) { web.send_frame(0x80 | web_ping, Bytes(126)); });
    ends("continuation-first", "A continuation of nothing ends the session",
         [](WebPeer& web) { web.send_frame(0x80 | web_continuation, Bytes(4)); });
    ends("empty-message", "A message of no bytes ends the session",
         [](WebPeer& web) { web.send_frame(0x80 | web_binary, {}); }, {4102, 4103, 4105});
    ends("close", "A close frame ends the session",
         [](WebPeer& web) {
             web.send_frame(0x80 | web_close, std::array<uint8_t, 2>{3, 0xe8});
         },
         {1000});
}

}  // namespace

void add_front_cases(Catalogue& all) {
    add_http(all);
    add_upgrades(all);
    add_messages(all);
    add_web_ends(all);
}

}  // namespace trochoid::conformance::server
