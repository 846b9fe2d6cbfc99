#include <algorithm>
#include <atomic>
#include <memory>

#include "protocol/units/error_code.hpp"
#include "protocol/units/version.hpp"
#include "tests/conformance/golden_vectors.hpp"
#include "tests/conformance/mutants/server_mutants.hpp"

// Servers that do one thing otherwise than they have to.
namespace trochoid::conformance::mutants {

namespace {

// ---- one port ----

/// Answers a request of HTTP in the server's place where its first line begins so.
class HttpSpoiler final : public Spoiler {
public:
    HttpSpoiler(std::string begins, std::string answer)
        : begins_(std::move(begins)), answer_(std::move(answer)) {}
    void other_from_client(Bytes bytes, Link& link) override {
        if (head_.size() < begins_.size()) head_.append(bytes.begin(), bytes.end());
        mine_ = mine_ || head_.starts_with(begins_);
        link.bytes_to_server(bytes);
    }
    void other_from_server(Bytes bytes, Link& link) override {
        if (!mine_) return link.bytes_to_client(bytes);
        if (!answered_) link.bytes_to_client(Bytes(answer_.begin(), answer_.end()));
        answered_ = true;
    }

private:
    const std::string begins_;
    const std::string answer_;
    std::string head_;
    bool mine_ = false;
    bool answered_ = false;
};

/// Changes what a client says over HTTP or a WebSocket, chunk by chunk: the kit writes a head, and a frame, at once.
class WebSpoiler final : public Spoiler {
public:
    using Change = void (*)(Bytes& chunk);
    explicit WebSpoiler(Change change) : change_(change) {}
    void other_from_client(Bytes bytes, Link& link) override {
        change_(bytes);
        link.bytes_to_server(bytes);
    }

private:
    Change change_;
};

void without_origin(Bytes& chunk) {
    std::string text(chunk.begin(), chunk.end());
    const size_t at = text.find("\r\nOrigin:");
    if (at == std::string::npos) return;
    text.erase(at, text.find("\r\n", at + 2) - at);
    chunk.assign(text.begin(), text.end());
}

void text_as_binary(Bytes& chunk) {
    constexpr uint8_t whole_text = 0x81;
    constexpr uint8_t whole_binary = 0x82;
    if (!chunk.empty() && chunk[0] == whole_text) chunk[0] = whole_binary;
}

/// Lets a raw stream be that begins like no magic.
class Unmoved final : public Spoiler {
public:
    void opening(std::span<const uint8_t> bytes, Link& link) override {
        waits_ = !std::equal(bytes.begin(), bytes.begin() + 2, stream_magic.begin()) &&
                 std::all_of(bytes.begin(), bytes.end(), [&](uint8_t b) { return b == bytes[0]; });
        if (!waits_) link.bytes_to_server(bytes);
    }
    void server_ended(Link& link) override {
        if (!waits_) link.end_client();
    }
    void from_server(Bytes payload, Link& link) override {
        if (!waits_) link.to_client(payload);
    }

private:
    bool waits_ = false;
};

void add_port(std::vector<Mutant>& all) {
    all.push_back(server_mutant(104, "no-livez", "knows nothing of /livez", [] {
        return std::make_unique<HttpSpoiler>(
            "GET /livez", "HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\nConnection: close\r\n\r\n");
    }));
    all.push_back(server_mutant(104, "other-streams", "lets streams be that begin like none of its kinds",
                                [] { return std::make_unique<Unmoved>(); }));
    all.push_back(server_mutant(105, "any-origin", "lets pages of any site upgrade",
                                [] { return std::make_unique<WebSpoiler>(without_origin); }));
    all.push_back(server_mutant(105, "text-messages", "takes a WebSocket's text messages like binary ones",
                                [] { return std::make_unique<WebSpoiler>(text_as_binary); }));
    all.push_back(server_mutant(106, "no-handshake", "keeps connections open that TLS has given up", [] {
        class OnlyTls final : public Spoiler {
        public:
            void other_from_client(Bytes bytes, Link& link) override {
                constexpr uint8_t handshake = 0x16;
                tls_ = tls_ || bytes[0] == handshake;
                link.bytes_to_server(bytes);
            }
            void server_ended(Link& link) override {
                if (!tls_) link.end_client();
            }
            void server_reset(Link& link) override {
                if (!tls_) link.reset_client();
            }

        private:
            bool tls_ = false;
        };
        return std::make_unique<OnlyTls>();
    }));
}

// ---- reading ----

class Refuses final : public Spoiler {
public:
    using Judge = bool (*)(std::span<const uint8_t> payload);
    Refuses(Judge judge, ErrorCode code) : judge_(judge), code_(code) {}
    void from_client(Bytes payload, Link& link) override {
        if (gone_) return;
        gone_ = judge_(payload);
        if (gone_)
            leave_with(code_, link);
        else
            link.to_server(payload);
    }
    void from_server(Bytes payload, Link& link) override {
        if (!gone_) link.to_client(payload);
    }

private:
    Judge judge_;
    ErrorCode code_;
    bool gone_ = false;
};

bool is_golden(std::span<const uint8_t> payload) {
    const auto& golden = golden_messages();
    return std::any_of(golden.begin(), golden.end(), [&](const GoldenMessage& message) {
        return std::equal(payload.begin(), payload.end(), message.bytes.begin(), message.bytes.end());
    });
}

/// A clock request in more bytes than ours: with fields that no version has.
bool has_more_fields(std::span<const uint8_t> payload) {
    const auto message = decode_client(payload);
    return message && std::holds_alternative<ClockRequest>(*message) &&
           encode(*message).size() < payload.size();
}

void add_reading(std::vector<Mutant>& all) {
    all.push_back(server_mutant(119, "golden-unread", "cannot read the golden messages", [] {
        return std::make_unique<Refuses>(is_golden, ErrorCode::verification_failed);
    }));
    all.push_back(server_mutant(174, "no-new-fields", "refuses fields that it does not know", [] {
        return std::make_unique<Refuses>(has_more_fields, ErrorCode::verification_failed);
    }));
    all.push_back(server_mutant(175, "no-new-codes", "passes goodbyes by whose code it does not know",
                                each_of_client<Goodbye>([](Goodbye& goodbye, const Talk&, Link&) {
                                    constexpr uint16_t known[] = {0, 103, 501};
                                    const bool is_known =
                                        std::find(std::begin(known), std::end(known),
                                                  static_cast<uint16_t>(goodbye.code)) != std::end(known);
                                    return is_known ? Fate::kept : Fate::dropped;
                                })));
    all.push_back(server_mutant(175, "new-messages-to-all",
                                "sends messages of version 3 to clients of version 2",
                                each_of_server<BoxList>([](BoxList&, const Talk& talk, Link& link) {
                                    if (talk.server_hello && talk.server_hello->protocol == 2) {
                                        ProbeReply later;
                                        later.sequence = later.result = 1;
                                        later.stale = true;
                                        link.say_to_client(later);
                                    }
                                    return Fate::kept;
                                })));
}

// ---- clock and commands ----

void add_clock(std::vector<Mutant>& all) {
    all.push_back(server_mutant(141, "other-model", "tells another version of the model in its hello",
                                each_of_server<ServerHello>([](ServerHello& hello, const Talk&, Link&) {
                                    ++hello.model;
                                    return Fate::changed;
                                })));
    static constexpr int64_t most = int64_t{1} << 55;
    all.push_back(server_mutant(142, "clamped-stamps", "echoes stamps within half their bounds only",
                                each_of_server<ClockReply>([](ClockReply& reply, const Talk&, Link&) {
                                    const int64_t held = std::clamp(reply.client_sent_us, -most, most);
                                    if (held == reply.client_sent_us) return Fate::kept;
                                    reply.client_sent_us = held;
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(142, "late-hello", "tells in its hello the time of a second before",
                                each_of_server<ServerHello>([](ServerHello& hello, const Talk&, Link&) {
                                    hello.server_now_us -= 1'000'000;
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(
        142, "no-stamp-no-answer", "takes the stamp 0 for none, and does not answer",
        each_of_client<ClockRequest>([](ClockRequest& request, const Talk& talk, Link&) {
            return talk.client_hello && request.client_sent_us == 0 ? Fate::dropped : Fate::kept;
        })));
    all.push_back(server_mutant(143, "late-anyway", "defers commands that say that they must not be late",
                                each_of_client<Command>([](Command& command, const Talk&, Link&) {
                                    if (!command.refuse_if_late) return Fate::kept;
                                    command.refuse_if_late = false;
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(143, "at-once", "carries commands for later out as soon as it can",
                                each_of_client<Command>([](Command& command, const Talk&, Link&) {
                                    if (command.at <= SeaTime{}) return Fate::kept;
                                    command.at = {};
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(
        144, "watermark-stands", "tells a session one watermark all the time", spoils_server<ClockReply>([] {
            return [first = std::optional<SeaTime>()](ClockReply& reply, const Talk&, Link&) mutable {
                if (!first) first = reply.watermark;
                reply.watermark = *first;
                return Fate::changed;
            };
        })));
    all.push_back(server_mutant(144, "watermark-falls", "lets the watermarks of results fall",
                                each_of_server<Delta>([](Delta& piece, const Talk&, Link&) {
                                    constexpr int64_t step_us = 10'000'000;
                                    piece.watermark.us -= step_us * int64_t{piece.result};
                                    return Fate::changed;
                                })));
}

/// Tells each session another instance, and knows those again that come back with one.
Fate other_instance(WorldInstance& instance, bool forth) {
    static std::atomic<uint32_t> count{0};
    constexpr uint8_t mark = 0x5a;
    static std::atomic<uint64_t> real{0};  // the last 8 bytes of the world's own
    uint64_t tail = 0;
    for (size_t i = 8; i < 16; ++i) tail |= uint64_t{instance.bytes[i]} << (8 * (i - 8));
    if (forth) real = tail;
    if (!forth && instance.bytes[15] != mark) return Fate::kept;
    const uint64_t next = forth ? uint64_t{++count} | uint64_t{mark} << 56 : real.load();
    for (size_t i = 8; i < 16; ++i) instance.bytes[i] = static_cast<uint8_t>(next >> (8 * (i - 8)));
    return Fate::changed;
}

void add_sessions(std::vector<Mutant>& all) {
    all.push_back(
        server_mutant(129, "many-instances", "tells each session another instance of the world", [] {
            class Many final : public MessageSpoiler {
                Fate server_says(ServerMessage& message, Link&) override {
                    auto* hello = std::get_if<ServerHello>(&message);
                    return hello == nullptr ? Fate::kept : other_instance(hello->instance, true);
                }
                Fate client_says(ClientMessage& message, Link&) override {
                    auto* hello = std::get_if<ClientHello>(&message);
                    return hello == nullptr || !hello->resume
                               ? Fate::kept
                               : other_instance(hello->resume->instance, false);
                }
            };
            return std::make_unique<Many>();
        }));
    all.push_back(server_mutant(
        151, "role-ends", "ends a director's session where a command is for admins",
        each_of_server<CommandReply>([](CommandReply& reply, const Talk& talk, Link& link) {
            return reply.code == ErrorCode::token_required && talk.server_hello->role == Role::director
                       ? leave_with(reply.code, link)
                       : Fate::kept;
        })));
    all.push_back(server_mutant(
        151, "directors-move-time", "carries out what only admins may ask for",
        each_of_server<CommandReply>([](CommandReply& reply, const Talk& talk, Link&) {
            if (reply.code != ErrorCode::token_required || talk.server_hello->role != Role::director)
                return Fate::kept;
            reply.code = ErrorCode::none;
            reply.message.clear();
            return Fate::changed;
        })));
    all.push_back(server_mutant(155, "tickets-forgotten", "does not know its own tickets again",
                                each_of_client<ClientHello>([](ClientHello& hello, const Talk&, Link&) {
                                    if (hello.ticket.empty()) return Fate::kept;
                                    hello.ticket.clear();
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(
        158, "resumed-in-silence", "says that it goes on with what is held, and sends no result",
        each_of_server<Delta>([](Delta& piece, const Talk& talk, Link&) {
            return talk.server_hello->resumed && piece.result == 2 ? Fate::dropped : Fate::kept;
        })));
    all.push_back(server_mutant(
        159, "claims-refused", "refuses clients that hold what it cannot go on with",
        each_of_server<ServerHello>([](ServerHello& hello, const Talk& talk, Link& link) {
            const bool claimed = talk.client_hello && talk.client_hello->resume;
            return claimed && !hello.resumed ? leave_with(ErrorCode::base_mismatch, link) : Fate::kept;
        })));
}

// ---- results, probes, terrain ----

/// Acknowledges in the client's place. What the client acknowledges in order counts as that of the last result.
class NoWindow final : public MessageSpoiler {
    Fate server_says(ServerMessage& message, Link& link) override {
        const auto* piece = std::get_if<Delta>(&message);
        if (piece != nullptr && piece->last) {
            done_ = {piece->result, piece->state_hash, 0, {}};
            link.say_to_server(done_);
        }
        return Fate::kept;
    }
    Fate client_says(ClientMessage& message, Link&) override {
        auto* ack = std::get_if<Ack>(&message);
        if (ack == nullptr || ack->result < last_said_) return Fate::kept;
        last_said_ = ack->result;
        if (ack->result >= done_.result) return Fate::kept;
        ack->result = done_.result;
        ack->state_hash = done_.state_hash;
        return Fate::changed;
    }
    Ack done_;
    uint32_t last_said_ = 0;
};

void add_results(std::vector<Mutant>& all) {
    all.push_back(server_mutant(133, "no-window", "goes on with results that nobody has acknowledged",
                                [] { return std::make_unique<NoWindow>(); }));
    all.push_back(server_mutant(133, "other-state", "tells another hash than that of the state it has sent",
                                each_of_server<Delta>([](Delta& piece, const Talk&, Link&) {
                                    if (!piece.last || piece.change.empty()) return Fate::kept;
                                    piece.state_hash ^= 1;
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(134, "pieces-miscounted",
                                "leaves a number out between the pieces of a result",
                                each_of_server<Delta>([](Delta& piece, const Talk&, Link&) {
                                    if (piece.piece == 0) return Fate::kept;
                                    ++piece.piece;
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(134, "other-base", "builds results with changes on the one before the last",
                                each_of_server<Delta>([](Delta& piece, const Talk&, Link&) {
                                    if (piece.base < 2 || piece.change.empty()) return Fate::kept;
                                    --piece.base;
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(136, "tiles-aside", "puts terrain tiles a sample too far east",
                                each_of_server<TerrainTiles>([](TerrainTiles& tiles, const Talk&, Link&) {
                                    for (TerrainTile& tile : tiles.tiles)
                                        tile.origin_x += int64_t{1} << tile.spacing_log2;
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(136, "tile-borders",
                                "sends tiles whose eastern border is another than their neighbour's",
                                each_of_server<TerrainTiles>([](TerrainTiles& tiles, const Talk&, Link&) {
                                    for (TerrainTile& tile : tiles.tiles)
                                        for (size_t row = 0; row < terrain_tile_samples; ++row)
                                            tile.heights[(row + 1) * terrain_tile_samples - 1] ^= 1;
                                    return Fate::changed;
                                })));
}

void add_probes(std::vector<Mutant>& all) {
    all.push_back(server_mutant(161, "other-sums", "tells another sum after the last part of each point",
                                each_of_server<ProbeReply>([](ProbeReply& reply, const Talk&, Link&) {
                                    for (ProbedPoint& point : reply.points)
                                        if (!point.parts.empty()) point.parts.back().sum ^= 1;
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(162, "never-stale", "answers a probe of an earlier result from the last one",
                                each_of_client<Probe>([](Probe& probe, const Talk& talk, Link&) {
                                    if (probe.result >= talk.last_result) return Fate::kept;
                                    probe.result = talk.last_result;
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(163, "one-point-a-reply",
                                "lists the parts of the first point only, whatever there is room for",
                                each_of_server<ProbeReply>([](ProbeReply& reply, const Talk&, Link&) {
                                    if (reply.points.size() < 2) return Fate::kept;
                                    reply.points.resize(1);
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(
        164, "silent-about-rates", "does not answer probes beyond their rate",
        each_of_server<CommandReply>([](CommandReply& reply, const Talk& talk, Link&) {
            return reply.code == ErrorCode::rate_limited && talk.is_reply_to<Probe>(reply.sequence)
                       ? Fate::dropped
                       : Fate::kept;
        })));
    all.push_back(server_mutant(166, "differences-unheard", "passes reports of a difference by",
                                each_of_client<Desync>([](Desync&, const Talk& talk, Link&) {
                                    return talk.client_hello ? Fate::dropped : Fate::kept;
                                })));
}

}  // namespace

void add_lying_servers(std::vector<Mutant>& all) {
    add_port(all);
    add_reading(all);
    add_clock(all);
    add_sessions(all);
    add_results(all);
    add_probes(all);
}

}  // namespace trochoid::conformance::mutants
