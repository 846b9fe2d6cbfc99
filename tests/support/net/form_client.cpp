#include "tests/support/net/form_client.hpp"

#include <array>
#include <utility>

#include "protocol/codec/codec.hpp"
#include "protocol/units/assert.hpp"
#include "tests/support/net/raw_client.hpp"

namespace trochoid {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::array<uint8_t, 4> mask{0x12, 0x34, 0x56, 0x78};

FormClient::Milliseconds left(Clock::time_point until) {
    return std::max(std::chrono::duration_cast<FormClient::Milliseconds>(until - Clock::now()),
                    FormClient::Milliseconds(0));
}

}  // namespace

std::string UpgradeWish::text() const {
    std::string all = "GET " + target + " HTTP/1.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n";
    const auto add = [&all](const char* name, const std::string& value) {
        if (!value.empty()) all += std::string(name) + ": " + value + "\r\n";
    };
    add("Host", host);
    add("Origin", origin);
    add("Sec-WebSocket-Protocol", subprotocol);
    add("Sec-WebSocket-Version", version);
    add("Sec-WebSocket-Key", key);
    return all + further + "\r\n";
}

Bytes WebFrame::bytes() const {
    Bytes all{static_cast<uint8_t>((last ? 0x80U : 0U) | (uint32_t{reserved} << 4) | opcode)};
    const uint8_t mask_bit = masked ? 0x80 : 0;
    const size_t length = payload.size();
    if (length < 126) {
        all.push_back(static_cast<uint8_t>(mask_bit | length));
    } else {
        const size_t width = length < 65536 ? 2 : 8;
        all.push_back(static_cast<uint8_t>(mask_bit | (width == 2 ? 126 : 127)));
        for (size_t i = width; i-- > 0;) all.push_back(static_cast<uint8_t>(length >> (8 * i)));
    }
    if (masked) all.insert(all.end(), mask.begin(), mask.end());
    for (size_t i = 0; i < length; ++i)
        all.push_back(masked ? static_cast<uint8_t>(payload[i] ^ mask[i % 4]) : payload[i]);
    return all;
}

FormClient::FormClient(Form form, uint16_t port)
    : FormClient(form, form == Form::tls || form == Form::web_tls ? connect_tls(port) : connect_tcp(port)) {}

FormClient::FormClient(Form form, std::unique_ptr<BytePipe> pipe) : form_(form), pipe_(std::move(pipe)) {
    TROCHOID_ASSERT(pipe_, "no connection for a {} client", name_of(form));
}

bool FormClient::read_more(Milliseconds within) {
    std::array<uint8_t, 16384> buffer{};
    const size_t bytes = pipe_->read(buffer, within);
    arrived_.insert(arrived_.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(bytes));
    return bytes > 0;
}

bool FormClient::open(const UpgradeWish& wish) {
    if (!web()) return pipe_->write(stream_magic);
    if (!pipe_->write(wish.text())) return false;
    const auto until = Clock::now() + BytePipe::patience;
    while (true) {
        const std::string text(arrived_.begin(), arrived_.end());
        const size_t end = text.find("\r\n\r\n");
        if (end != std::string::npos) {
            answer_ = text.substr(0, end + 4);
            arrived_.erase(arrived_.begin(), arrived_.begin() + static_cast<std::ptrdiff_t>(end + 4));
            return answer_.starts_with("HTTP/1.1 101 ");
        }
        if (!read_more(left(until))) return false;
    }
}

bool FormClient::send(const ClientMessage& message) {
    const Bytes payload = encode(message);
    if (!web()) return pipe_->write(std::span<const uint8_t>(frame(payload)));
    WebFrame binary;
    binary.payload = payload;
    return pipe_->write(std::span<const uint8_t>(binary.bytes()));
}

std::optional<ServerHello> FormClient::log_in() {
    if (!open() || !send(RawClient::usual_hello())) return std::nullopt;
    auto first = receive();
    if (!first || !std::holds_alternative<ServerHello>(*first)) return std::nullopt;
    return std::get<ServerHello>(std::move(*first));
}

std::optional<Bytes> FormClient::next_web_payload() {
    while (close_code_ == 0 && arrived_.size() >= 2) {
        size_t length = arrived_[1] & 0x7fU;
        size_t header = 2;
        if (length >= 126) {
            const size_t width = length == 126 ? 2 : 8;
            header += width;
            if (arrived_.size() < header) return std::nullopt;
            length = 0;
            for (size_t i = 2; i < header; ++i) length = (length << 8) | arrived_[i];
        }
        if (arrived_.size() < header + length) return std::nullopt;
        const auto begin = arrived_.begin() + static_cast<std::ptrdiff_t>(header);
        Bytes payload(begin, begin + static_cast<std::ptrdiff_t>(length));
        const uint8_t first = arrived_[0];
        odd_frames_ = odd_frames_ || (first & 0xf0U) != 0x80U || (arrived_[1] & 0x80U) != 0;
        arrived_.erase(arrived_.begin(), begin + static_cast<std::ptrdiff_t>(length));
        switch (first & 0xfU) {
            case 2: return payload;
            case 8:
                close_code_ = payload.size() < 2 ? 1005U : (unsigned{payload[0]} << 8) | payload[1];
                if (payload.size() > 2) close_reason_.assign(payload.begin() + 2, payload.end());
                break;
            case 10: pongs_.push_back(payload); break;
            default: odd_frames_ = true; break;
        }
    }
    return std::nullopt;
}

std::optional<Bytes> FormClient::next_payload() {
    if (web()) return next_web_payload();
    std::span<const uint8_t> input(arrived_);
    auto payload = frames_.next(input);
    arrived_.erase(arrived_.begin(), arrived_.end() - static_cast<std::ptrdiff_t>(input.size()));
    TROCHOID_ASSERT(payload.has_value(), "the server's stream is broken: {}", payload.error().message);
    return std::move(*payload);
}

std::optional<ServerMessage> FormClient::receive(Milliseconds within) {
    const auto until = Clock::now() + within;
    while (true) {
        if (const auto payload = next_payload()) {
            Result<ServerMessage> message = decode_server(*payload);
            TROCHOID_ASSERT(message.has_value(), "the server sent: {}", message.error().message);
            return std::move(*message);
        }
        if (close_code_ != 0 || !read_more(left(until))) return std::nullopt;
    }
}

bool FormClient::ends(Milliseconds within) {
    const auto until = Clock::now() + within;
    while (receive(left(until))) {
    }
    if (web()) {
        if (close_code_ == 0) return false;
        WebFrame close;
        close.opcode = 8;
        close.payload = {static_cast<uint8_t>(close_code_ >> 8), static_cast<uint8_t>(close_code_)};
        pipe_->write(std::span<const uint8_t>(close.bytes()));
    }
    while (read_more(left(until))) {
    }
    const bool properly = pipe_->ended_properly();
    pipe_->close();
    return properly;
}

}  // namespace trochoid
