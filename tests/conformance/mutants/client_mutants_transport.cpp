#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

#include "tests/conformance/mutants/client_mutants.hpp"
#include "tests/conformance/tls_hello.hpp"
#include "tests/conformance/web_stream.hpp"

// below the messages. Each comes by the transport that client_mutants.py names.
namespace trochoid::conformance::mutants {

namespace {

/// A frame of a WebSocket as it came, whatever is wrong with it; the payload is not masked.
struct RawFrame {
    uint8_t first = 0;
    bool masked = false;
    Bytes payload;
    uint8_t opcode() const { return first & 0x0f; }
};

/// One direction of a WebSocket, cut into its head and frames.
class WebCutter {
public:
    void take(const Bytes& bytes) { held_.insert(held_.end(), bytes.begin(), bytes.end()); }
    /// The head, blank line and all, once it is whole.
    std::optional<std::string> head() {
        if (upgraded_) return std::nullopt;
        auto text = take_head(held_);
        upgraded_ = text.has_value();
        return text ? std::optional(*text + "\r\n\r\n") : std::nullopt;
    }
    std::optional<RawFrame> frame() {
        if (!upgraded_ || as_it_is_ || held_.size() < 2) return std::nullopt;
        const size_t announced = held_[1] & 0x7fU;
        const size_t words = announced == 127 ? 8 : (announced == 126 ? 2 : 0);
        if (held_.size() < 2 + words) return std::nullopt;
        uint64_t size = words == 0 ? announced : 0;
        for (size_t i = 0; i < words; ++i) size = size << 8 | held_[2 + i];
        constexpr uint64_t most = 1U << 20;
        if (size > most) return as_it_is_ = true, std::nullopt;
        RawFrame frame{held_[0], (held_[1] & 0x80) != 0, {}};
        const size_t begin = 2 + words + (frame.masked ? 4 : 0);
        if (held_.size() < begin + size) return std::nullopt;
        const auto at = held_.begin() + static_cast<std::ptrdiff_t>(begin);
        frame.payload.assign(at, at + static_cast<std::ptrdiff_t>(size));
        if (frame.masked)
            for (size_t i = 0; i < frame.payload.size(); ++i) frame.payload[i] ^= held_[begin - 4 + i % 4];
        held_.erase(held_.begin(), at + static_cast<std::ptrdiff_t>(size));
        return frame;
    }
    /// What is not cut: all that is left, where nothing more will come or a frame is too long to wait for.
    Bytes rest(bool ended) { return ended || as_it_is_ ? std::exchange(held_, {}) : Bytes(); }

private:
    Bytes held_;
    bool upgraded_ = false;
    bool as_it_is_ = false;
};

/// Spoils the upgrade and frames of a client, or what comes to it.
class WebSpoiler : public Spoiler {
public:
    void other_from_client(Bytes bytes, Link& link) final {
        client_.take(bytes);
        if (const auto head = client_.head()) {
            const std::string said = request(*head);
            link.bytes_to_server({reinterpret_cast<const uint8_t*>(said.data()), said.size()});
        }
        while (auto frame = client_.frame())
            if (client_sends(*frame))
                link.bytes_to_server(web_frame(frame->first, frame->payload, frame->masked));
        link.bytes_to_server(client_.rest(false));
    }
    void other_from_server(Bytes bytes, Link& link) final {
        server_.take(bytes);
        if (const auto head = server_.head())
            link.bytes_to_client({reinterpret_cast<const uint8_t*>(head->data()), head->size()});
        while (auto frame = server_.frame())
            if (server_sends(*frame))
                link.bytes_to_client(web_frame(frame->first, frame->payload, frame->masked));
        link.bytes_to_client(server_.rest(false));
    }
    void client_ended(Link& link) final {
        link.bytes_to_server(client_.rest(true));
        link.end_server();
    }
    void server_ended(Link& link) final {
        link.bytes_to_client(server_.rest(true));
        link.end_client();
    }

protected:
    /// The head of the upgrade as it shall go on.
    virtual std::string request(const std::string& head) = 0;
    /// A frame, to be changed in place; false: it does not go on.
    virtual bool client_sends(RawFrame& frame) = 0;
    virtual bool server_sends(RawFrame& frame) = 0;

private:
    WebCutter client_;
    WebCutter server_;
};

using ChangeFrame = bool (*)(RawFrame& frame);
using ChangeHead = std::string (*)(const std::string& head);

bool keep(RawFrame&) { return true; }

/// Spoils by functions of its own.
class WebSpoiledBy final : public WebSpoiler {
public:
    WebSpoiledBy(ChangeHead head, ChangeFrame client, ChangeFrame server)
        : head_(head), client_(client), server_(server) {}

private:
    std::string request(const std::string& head) override { return head_ == nullptr ? head : head_(head); }
    bool client_sends(RawFrame& frame) override { return client_(frame); }
    bool server_sends(RawFrame& frame) override { return server_(frame); }

    const ChangeHead head_;
    const ChangeFrame client_;
    const ChangeFrame server_;
};

MakeSpoiler spoils_request(ChangeHead change) {
    return [change] { return std::make_unique<WebSpoiledBy>(change, keep, keep); };
}
MakeSpoiler spoils_frames(ChangeFrame client, ChangeFrame server = keep) {
    return [client, server] { return std::make_unique<WebSpoiledBy>(nullptr, client, server); };
}

std::string without_line(const std::string& head, std::string_view name) {
    const size_t begin = head.find(name);
    if (begin == std::string::npos) return head;
    const size_t end = head.find("\r\n", begin) + 2;
    return head.substr(0, begin) + head.substr(end);
}
std::string in_small_letters(const std::string& head) {
    std::string said = head;
    for (size_t i = 0; i < said.find(' '); ++i)
        said[i] = static_cast<char>(std::tolower(static_cast<unsigned char>(said[i])));
    return said;
}
std::string for_no_subprotocol(const std::string& head) {
    return without_line(head, "Sec-WebSocket-Protocol");
}
std::string for_another_path(const std::string& head) {
    return "GET /sea" + head.substr(head.find(" HTTP/"));
}

/// What no client may take becomes what it may, or does not come.
bool made_harmless(RawFrame& frame) {
    frame.masked = false;
    frame.first &= 0x8f;
    const uint8_t opcode = frame.opcode();
    return opcode == web_binary || opcode == web_continuation || (opcode >= web_close && opcode <= web_pong);
}

/// Changes a client's records of TLS.
class TlsSpoiler : public Spoiler {
public:
    void other_from_client(Bytes bytes, Link& link) final {
        held_.insert(held_.end(), bytes.begin(), bytes.end());
        while (held_.size() >= tls_record_header_bytes) {
            const size_t size = tls_record_header_bytes + tls_record_bytes(held_);
            if (held_.size() < size) return;
            const auto end = held_.begin() + static_cast<std::ptrdiff_t>(size);
            record(Bytes(held_.begin(), end), link);
            held_.erase(held_.begin(), end);
        }
    }

protected:
    virtual void record(const Bytes& whole, Link& link) = 0;

private:
    Bytes held_;
};

class SplitHello final : public TlsSpoiler {
    void record(const Bytes& whole, Link& link) override {
        const std::span<const uint8_t> payload = std::span(whole).subspan(tls_record_header_bytes);
        if (whole[0] != tls_handshake_record || split_) return link.bytes_to_server(whole);
        split_ = true;
        say(payload.first(payload.size() / 2), link);
        say(payload.subspan(payload.size() / 2), link);
    }
    static void say(std::span<const uint8_t> payload, Link& link) {
        Bytes record{tls_handshake_record, 3, 1, static_cast<uint8_t>(payload.size() >> 8),
                     static_cast<uint8_t>(payload.size())};
        record.insert(record.end(), payload.begin(), payload.end());
        link.bytes_to_server(record);
    }
    bool split_ = false;
};

class NoCloseNotify final : public TlsSpoiler {
    void record(const Bytes& whole, Link& link) override {
        // An alert: two bytes, their kind, and 16 that seal them. Nothing else of a client's is as short.
        constexpr size_t alert_bytes = 2 + 1 + 16;
        if (whole.size() != tls_record_header_bytes + alert_bytes) link.bytes_to_server(whole);
    }
};

}  // namespace

void add_clients_below_messages(std::vector<Mutant>& all) {
    const auto add = [&](const char* name, uint16_t number, const char* what, MakeSpoiler make) {
        all.push_back({name, number, Side::client, what, std::move(make)});
    };
    constexpr uint16_t one_port = 104;
    constexpr uint16_t websocket = 105;
    constexpr uint16_t encryption = 106;
    add("client-small-letters", one_port, "A client that asks for its upgrade in small letters",
        spoils_request(in_small_letters));
    add("client-no-subprotocol", websocket, "A client that asks for a WebSocket without the subprotocol",
        spoils_request(for_no_subprotocol));
    add("client-other-path", websocket, "A client that asks for a WebSocket elsewhere",
        spoils_request(for_another_path));
    add("client-no-mask", websocket, "A client that does not mask its frames",
        spoils_frames([](RawFrame& frame) {
            frame.masked = false;
            return true;
        }));
    add("client-text", websocket, "A client whose messages are text", spoils_frames([](RawFrame& frame) {
            if (frame.opcode() == web_binary) frame.first = web_last | web_text;
            return true;
        }));
    add("client-no-close-frame", websocket, "A client that never closes its WebSocket",
        spoils_frames([](RawFrame& frame) { return frame.opcode() != web_close; }));
    add("client-no-pong", websocket, "A client that answers no ping",
        spoils_frames([](RawFrame& frame) { return frame.opcode() != web_pong; }));
    add("client-forgives-105", websocket, "A client that takes frames that break RFC 6455, and text",
        spoils_frames(keep, made_harmless));
    add("client-split-hello", encryption, "A client whose ClientHello comes in two records",
        [] { return std::make_unique<SplitHello>(); });
    add("client-no-close-notify", encryption, "A client that ends TLS without close_notify",
        [] { return std::make_unique<NoCloseNotify>(); });
}

}  // namespace trochoid::conformance::mutants
