#include "tests/conformance/mutants/mutant.hpp"

#include <algorithm>

#include "tests/conformance/mutants/client_mutants.hpp"

namespace trochoid::conformance::mutants {

void Talk::hear(const ClientMessage& message) {
    if (const auto* hello = std::get_if<ClientHello>(&message)) client_hello = *hello;
    if (const uint32_t sequence = sequence_of(message); sequence != 0) asked[sequence] = message.index();
    from_client = phase_after(from_client, message);
}

void Talk::hear(const ServerMessage& message) {
    if (const auto* hello = std::get_if<ServerHello>(&message)) server_hello = *hello;
    if (const auto* piece = std::get_if<Delta>(&message)) {
        last_result = piece->result;
        if (piece->last) last_hash = piece->state_hash;
    }
    from_server = phase_after(from_server, message);
}

void MessageSpoiler::from_client(Bytes payload, Link& link) {
    Result<ClientMessage> message = decode_client(payload);
    if (!message) {
        if (unread_from_client(message.error(), payload) == Fate::kept) link.to_server(payload);
        return;
    }
    ClientMessage spoilt = *message;
    const Fate fate = client_says(spoilt, link);
    talk_.hear(*message);
    if (fate == Fate::kept) link.to_server(payload);
    if (fate == Fate::changed) link.say_to_server(spoilt);
}

void MessageSpoiler::from_server(Bytes payload, Link& link) {
    Result<ServerMessage> message = decode_server(payload);
    if (!message) {
        if (unread_from_server(message.error(), payload) == Fate::kept) link.to_client(payload);
        return;
    }
    ServerMessage spoilt = *message;
    const Fate fate = server_says(spoilt, link);
    talk_.hear(*message);
    if (fate == Fate::kept) link.to_client(payload);
    if (fate == Fate::changed) link.say_to_client(spoilt);
}

std::vector<Mutant> all_mutants() {
    std::vector<Mutant> all;
    add_forgiving_servers(all);
    add_lying_servers(all);
    add_other_seas(all);
    add_forgiving_clients(all);
    add_lying_clients(all);
    add_erring_clients(all);
    add_returning_clients(all);
    add_clients_below_messages(all);
    std::stable_sort(all.begin(), all.end(),
                     [](const Mutant& a, const Mutant& b) { return a.requirement < b.requirement; });
    all.insert(all.begin(), {Mutant{"honest", 0, Side::server, "A server that breaks nothing",
                                    [] { return std::make_unique<Spoiler>(); }}});
    return all;
}

}  // namespace trochoid::conformance::mutants
