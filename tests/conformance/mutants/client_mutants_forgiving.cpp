#include <fmt/format.h>

#include "protocol/units/error_code.hpp"
#include "protocol/units/version.hpp"
#include "protocol/wire/requirements.hpp"
#include "tests/conformance/mutants/client_mutants.hpp"

namespace trochoid::conformance::mutants {

namespace {

/// The order of results and pieces, as a client keeps it.
class ResultOrder {
public:
    void begin(const ServerHello& hello) { begun_ = hello.resumed ? 1 : 0; }
    /// Whether the piece may come now; counted if so.
    bool take(const Delta& piece) {
        const bool anew = next_piece_ == 0 && piece.piece == 0 && piece.result == begun_ + 1;
        const bool on =
            next_piece_ != 0 && piece.result == begun_ && piece.piece == next_piece_ && piece.base == base_;
        if (!anew && !on) return false;
        begun_ = piece.result;
        base_ = piece.base;
        next_piece_ = piece.last ? uint16_t{0} : static_cast<uint16_t>(piece.piece + 1);
        return true;
    }

private:
    uint32_t begun_ = 0;
    uint32_t base_ = 0;
    uint16_t next_piece_ = 0;
};

/// What breaks this requirement never reaches the client: it seems not to look.
class Forgiving final : public MessageSpoiler {
public:
    explicit Forgiving(uint16_t requirement) : requirement_(requirement) {}

private:
    Fate server_says(ServerMessage& message, Link&) override {
        if (requirement_ == requirement::hello_first && !expected(talk().from_server, message))
            return Fate::dropped;
        if (requirement_ != requirement::result_order) return Fate::kept;
        if (const auto* hello = std::get_if<ServerHello>(&message)) order_.begin(*hello);
        const auto* piece = std::get_if<Delta>(&message);
        return piece == nullptr || order_.take(*piece) ? Fate::kept : Fate::dropped;
    }
    Fate unread_from_server(const Error& error, std::span<const uint8_t> payload) override {
        return goodbye_for_payload(error, payload, server_identifier).requirement == requirement_
                   ? Fate::dropped
                   : Fate::kept;
    }

    const uint16_t requirement_;
    ResultOrder order_;
};

/// The client's goodbye that names this requirement, and its end, reach nobody.
class Staying final : public MessageSpoiler {
public:
    explicit Staying(uint16_t requirement) : requirement_(requirement) {}
    void client_ended(Link& link) override {
        if (!stays_) link.end_server();
    }

private:
    Fate client_says(ClientMessage& message, Link&) override {
        const auto* goodbye = std::get_if<Goodbye>(&message);
        stays_ = stays_ || (goodbye != nullptr && goodbye->requirement == requirement_);
        return stays_ ? Fate::dropped : Fate::kept;
    }

    const uint16_t requirement_;
    bool stays_ = false;
};

/// Acknowledges with whatever hash the server says.
class Agreeing final : public MessageSpoiler {
    Fate server_says(ServerMessage& message, Link&) override {
        const auto* piece = std::get_if<Delta>(&message);
        if (piece != nullptr && piece->last) told_[piece->result] = piece->state_hash;
        return Fate::kept;
    }
    Fate client_says(ClientMessage& message, Link&) override {
        auto* ack = std::get_if<Ack>(&message);
        const auto told = ack == nullptr ? told_.end() : told_.find(ack->result);
        if (told == told_.end() || told->second == ack->state_hash) return Fate::kept;
        ack->state_hash = told->second;
        return Fate::changed;
    }

    std::map<uint32_t, uint64_t> told_;
};

/// The server's hello is made good where it is not.
MakeSpoiler takes_any_hello(bool (*mend)(ServerHello& hello, const ClientHello& asked)) {
    return spoils_server<ServerHello>([mend] {
        return [mend](ServerHello& hello, const Talk& talk, Link&) {
            return talk.client_hello && mend(hello, *talk.client_hello) ? Fate::changed : Fate::kept;
        };
    });
}

bool any_version(ServerHello& hello, const ClientHello& asked) {
    if (hello.protocol >= asked.protocol_min && hello.protocol <= asked.protocol_max) return false;
    hello.protocol = asked.protocol_max;
    return true;
}
bool any_model(ServerHello& hello, const ClientHello& asked) {
    if (hello.model == asked.model) return false;
    hello.model = asked.model;
    return true;
}
bool any_resumption(ServerHello& hello, const ClientHello& asked) {
    if (!hello.resumed || asked.resume) return false;
    hello.resumed = false;
    return true;
}

}  // namespace

void add_forgiving_clients(std::vector<Mutant>& all) {
    const auto add = [&](uint16_t number, const char* what, MakeSpoiler make) {
        all.push_back({fmt::format("client-forgives-{}", number), number, Side::client,
                       fmt::format("A client that forgives {}", what), std::move(make)});
    };
    const auto blind = [&](uint16_t number, const char* what) {
        add(number, what, [number] { return std::make_unique<Forgiving>(number); });
    };
    const auto staying = [&](uint16_t number, const char* what) {
        add(number, what, [number] { return std::make_unique<Staying>(number); });
    };
    staying(requirement::frame_header, "headers that are none");
    staying(requirement::frame_length, "frames beyond the limit in force");
    blind(requirement::file_identifier, "payloads without the identifier of its direction");
    blind(requirement::verified_buffer, "buffers that the verifier refuses");
    blind(requirement::size_field, "bytes that trail");
    blind(requirement::known_union_tag, "tags that nobody knows");
    blind(requirement::fields_present, "fields that are missing");
    blind(requirement::finite_numbers, "numbers that are not finite");
    blind(requirement::ranges, "values out of range");
    blind(requirement::unit_quaternion, "quaternions of any length");
    blind(requirement::hello_first, "messages before the hello, and hellos that come twice");
    add(requirement::version_range, "versions that it has not offered", takes_any_hello(any_version));
    blind(requirement::region_count, "keys of more than 32 regions");
    add(requirement::acknowledged_state, "hashes that are not its state's",
        [] { return std::make_unique<Agreeing>(); });
    blind(requirement::result_order, "results and pieces out of order");
    add(136, "tiles that are not of the grid", spoils_server<TerrainTiles>([] {
            return [](TerrainTiles&, const Talk& talk, Link&) {
                return talk.server_hello ? Fate::dropped : Fate::kept;
            };
        }));
    add(requirement::model_version, "another model than its own", takes_any_hello(any_model));
    add(158, "a server that goes on with what was not offered", takes_any_hello(any_resumption));
}

}  // namespace trochoid::conformance::mutants
