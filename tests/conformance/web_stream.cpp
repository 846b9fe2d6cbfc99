#include "tests/conformance/web_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "tests/conformance/framed_stream.hpp"

namespace trochoid::conformance {

namespace {

std::span<const uint8_t> bytes_of(const std::string& text) {
    return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

class OverBytes final : public Stream {
public:
    OverBytes(std::unique_ptr<Stream> inner, const std::string& host, Milliseconds within)
        : inner_(std::move(inner)) {
        const Deadline deadline(within);
        inner_->write(bytes_of(web_upgrade(host)));
        auto head = take_head(unread_);
        while (!head) {
            if (!read_more(deadline.left())) throw Failed{"R-105: no answer to an upgrade came"};
            head = take_head(unread_);
        }
        if (status_of(*head) != 101)
            throw Failed{
                fmt::format("R-105: an upgrade is answered '{}'", head->substr(0, head->find('\r')))};
    }

    bool keeps_messages() const override { return true; }
    bool write_message(std::span<const uint8_t> payload) override {
        return state_ == State::open && inner_->write(web_frame(web_last | web_binary, payload));
    }
    std::optional<Bytes> read_message(Milliseconds within) override {
        const Deadline deadline(within);
        while (state_ == State::open) {
            if (auto frame = take_web_frame(unread_)) {
                if (take(std::move(*frame), deadline)) return std::exchange(message_, {});
            } else if (!read_more(deadline.left())) {
                if (inner_->state() != State::open) state_ = State::reset;
                return std::nullopt;
            }
        }
        return std::nullopt;
    }

    /// Cases about bytes have nothing to try here.
    bool write(std::span<const uint8_t>) override { return false; }
    size_t read(std::span<uint8_t>, Milliseconds) override { return 0; }
    State state() const override { return state_; }
    void finish() override {
        inner_->write(web_frame(web_last | web_close, std::array<uint8_t, 2>{3, 0xe8}));
    }
    void abort() override {
        inner_->abort();
        state_ = State::reset;
    }

private:
    bool read_more(Milliseconds within) {
        std::array<uint8_t, 16'384> chunk;
        const size_t count = inner_->read(chunk, within);
        unread_.insert(unread_.end(), chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(count));
        return count > 0;
    }

    /// True where `message_` is whole.
    bool take(WebMessage frame, const Deadline& deadline) {
        switch (frame.opcode) {
            case web_ping: inner_->write(web_frame(web_last | web_pong, frame.payload)); return false;
            case web_pong: return false;
            case web_close:
                inner_->write(web_frame(web_last | web_close, frame.payload));
                while (read_more(deadline.left())) unread_.clear();
                if (inner_->state() != State::open) state_ = State::ended;
                return false;
            case web_binary:
            case web_continuation:
                if ((frame.opcode == web_continuation) != within_message_)
                    throw Failed{
                        "R-105: a message of the server's is in pieces that do not follow each other"};
                within_message_ = !frame.last;
                message_.insert(message_.end(), frame.payload.begin(), frame.payload.end());
                return frame.last;
            default:
                throw Failed{
                    fmt::format("R-105: a frame of opcode {} came where a binary one was due", frame.opcode)};
        }
    }

    std::unique_ptr<Stream> inner_;
    Bytes unread_;
    Bytes message_;
    bool within_message_ = false;
    State state_ = State::open;
};

}  // namespace

uint16_t close_code_of(const WebMessage& close) {
    constexpr uint16_t none = 1005;
    if (close.payload.size() < 2) return none;
    return static_cast<uint16_t>(close.payload[0] << 8 | close.payload[1]);
}

Bytes web_frame(uint8_t first, std::span<const uint8_t> payload, bool masked) {
    const uint8_t mask_bit = masked ? 0x80 : 0;
    const size_t size = payload.size();
    const int size_bytes = size < 126 ? 0 : (size < 65536 ? 2 : 8);
    constexpr size_t longest_head = 14;
    Bytes frame;
    frame.reserve(size + longest_head);
    frame.push_back(first);
    const auto announced = static_cast<uint8_t>(size_bytes == 0 ? size : (size_bytes == 2 ? 126 : 127));
    frame.push_back(static_cast<uint8_t>(mask_bit | announced));
    for (int i = size_bytes - 1; i >= 0; --i)
        frame.push_back(static_cast<uint8_t>(uint64_t{size} >> (8 * i)));
    constexpr std::array<uint8_t, 4> mask{0x12, 0x34, 0x56, 0x78};
    if (masked) frame.insert(frame.end(), mask.begin(), mask.end());
    for (size_t i = 0; i < size; ++i) frame.push_back(masked ? payload[i] ^ mask[i % 4] : payload[i]);
    return frame;
}

std::optional<WebMessage> take_web_frame(Bytes& unread) {
    if (unread.size() < 2) return std::nullopt;
    if ((unread[1] & 0x80) != 0) throw Failed{"R-105: the server masks its frames"};
    if ((unread[0] & 0x70) != 0)
        throw Failed{"R-105: a frame of the server's has reserved bits: nothing was agreed on"};
    uint64_t size = unread[1];
    const size_t bytes = size == 127 ? 8 : (size == 126 ? 2 : 0);
    if (unread.size() < 2 + bytes) return std::nullopt;
    if (bytes > 0) size = 0;
    for (size_t i = 0; i < bytes; ++i) size = size << 8 | unread[2 + i];
    constexpr uint64_t most = uint64_t{1} << 24;  // that any server's limits may allow
    if (size > most) throw Failed{fmt::format("R-103: a message of {} bytes comes", size)};
    const size_t begin = 2 + bytes;
    if (unread.size() < begin + size) return std::nullopt;
    const auto at = unread.begin() + static_cast<std::ptrdiff_t>(begin);
    WebMessage message{static_cast<uint8_t>(unread[0] & 0x0f),
                       Bytes(at, at + static_cast<std::ptrdiff_t>(size)), (unread[0] & web_last) != 0};
    unread.erase(unread.begin(), at + static_cast<std::ptrdiff_t>(size));
    return message;
}

std::string web_upgrade(const std::string& host, const std::string& except, const std::string& more) {
    std::string text = "GET / HTTP/1.1\r\n";
    for (const std::string& line :
         {"Host: " + host, std::string("Upgrade: websocket"), std::string("Connection: Upgrade"),
          std::string("Sec-WebSocket-Version: 13"),
          std::string("Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ=="),
          std::string("Sec-WebSocket-Protocol: trochoid")})
        if (except.empty() || !line.starts_with(except)) text += line + "\r\n";
    return text + (more.empty() ? "\r\n" : more + "\r\n\r\n");
}

std::optional<std::string> take_head(Bytes& unread) {
    constexpr std::string_view end = "\r\n\r\n";
    const auto at = std::search(unread.begin(), unread.end(), end.begin(), end.end());
    if (at == unread.end()) return std::nullopt;
    std::string head(unread.begin(), at);
    unread.erase(unread.begin(), at + static_cast<std::ptrdiff_t>(end.size()));
    return head;
}

int status_of(const std::string& answer) {
    constexpr size_t status_at = 9;
    if (!answer.starts_with("HTTP/1.") || answer.size() < status_at + 3) return 0;
    return std::atoi(answer.substr(status_at, 3).c_str());
}

std::unique_ptr<Stream> begin_web(std::unique_ptr<Stream> inner, const std::string& host,
                                  Milliseconds within) {
    return std::make_unique<OverBytes>(std::move(inner), host, within);
}

}  // namespace trochoid::conformance
