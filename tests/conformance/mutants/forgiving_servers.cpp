#include <algorithm>
#include <map>
#include <memory>
#include <mutex>

#include "protocol/login/login_token.hpp"
#include "protocol/units/version.hpp"
#include "protocol/wire/requirements.hpp"
#include "tests/conformance/mutants/server_mutants.hpp"

// Servers that do not check one rule that clients keep.
namespace trochoid::conformance::mutants {

namespace {

class NoGoodbye final : public MessageSpoiler {
public:
    explicit NoGoodbye(std::function<bool(const Goodbye&, const Talk&)> fits) : fits_(std::move(fits)) {}
    void server_ended(Link& link) override {
        if (!swallowed_) link.end_client();
    }
    void server_reset(Link& link) override {
        if (!swallowed_) link.reset_client();
    }

protected:
    Fate server_says(ServerMessage& message, Link&) override {
        const auto* goodbye = std::get_if<Goodbye>(&message);
        if (goodbye == nullptr || !fits_(*goodbye, talk())) return Fate::kept;
        swallowed_ = true;
        return Fate::dropped;
    }

private:
    std::function<bool(const Goodbye&, const Talk&)> fits_;
    bool swallowed_ = false;
};

/// Passes payloads by that a server refuses for this requirement.
class DeafTo final : public MessageSpoiler {
public:
    explicit DeafTo(uint16_t requirement) : requirement_(requirement) {}

protected:
    Fate unread_from_client(const Error& error, std::span<const uint8_t> payload) override {
        return goodbye_for_payload(error, payload, client_identifier).requirement == requirement_
                   ? Fate::dropped
                   : Fate::kept;
    }

private:
    uint16_t requirement_;
};

MakeSpoiler deaf_to(uint16_t requirement) {
    return [requirement] { return std::make_unique<DeafTo>(requirement); };
}

/// Another judgement of what is no frame.
class HeaderSpoiler final : public Spoiler {
public:
    using Judge = HeaderFate (*)(uint32_t length, uint32_t word);
    explicit HeaderSpoiler(Judge judge) : judge_(judge) {}
    HeaderFate bad_header(uint32_t length, uint32_t word) override { return judge_(length, word); }

private:
    Judge judge_;
};

MakeSpoiler headers(HeaderSpoiler::Judge judge) {
    return [judge] { return std::make_unique<HeaderSpoiler>(judge); };
}

/// Another judgement of a raw stream's first 8 bytes.
class OpeningSpoiler final : public Spoiler {
public:
    using Change = void (*)(std::span<const uint8_t> bytes, Link& link);
    explicit OpeningSpoiler(Change change) : change_(change) {}
    void opening(std::span<const uint8_t> bytes, Link& link) override { change_(bytes, link); }

private:
    Change change_;
};

bool is_magic(std::span<const uint8_t> bytes) {
    return std::equal(stream_magic.begin(), stream_magic.end(), bytes.begin());
}

void add_stream(std::vector<Mutant>& all) {
    all.push_back(
        server_mutant(101, "magic-by-three-bytes", "compares the first three bytes of the magic only", [] {
            return std::make_unique<OpeningSpoiler>([](std::span<const uint8_t> bytes, Link& link) {
                const bool begins = std::equal(bytes.begin(), bytes.begin() + 3, stream_magic.begin());
                link.bytes_to_server(begins ? std::span<const uint8_t>(stream_magic) : bytes);
            });
        }));
    all.push_back(server_mutant(101, "magic-left-out", "takes a frame where the magic is due", [] {
        return std::make_unique<OpeningSpoiler>([](std::span<const uint8_t> bytes, Link& link) {
            const bool header = !is_magic(bytes) && bytes[0] != 0 && bytes[2] == 0 && bytes[3] == 0 &&
                                std::all_of(bytes.begin() + 4, bytes.end(), [](uint8_t b) { return b == 0; });
            if (header) link.bytes_to_server(stream_magic);
            link.bytes_to_server(bytes);
        });
    }));
    constexpr uint32_t any_frame = 65536;
    all.push_back(server_mutant(102, "header-word", "does not look at the word behind a frame's length",
                                headers([](uint32_t length, uint32_t word) {
                                    return word != 0 && length > 0 && length <= any_frame
                                               ? HeaderFate::mend
                                               : HeaderFate::pass_on;
                                })));
    all.push_back(server_mutant(102, "empty-frames", "passes frames without a payload by",
                                headers([](uint32_t length, uint32_t word) {
                                    return length == 0 && word == 0 ? HeaderFate::swallow
                                                                    : HeaderFate::pass_on;
                                })));
    all.push_back(server_mutant(
        103, "long-frames", "reads frames of any length", headers([](uint32_t length, uint32_t word) {
            return length > 0 && word == 0 ? HeaderFate::swallow : HeaderFate::pass_on;
        })));
}

void add_buffers(std::vector<Mutant>& all) {
    const std::pair<uint16_t, const char*> rules[] = {
        {111, "file-identifier"}, {112, "verifier"},     {113, "size-field"}, {114, "union-tags"},
        {115, "missing-fields"},  {116, "finite"},       {117, "ranges"},     {118, "unit-quaternions"},
        {131, "many-regions"},    {132, "large-regions"}};
    for (const auto& [requirement, name] : rules)
        all.push_back(server_mutant(requirement, name, "passes messages by that break this, and goes on",
                                    deaf_to(requirement)));
}

void add_session(std::vector<Mutant>& all) {
    class AnyOrder final : public MessageSpoiler {
        Fate client_says(ClientMessage& message, Link&) override {
            return expected(talk().from_client, message) ? Fate::kept : Fate::dropped;
        }
    };
    all.push_back(server_mutant(121, "any-order", "passes messages by that may not come now",
                                [] { return std::make_unique<AnyOrder>(); }));
    all.push_back(server_mutant(122, "patient", "waits for a hello for ever",
                                no_goodbye([](const Goodbye& goodbye, const Talk&) {
                                    return goodbye.code == ErrorCode::hello_deadline;
                                })));
    all.push_back(server_mutant(123, "any-version", "serves clients of any version",
                                each_of_client<ClientHello>([](ClientHello& hello, const Talk&, Link&) {
                                    const auto version = common_version(hello);
                                    if (version || version.error().code != ErrorCode::protocol_version)
                                        return Fate::kept;
                                    hello.protocol_min = protocol_version_min;
                                    hello.protocol_max = protocol_version_max;
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(123, "lowest-version",
                                "takes the lowest version of a client that speaks later ones, too",
                                each_of_client<ClientHello>([](ClientHello& hello, const Talk&, Link&) {
                                    if (hello.protocol_max <= protocol_version_max) return Fate::kept;
                                    hello.protocol_max = std::max(hello.protocol_min, protocol_version_min);
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(124, "any-world", "serves clients that name another world",
                                each_of_client<ClientHello>([](ClientHello& hello, const Talk&, Link&) {
                                    if (hello.world.empty()) return Fate::kept;
                                    hello.world.clear();
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(141, "any-model", "serves clients that compute another sea",
                                each_of_client<ClientHello>([](ClientHello& hello, const Talk&, Link&) {
                                    if (hello.model == model_version) return Fate::kept;
                                    hello.model = model_version;
                                    return Fate::changed;
                                })));
    class AnySequence final : public MessageSpoiler {
        Fate client_says(ClientMessage& message, Link&) override {
            return rule_.accept(message) ? Fate::kept : Fate::dropped;
        }
        SequenceRule rule_;
    };
    all.push_back(server_mutant(125, "any-sequence", "passes messages by whose number does not ascend",
                                [] { return std::make_unique<AnySequence>(); }));
    all.push_back(server_mutant(126, "any-rate", "lets views, regions and messages come at any rate",
                                no_goodbye([](const Goodbye& goodbye, const Talk&) {
                                    return goodbye.requirement == requirement::message_rates;
                                })));
    all.push_back(server_mutant(
        126, "any-commands", "lets commands come at any rate",
        each_of_server<CommandReply>([](CommandReply& reply, const Talk& talk, Link&) {
            if (reply.code != ErrorCode::rate_limited || talk.server_hello->role != Role::viewer ||
                !talk.is_reply_to<Command>(reply.sequence))
                return Fate::kept;
            reply.code = ErrorCode::token_required;
            return Fate::changed;
        })));
    all.push_back(server_mutant(
        127, "any-role", "carries viewers' commands out",
        each_of_server<CommandReply>([](CommandReply& reply, const Talk& talk, Link&) {
            if (reply.code != ErrorCode::token_required || talk.server_hello->role != Role::viewer)
                return Fate::kept;
            reply.code = ErrorCode::none;
            reply.message.clear();
            return Fate::changed;
        })));
    all.push_back(server_mutant(128, "no-patience-ends", "keeps sessions that are silent",
                                no_goodbye([](const Goodbye& goodbye, const Talk&) {
                                    return goodbye.code == ErrorCode::no_progress;
                                })));
}

void add_results(std::vector<Mutant>& all) {
    all.push_back(server_mutant(133, "any-hash", "does not compare the hash of an acknowledgement",
                                each_of_client<Ack>([](Ack& ack, const Talk& talk, Link&) {
                                    if (ack.result != talk.last_result) return Fate::kept;
                                    ack.state_hash = talk.last_hash;
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(133, "snapshots-for-ever",
                                "never gives a client up that does not come into step",
                                no_goodbye([](const Goodbye& goodbye, const Talk&) {
                                    return goodbye.code == ErrorCode::base_mismatch;
                                })));
    all.push_back(server_mutant(
        135, "any-result", "passes acknowledgements of results by that it has not written",
        each_of_client<Ack>([](Ack& ack, const Talk& talk, Link&) {
            return talk.client_hello && ack.result > talk.last_result ? Fate::dropped : Fate::kept;
        })));
}

/// Tokens that any connection of this program has seen at a login that went well.
class Spent {
public:
    void add(const std::string& token, const ServerHello& hello) {
        const std::lock_guard lock(mutex_);
        seen_.insert_or_assign(token, hello);
    }
    /// The hello of that login.
    std::optional<ServerHello> find(const std::string& token) {
        const std::lock_guard lock(mutex_);
        const auto found = seen_.find(token);
        return found == seen_.end() ? std::nullopt : std::optional(found->second);
    }

private:
    std::mutex mutex_;
    std::map<std::string, ServerHello> seen_;
};

enum class TokenFault : uint8_t { form, spent, other };

/// Lets a client with a bad token wait, as if it were still looked at: what matters is that it is not refused.
class AnyToken final : public MessageSpoiler {
public:
    AnyToken(TokenFault forgiven, std::shared_ptr<Spent> spent)
        : forgiven_(forgiven), spent_(std::move(spent)) {}
    void server_ended(Link& link) override {
        if (!swallowed_) link.end_client();
    }

private:
    Fate server_says(ServerMessage& message, Link& link) override {
        if (!talk().client_hello || talk().client_hello->token.empty()) return Fate::kept;
        const std::string& token = talk().client_hello->token;
        if (const auto* hello = std::get_if<ServerHello>(&message)) spent_->add(token, *hello);
        const auto* goodbye = std::get_if<Goodbye>(&message);
        if (goodbye == nullptr || goodbye->code != ErrorCode::token_refused) return Fate::kept;
        std::optional<ServerHello> earlier = spent_->find(token);
        const TokenFault fault = !parse_token(token) ? TokenFault::form
                                 : earlier           ? TokenFault::spent
                                                     : TokenFault::other;
        if (fault != forgiven_) return Fate::kept;
        swallowed_ = true;
        if (earlier) {
            // The second login is seen to go well.
            earlier->client_stamp_us = talk().client_hello->clock_stamp_us;
            link.say_to_client(*earlier);
        }
        return Fate::dropped;
    }

    TokenFault forgiven_;
    std::shared_ptr<Spent> spent_;
    bool swallowed_ = false;
};

void add_logins(std::vector<Mutant>& all) {
    const auto tokens = [](TokenFault fault) -> MakeSpoiler {
        return
            [fault, spent = std::make_shared<Spent>()] { return std::make_unique<AnyToken>(fault, spent); };
    };
    all.push_back(server_mutant(152, "token-forms", "does not refuse tokens of another form",
                                tokens(TokenFault::form)));
    all.push_back(server_mutant(153, "token-values",
                                "does not refuse tokens for others, of other times, or badly signed",
                                tokens(TokenFault::other)));
    all.push_back(
        server_mutant(154, "token-twice", "takes a token more than once", tokens(TokenFault::spent)));
}

}  // namespace

MakeSpoiler no_goodbye(std::function<bool(const Goodbye&, const Talk&)> fits) {
    return [fits = std::move(fits)] { return std::make_unique<NoGoodbye>(fits); };
}

Fate leave_with(ErrorCode code, Link& link) {
    link.say_to_client(goodbye_for({code, "this server does not want that"}));
    link.end_client();
    link.end_server();
    return Fate::dropped;
}

void add_forgiving_servers(std::vector<Mutant>& all) {
    add_stream(all);
    add_buffers(all);
    add_session(all);
    add_results(all);
    add_logins(all);
}

}  // namespace trochoid::conformance::mutants
