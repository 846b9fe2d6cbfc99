#include "tests/conformance/client_trial.hpp"

#include <fmt/format.h>

namespace trochoid::conformance {

namespace {

constexpr Milliseconds end_patience{2000};

std::string with_address(std::string command, const std::string& address) {
    constexpr std::string_view mark = "{address}";
    for (size_t at = command.find(mark); at != std::string::npos;
         at = command.find(mark, at + address.size()))
        command.replace(at, mark.size(), address);
    return command;
}

}  // namespace

ClientTrial::ClientTrial(const ClientTarget& target)
    : target_(target), gate_(target.gate ? target.gate : std::make_shared<Listener>(uint16_t{0})) {}

ClientPeer& ClientTrial::accept() {
    if (!program_ && !target_.command.empty())
        program_ = std::make_unique<ClientProgram>(with_address(target_.command, to_text(gate_->address())));
    auto stream = gate_->accept(target_.coming);
    if (!stream)
        throw Failed{fmt::format("no client came within {} ms: {}", target_.coming.count(), last_words())};
    return peers_.emplace_back(std::move(stream), target_.patience, *this);
}

ClientPeer& ClientTrial::accept_again() {
    auto stream = gate_->accept(target_.longest_wait);
    if (!stream) throw Skipped{"the client does not connect again by itself"};
    return peers_.emplace_back(std::move(stream), target_.patience, *this);
}

ClientPeer& ClientTrial::welcome(const std::function<void(ServerHello&)>& change) {
    ClientPeer& peer = accept();
    peer.welcome(change);
    return peer;
}

void ClientTrial::finish() {
    if (!program_) return;
    const std::string wrong = program_->end(end_patience);
    if (!wrong.empty()) throw Failed{fmt::format("{}: {}", wrong, last_words())};
}

Case client_case(std::string id, std::string title, ClientBody body) {
    Case made;
    made.id = std::move(id);
    made.title = std::move(title);
    made.side = Side::client;
    made.body = [body = std::move(body)](Trial& trial) {
        auto& its = dynamic_cast<ClientTrial&>(trial);
        try {
            body(its);
        } catch (const Failed& failed) {
            // What the program says of it helps to find the reason.
            const std::string words = its.last_words();
            throw Failed{words.empty() ? failed.reason
                                       : fmt::format("{} (it wrote: {})", failed.reason, words)};
        }
        its.finish();
    };
    return made;
}

}  // namespace trochoid::conformance
