#include "tests/conformance/client_trial.hpp"

#include <fmt/format.h>

#include "protocol/units/operator_error.hpp"
#include "tests/conformance/web_stream.hpp"

namespace trochoid::conformance {

namespace {

constexpr Milliseconds end_patience{2000};
constexpr std::string_view ca_mark = "{ca}";

void replace_all(std::string& text, std::string_view mark, const std::string& by) {
    for (size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + by.size()))
        text.replace(at, mark.size(), by);
}

}  // namespace

std::string address_of(const Listener& gate, Transport transport) {
    Endpoint address = gate.address();
    address.transport = transport;
    return to_text(address);
}

void use_transport(ClientTarget& target, Transport transport) {
    target.transport = transport;
    if (!is_encrypted(transport)) {
        if (target.command.find(ca_mark) != std::string::npos)
            throw OperatorError("{ca} in --run has no use without TLS: --transport tls or wss");
        return;
    }
    target.authority = std::make_shared<ThrowawayAuthority>();
    TlsAnswer answer;
    answer.identity = target.authority->certify(certified_host);
    target.tls = std::make_shared<TlsGate>(answer);
}

ClientTrial::ClientTrial(const ClientTarget& target)
    : target_(target), gate_(target.gate ? target.gate : std::make_shared<Listener>(uint16_t{0})) {}

std::unique_ptr<Stream> ClientTrial::come(Way way) {
    if (!program_ && !target_.command.empty()) {
        std::string command = target_.command;
        replace_all(command, "{address}", address_of(*gate_, target_.transport));
        if (target_.authority) replace_all(command, ca_mark, target_.authority->file());
        program_ = std::make_unique<ClientProgram>(command);
    }
    auto stream = gate_->accept(target_.coming);
    if (!stream)
        throw Failed{fmt::format("no client came within {} ms: {}", target_.coming.count(), last_words())};
    return ascend(std::move(stream), way);
}

std::unique_ptr<Stream> ClientTrial::ascend(std::unique_ptr<Stream> tcp, Way way) const {
    std::unique_ptr<Stream> stream = std::move(tcp);
    if (target_.tls && way != Way::plain) stream = target_.tls->accept(std::move(stream), target_.patience);
    if (is_web(target_.transport) && way == Way::whole)
        stream = accept_web(std::move(stream), {}, target_.patience);
    return stream;
}

std::unique_ptr<Stream> ClientTrial::come_again() {
    auto stream = gate_->accept(target_.longest_wait);
    if (!stream) throw Skipped{"the client does not connect again by itself"};
    return stream;
}

ClientPeer& ClientTrial::meet(std::unique_ptr<Stream> stream) {
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
