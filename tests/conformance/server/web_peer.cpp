#include "tests/conformance/server/web_peer.hpp"

#include <fmt/format.h>

namespace trochoid::conformance::server {

namespace {

std::span<const uint8_t> bytes_of(const std::string& text) {
    return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

}  // namespace

bool WebPeer::read_more() {
    const Bytes more = stream().next_bytes(target_.patience);
    unread_.insert(unread_.end(), more.begin(), more.end());
    return !more.empty();
}

std::string WebPeer::request(const std::string& text) {
    stream().send_bytes(bytes_of(text));
    while (read_more()) {
    }
    if (stream().state() == Stream::State::open)
        throw Failed{"R-104: the server does not close after its answer"};
    return {unread_.begin(), unread_.end()};
}

std::string WebPeer::upgrade(const std::string& except, const std::string& more) {
    stream().send_bytes(bytes_of(web_upgrade(host_and_port(target_.server), except, more)));
    auto head = take_head(unread_);
    while (!head && read_more()) head = take_head(unread_);
    return head ? *head : std::string(unread_.begin(), unread_.end());
}

void WebPeer::send_frame(uint8_t first, std::span<const uint8_t> payload, bool masked) {
    stream().send_bytes(web_frame(first, payload, masked));
}

std::optional<WebMessage> WebPeer::receive() {
    auto message = take_web_frame(unread_);
    while (!message && read_more()) message = take_web_frame(unread_);
    return message;
}

ServerMessage WebPeer::receive_message() {
    const auto message = receive();
    if (!message) throw Failed{"no message came"};
    if (message->opcode != web_binary)
        throw Failed{
            fmt::format("R-105: a frame of opcode {} came where a binary one was due", message->opcode)};
    Result<ServerMessage> decoded = decode_server(message->payload);
    if (!decoded) throw Failed{"the server's message is refused: " + decoded.error().message};
    return std::move(*decoded);
}

WebEnd WebPeer::expect_end() {
    WebEnd end;
    while (const auto message = receive()) {
        if (message->opcode == web_close) {
            end.close_code = close_code_of(*message);
            send_frame(web_last | web_close, message->payload);
        } else if (message->opcode == web_binary && end.close_code == 0) {
            const Result<ServerMessage> said = decode_server(message->payload);
            if (const auto* goodbye = said ? std::get_if<Goodbye>(&*said) : nullptr) end.told = goodbye->code;
        }
    }
    while (read_more()) {
    }
    if (stream().state() == Stream::State::open) throw Failed{"the server did not end the connection"};
    return end;
}

}  // namespace trochoid::conformance::server
