#pragma once
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/wire/session_rules.hpp"
#include "tests/conformance/case.hpp"
#include "tests/conformance/mutants/relay.hpp"

namespace trochoid::conformance::mutants {

/// A program that keeps the standard but for one thing.
struct Mutant {
    std::string name;
    uint16_t requirement = 0;  ///< the one that it breaks
    Side side = Side::server;  ///< what it spoils: a server (the kit is its client), or a client
    std::string what;          ///< a sentence for people
    MakeSpoiler make;
};

/// In the order of the requirements, the honest relay (requirement 0, named "honest") first.
std::vector<Mutant> all_mutants();
// Each file adds its own.
void add_forgiving_servers(std::vector<Mutant>& all);
void add_lying_servers(std::vector<Mutant>& all);
void add_other_seas(std::vector<Mutant>& all);

/// What a connection has seen so far; a message counts once its spoiler has seen it, as it came.
struct Talk {
    SessionPhase from_client = SessionPhase::awaiting_hello;
    SessionPhase from_server = SessionPhase::awaiting_hello;
    std::optional<ClientHello> client_hello;
    std::optional<ServerHello> server_hello;
    uint32_t last_result = 0;          ///< of the server's last piece
    uint64_t last_hash = 0;            ///< of the last whole result
    std::map<uint32_t, size_t> asked;  ///< sequence: index of the type that it came with last
    /// Whether the reply belongs to a message of this type.
    template <class Message>
    bool is_reply_to(uint32_t sequence) const {
        const auto found = asked.find(sequence);
        return found != asked.end() && found->second == ClientMessage(Message{}).index();
    }
    void hear(const ClientMessage& message);
    void hear(const ServerMessage& message);
};

enum class Fate : uint8_t {
    kept,     ///< goes on as it came, byte for byte
    changed,  ///< goes on encoded anew
    dropped,  ///< does not go on
};

/// A spoiler of messages. What cannot be decoded goes on as it came unless `unread` says otherwise.
class MessageSpoiler : public Spoiler {
public:
    void from_client(Bytes payload, Link& link) final;
    void from_server(Bytes payload, Link& link) final;

protected:
    virtual Fate client_says(ClientMessage& message, Link& link) {
        static_cast<void>(message), static_cast<void>(link);
        return Fate::kept;
    }
    virtual Fate server_says(ServerMessage& message, Link& link) {
        static_cast<void>(message), static_cast<void>(link);
        return Fate::kept;
    }
    virtual Fate unread_from_client(const Error& error, std::span<const uint8_t> payload) {
        static_cast<void>(error), static_cast<void>(payload);
        return Fate::kept;
    }
    virtual Fate unread_from_server(const Error& error, std::span<const uint8_t> payload) {
        static_cast<void>(error), static_cast<void>(payload);
        return Fate::kept;
    }
    const Talk& talk() const { return talk_; }

private:
    Talk talk_;
};

/// Spoils one type of message by a function of its own (state in its captures is of one connection: `make` is called for each).
template <class Message>
MakeSpoiler spoils_server(std::function<std::function<Fate(Message&, const Talk&, Link&)>()> make) {
    class One final : public MessageSpoiler {
    public:
        explicit One(std::function<Fate(Message&, const Talk&, Link&)> change) : change_(std::move(change)) {}

    protected:
        Fate server_says(ServerMessage& message, Link& link) override {
            auto* mine = std::get_if<Message>(&message);
            return mine == nullptr ? Fate::kept : change_(*mine, talk(), link);
        }

    private:
        std::function<Fate(Message&, const Talk&, Link&)> change_;
    };
    return [make = std::move(make)] { return std::make_unique<One>(make()); };
}
template <class Message>
MakeSpoiler spoils_client(std::function<std::function<Fate(Message&, const Talk&, Link&)>()> make) {
    class One final : public MessageSpoiler {
    public:
        explicit One(std::function<Fate(Message&, const Talk&, Link&)> change) : change_(std::move(change)) {}

    protected:
        Fate client_says(ClientMessage& message, Link& link) override {
            auto* mine = std::get_if<Message>(&message);
            return mine == nullptr ? Fate::kept : change_(*mine, talk(), link);
        }

    private:
        std::function<Fate(Message&, const Talk&, Link&)> change_;
    };
    return [make = std::move(make)] { return std::make_unique<One>(make()); };
}

}  // namespace trochoid::conformance::mutants
