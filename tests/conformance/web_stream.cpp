#include "tests/conformance/web_stream.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <map>
#include <sstream>
#include <utility>

#include "tests/conformance/framed_stream.hpp"

namespace trochoid::conformance {

namespace {

std::span<const uint8_t> bytes_of(const std::string& text) {
    return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

const char* name_of(WebRole role) { return role == WebRole::client ? "client" : "server"; }

std::string lower_of(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

/// Values of an upgrade's header lines by their names in small letters; lines of one name are one list.
std::map<std::string, std::string> fields_of(const std::string& head) {
    std::map<std::string, std::string> fields;
    std::istringstream lines(head);
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
        const size_t colon = line.find(':');
        const size_t begin = line.find_first_not_of(" \t", colon + 1);
        if (colon == std::string::npos || begin == std::string::npos) continue;
        const size_t end = line.find_last_not_of(" \t\r");
        std::string& value = fields[lower_of(line.substr(0, colon))];
        value += (value.empty() ? "" : ",") + line.substr(begin, end + 1 - begin);
    }
    return fields;
}

/// Whether the comma-separated list has this word.
bool lists(const std::string& list, std::string_view word) {
    std::istringstream words(list);
    std::string one;
    while (std::getline(words, one, ',')) {
        const size_t begin = one.find_first_not_of(" \t");
        const size_t end = one.find_last_not_of(" \t");
        if (begin != std::string::npos && one.substr(begin, end + 1 - begin) == word) return true;
    }
    return false;
}

/// What a server shows that it speaks WebSocket by (RFC 6455, 4.2.2).
std::string accept_of(const std::string& key) {
    const std::string text = key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";
    std::array<unsigned char, EVP_MAX_MD_SIZE> hash{};
    unsigned length = 0;
    EVP_Digest(text.data(), text.size(), hash.data(), &length, EVP_sha1(), nullptr);
    std::array<unsigned char, 4 * EVP_MAX_MD_SIZE / 3 + 4> base64{};
    const int count = EVP_EncodeBlock(base64.data(), hash.data(), static_cast<int>(length));
    return {base64.begin(), base64.begin() + count};
}

std::string answer_to(const std::string& key, const WebAnswer& answer) {
    if (!answer.status.empty())
        return fmt::format("HTTP/1.1 {}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n", answer.status);
    std::string text = "HTTP/1.1 101 Switching Protocols\r\n";
    for (const std::string& line :
         {std::string("Upgrade: websocket"), std::string("Connection: Upgrade"),
          "Sec-WebSocket-Accept: " + accept_of(key), std::string("Sec-WebSocket-Protocol: trochoid")})
        if (answer.except.empty() || !line.starts_with(answer.except)) text += line + "\r\n";
    return text + (answer.more.empty() ? "\r\n" : answer.more + "\r\n\r\n");
}

class OverBytes final : public WebStream {
public:
    OverBytes(std::unique_ptr<Stream> inner, WebRole ours) : inner_(std::move(inner)), ours_(ours) {}

    void connect(const std::string& host, const Deadline& deadline) {
        inner_->write(bytes_of(web_upgrade(host)));
        const auto head = read_head(deadline);
        if (!head) throw Failed{"R-105: no answer to an upgrade came"};
        if (status_of(*head) != 101)
            throw Failed{
                fmt::format("R-105: an upgrade is answered '{}'", head->substr(0, head->find('\r')))};
    }
    void accept(const WebAnswer& answer, const Deadline& deadline) {
        const auto head = read_head(deadline);
        if (!head && unread_.empty()) throw Failed{"R-105: no upgrade came"};
        const std::string key = judge_upgrade(head ? *head : std::string(unread_.begin(), unread_.end()));
        if (!head) throw Failed{"R-105: the client's upgrade does not come to its end"};
        inner_->write(bytes_of(answer_to(key, answer)));
        if (!answer.status.empty()) inner_->finish();
    }

    bool keeps_messages() const override { return true; }
    bool write_message(std::span<const uint8_t> payload) override {
        return state_ == State::open && inner_->write(framed(web_last | web_binary, payload));
    }
    std::optional<Bytes> read_message(Milliseconds within) override {
        const Deadline deadline(within);
        while (state_ == State::open) {
            if (auto frame = take_web_frame(unread_, theirs())) {
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
    bool write_below(std::span<const uint8_t> bytes) override { return inner_->write(bytes); }
    State state() const override { return state_; }
    uint16_t close_code() const override { return close_code_; }
    const std::vector<Bytes>& pongs() const override { return pongs_; }
    std::string wrong_end() const override {
        if (!inner_->wrong_end().empty()) return inner_->wrong_end();
        if (state_ == State::reset && inner_->state() == State::ended)
            return "R-105: the stream just stops, without a close frame";
        if (state_ == State::open && close_sent_ && close_code_ == 0)
            return "R-105: our close frame is not answered";
        return close_code_ == 0 || may_close_by(close_code_)
                   ? ""
                   : fmt::format("R-105: the close frame has code {}", close_code_);
    }
    void finish() override { send_close(std::array<uint8_t, 2>{3, 0xe8}); }
    void abort() override {
        inner_->abort();
        state_ = State::reset;
    }

private:
    WebRole theirs() const { return ours_ == WebRole::client ? WebRole::server : WebRole::client; }
    Bytes framed(uint8_t first, std::span<const uint8_t> payload) const {
        return web_frame(first, payload, ours_ == WebRole::client);
    }
    void send_close(std::span<const uint8_t> payload) {
        if (!std::exchange(close_sent_, true)) inner_->write(framed(web_last | web_close, payload));
    }
    /// Beside those of R-105 an answer to our close frame may be as empty as RFC 6455 lets it be.
    bool may_close_by(uint16_t code) const {
        constexpr std::array<uint16_t, 5> plain{1000, 1001, 1003, 1009, 1011};
        constexpr uint16_t none = 1005;
        return std::find(plain.begin(), plain.end(), code) != plain.end() || (code > 4000 && code < 5000) ||
               (code == none && close_sent_first_);
    }

    bool read_more(Milliseconds within) {
        std::array<uint8_t, 16'384> chunk;
        const size_t count = inner_->read(chunk, within);
        unread_.insert(unread_.end(), chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(count));
        return count > 0;
    }
    std::optional<std::string> read_head(const Deadline& deadline) {
        constexpr size_t longest = 16'384;
        auto head = take_head(unread_);
        while (!head && unread_.size() < longest && read_more(deadline.left())) head = take_head(unread_);
        return head;
    }

    /// The close frame has come: ours goes back, and whoever serves ends the stream below.
    void take_close(const WebMessage& frame, const Deadline& deadline) {
        close_code_ = close_code_of(frame);
        close_sent_first_ = close_sent_;
        send_close(frame.payload);
        if (ours_ == WebRole::server) inner_->finish();
        while (read_more(deadline.left())) unread_.clear();
        if (inner_->state() != State::open) state_ = State::ended;
    }

    /// True where `message_` is whole.
    bool take(WebMessage frame, const Deadline& deadline) {
        switch (frame.opcode) {
            case web_ping: inner_->write(framed(web_last | web_pong, frame.payload)); return false;
            case web_pong: pongs_.push_back(std::move(frame.payload)); return false;
            case web_close: take_close(frame, deadline); return false;
            case web_binary:
            case web_continuation:
                if ((frame.opcode == web_continuation) != within_message_)
                    throw Failed{
                        fmt::format("R-105: a message of the {}'s is in pieces that do not follow each other",
                                    name_of(theirs()))};
                within_message_ = !frame.last;
                message_.insert(message_.end(), frame.payload.begin(), frame.payload.end());
                return frame.last;
            default:
                throw Failed{
                    fmt::format("R-105: a frame of opcode {} came where a binary one was due", frame.opcode)};
        }
    }

    std::unique_ptr<Stream> inner_;
    const WebRole ours_;
    Bytes unread_;
    Bytes message_;
    bool within_message_ = false;
    bool close_sent_ = false;
    bool close_sent_first_ = false;
    uint16_t close_code_ = 0;
    std::vector<Bytes> pongs_;
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

std::optional<WebMessage> take_web_frame(Bytes& unread, WebRole theirs) {
    if (unread.size() < 2) return std::nullopt;
    const bool masked = (unread[1] & 0x80) != 0;
    if (masked && theirs == WebRole::server) throw Failed{"R-105: the server masks its frames"};
    if (!masked && theirs == WebRole::client) throw Failed{"R-105: the client does not mask its frames"};
    if ((unread[0] & 0x70) != 0)
        throw Failed{fmt::format("R-105: a frame of the {}'s has reserved bits: nothing was agreed on",
                                 name_of(theirs))};
    uint64_t size = unread[1] & 0x7f;
    const size_t bytes = size == 127 ? 8 : (size == 126 ? 2 : 0);
    if (unread.size() < 2 + bytes) return std::nullopt;
    if (bytes > 0) size = 0;
    for (size_t i = 0; i < bytes; ++i) size = size << 8 | unread[2 + i];
    constexpr uint64_t most = uint64_t{1} << 24;  // that any server's limits may allow
    if (size > most) throw Failed{fmt::format("R-103: a message of {} bytes comes", size)};
    constexpr size_t mask_bytes = 4;
    const size_t begin = 2 + bytes + (masked ? mask_bytes : 0);
    if (unread.size() < begin + size) return std::nullopt;
    const auto at = unread.begin() + static_cast<std::ptrdiff_t>(begin);
    WebMessage message{static_cast<uint8_t>(unread[0] & 0x0f),
                       Bytes(at, at + static_cast<std::ptrdiff_t>(size)), (unread[0] & web_last) != 0};
    if (masked)
        for (size_t i = 0; i < message.payload.size(); ++i)
            message.payload[i] ^= unread[begin - mask_bytes + i % mask_bytes];
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

std::unique_ptr<WebStream> begin_web(std::unique_ptr<Stream> inner, const std::string& host,
                                     Milliseconds within) {
    auto stream = std::make_unique<OverBytes>(std::move(inner), WebRole::client);
    stream->connect(host, Deadline(within));
    return stream;
}

std::unique_ptr<WebStream> accept_web(std::unique_ptr<Stream> inner, const WebAnswer& answer,
                                      Milliseconds within) {
    auto stream = std::make_unique<OverBytes>(std::move(inner), WebRole::server);
    stream->accept(answer, Deadline(within));
    return stream;
}

std::string judge_upgrade(const std::string& head) {
    if (head.front() < 'A' || head.front() > 'Z')
        throw Failed{fmt::format("R-104: the stream begins with {:02x}, HTTP with a capital letter",
                                 static_cast<unsigned char>(head.front()))};
    const std::string first = head.substr(0, head.find('\r'));
    if (first != "GET / HTTP/1.1") throw Failed{fmt::format("R-105: the client asks '{}'", first)};
    const auto fields = fields_of(head);
    const auto value = [&](const char* name) {
        const auto found = fields.find(name);
        return found == fields.end() ? std::string() : found->second;
    };
    const auto require = [](bool holds, const char* what) {
        if (!holds) throw Failed{fmt::format("R-105: the client's upgrade {}", what)};
    };
    constexpr size_t key_characters = 24;  // 16 bytes
    std::string key = value("sec-websocket-key");
    require(!value("host").empty(), "has no Host");
    require(lists(lower_of(value("upgrade")), "websocket"), "asks for no websocket");
    require(lists(lower_of(value("connection")), "upgrade"), "has no 'Connection: Upgrade'");
    require(value("sec-websocket-version") == "13", "is not of version 13");
    require(key.size() == key_characters && key.ends_with("=="), "has no key of 16 bytes");
    require(lists(value("sec-websocket-protocol"), "trochoid"), "does not offer the subprotocol trochoid");
    return key;
}

}  // namespace trochoid::conformance
