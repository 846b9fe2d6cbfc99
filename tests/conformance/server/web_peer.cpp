#include "tests/conformance/server/web_peer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>

namespace trochoid::conformance::server {

namespace {

std::span<const uint8_t> bytes_of(const std::string& text) {
    return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

}  // namespace

int status_of(const std::string& answer) {
    constexpr size_t status_at = 9;
    if (!answer.starts_with("HTTP/1.") || answer.size() < status_at + 3) return 0;
    return std::atoi(answer.substr(status_at, 3).c_str());
}

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
    std::string text = "GET / HTTP/1.1\r\n";
    for (const std::string& line :
         {fmt::format("Host: {}", host_and_port(target_.server)), std::string("Upgrade: websocket"),
          std::string("Connection: Upgrade"), std::string("Sec-WebSocket-Version: 13"),
          std::string("Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ=="),
          std::string("Sec-WebSocket-Protocol: trochoid")})
        if (except.empty() || !line.starts_with(except)) text += line + "\r\n";
    text += more.empty() ? "\r\n" : more + "\r\n\r\n";
    stream().send_bytes(bytes_of(text));
    constexpr std::string_view end = "\r\n\r\n";
    auto at = unread_.end();
    do {
        at = std::search(unread_.begin(), unread_.end(), end.begin(), end.end());
    } while (at == unread_.end() && read_more());
    std::string head(unread_.begin(), at);
    if (at != unread_.end()) unread_.erase(unread_.begin(), at + static_cast<std::ptrdiff_t>(end.size()));
    return head;
}

void WebPeer::send_frame(uint8_t first, std::span<const uint8_t> payload, bool masked) {
    Bytes frame{first};
    const uint8_t mask_bit = masked ? 0x80 : 0;
    const size_t size = payload.size();
    if (size < 126) {
        frame.push_back(static_cast<uint8_t>(mask_bit | size));
    } else if (size < 65536) {
        frame.insert(frame.end(), {static_cast<uint8_t>(mask_bit | 126), static_cast<uint8_t>(size >> 8),
                                   static_cast<uint8_t>(size)});
    } else {
        frame.push_back(static_cast<uint8_t>(mask_bit | 127));
        for (int shift = 56; shift >= 0; shift -= 8)
            frame.push_back(static_cast<uint8_t>(uint64_t{size} >> shift));
    }
    constexpr std::array<uint8_t, 4> mask{0x12, 0x34, 0x56, 0x78};
    if (masked) frame.insert(frame.end(), mask.begin(), mask.end());
    for (size_t i = 0; i < size; ++i) frame.push_back(masked ? payload[i] ^ mask[i % 4] : payload[i]);
    stream().send_bytes(frame);
}

std::optional<WebMessage> WebPeer::receive() {
    const auto want = [&](size_t count) {
        while (unread_.size() < count)
            if (!read_more()) return false;
        return true;
    };
    if (!want(2)) return std::nullopt;
    if ((unread_[1] & 0x80) != 0) throw Failed{"R-105: the server masks its frames"};
    if ((unread_[0] & 0x70) != 0)
        throw Failed{"R-105: a frame of the server's has reserved bits: nothing was agreed on"};
    uint64_t size = unread_[1];
    const size_t bytes = size == 127 ? 8 : (size == 126 ? 2 : 0);
    if (!want(2 + bytes)) return std::nullopt;
    if (bytes > 0) size = 0;
    for (size_t i = 0; i < bytes; ++i) size = size << 8 | unread_[2 + i];
    if (size > Limits{}.frame_to_client)
        throw Failed{fmt::format("R-103: a message of {} bytes comes", size)};
    const size_t begin = 2 + bytes;
    if (!want(begin + size)) return std::nullopt;
    const auto at = unread_.begin() + static_cast<std::ptrdiff_t>(begin);
    WebMessage message{static_cast<uint8_t>(unread_[0] & 0x0f),
                       Bytes(at, at + static_cast<std::ptrdiff_t>(size))};
    unread_.erase(unread_.begin(), at + static_cast<std::ptrdiff_t>(size));
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

void WebPeer::expect_end() {
    while (read_more()) {
    }
    if (stream().state() == Stream::State::open) throw Failed{"the server did not end the connection"};
}

}  // namespace trochoid::conformance::server
