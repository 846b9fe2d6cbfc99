#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tests/conformance/client/refusals.hpp"
#include "tests/conformance/kit_sea.hpp"
#include "tests/conformance/web_stream.hpp"

// TLS as a client speaks it. Its first record is judged in each connection (tls_hello.hpp).
namespace trochoid::conformance::client {

namespace {

const ClientTarget& encrypted(const ClientTrial& trial) {
    if (!trial.target().tls)
        throw Skipped{"needs TLS: --transport tls or wss, and {ca} in --run for whom to trust"};
    return trial.target();
}

TlsAnswer usual_answer(const ClientTrial& trial) {
    TlsAnswer answer;
    answer.identity = encrypted(trial).authority->certify(certified_host);
    return answer;
}

std::unique_ptr<TlsStream> shaken(ClientTrial& trial, const TlsAnswer& answer, TlsHello* hello = nullptr) {
    return TlsGate(answer).accept(trial.come(Way::plain), trial.target().patience, hello);
}

/// The protocol over TLS, as the client's transport has it.
ClientPeer& meet_over(ClientTrial& trial, std::unique_ptr<Stream> tls) {
    if (!is_web(trial.target().transport)) return trial.meet(std::move(tls));
    return trial.meet(accept_web(std::move(tls), {}, trial.target().patience));
}

/// A handshake that the client has to refuse; also where it first agrees and then leaves without a word.
void expect_refusal(ClientTrial& trial, const TlsAnswer& answer, const char* otherwise) {
    try {
        const auto stream = shaken(trial, answer);
        std::array<uint8_t, 1> first{};
        if (stream->read(first, trial.target().patience) > 0 || stream->state() == Stream::State::open)
            throw Failed{otherwise};
        trial.note("it left after the handshake");
    } catch (const Failed& refused) {
        if (!refused.reason.starts_with(TlsGate::no_handshake)) throw;
        trial.note(refused.reason);
    }
}

void add_handshakes(Catalogue& all) {
    const auto add = [&](const char* id, const char* title, ClientBody body) {
        all.push_back(client_case(std::string("R-106/") + id, title, std::move(body)));
    };
    add("client-hello",
        "The ClientHello is whole in its first record, offers TLS 1.3 with X25519 or P-256, no early data, and by ALPN trochoid, "
        "http/1.1 or nothing",
        [](ClientTrial& trial) {
            TlsHello hello;
            const auto stream = shaken(trial, usual_answer(trial), &hello);
            trial.note(text_of(hello));
            if (const std::string version = stream->agreement().version; version != "TLSv1.3")
                throw Failed{"the handshake ended at " + version};
        });
    add("version-1-2", "A server that speaks TLS 1.2 at most is refused", [](ClientTrial& trial) {
        TlsAnswer answer = usual_answer(trial);
        answer.at_most_1_2 = true;
        expect_refusal(trial, answer, "the client agrees to TLS 1.2");
    });
    add("other-host", "A certificate that is made out to another host is refused", [](ClientTrial& trial) {
        TlsAnswer answer;
        answer.identity = encrypted(trial).authority->certify("DNS:sea.example,IP:127.0.0.9");
        expect_refusal(trial, answer, "the client goes on with a server that is another one");
    });
    add("other-issuer", "A certificate of an issuer that the client was not told to trust is refused",
        [](ClientTrial& trial) {
            encrypted(trial);
            TlsAnswer answer;
            answer.identity = ThrowawayAuthority().certify(certified_host);
            expect_refusal(trial, answer,
                           "the client goes on with a server whose certificate it cannot trust");
        });
    add("no-alpn", "We agree to nothing by ALPN: the session goes on", [](ClientTrial& trial) {
        TlsAnswer answer = usual_answer(trial);
        answer.names_no_protocol = true;
        ClientPeer& peer = meet_over(trial, shaken(trial, answer));
        peer.welcome();
        peer.expect_service();
    });
    const auto agrees = [&](const char* id, const char* title, const char* group, uint16_t number) {
        add(id, title, [group, number](ClientTrial& trial) {
            TlsAnswer answer = usual_answer(trial);
            answer.groups = group;
            TlsHello hello;
            try {
                ClientPeer& peer = meet_over(trial, shaken(trial, answer, &hello));
                peer.welcome();
                peer.expect_service();
            } catch (const Failed& failed) {
                const bool offered =
                    std::find(hello.groups.begin(), hello.groups.end(), number) != hello.groups.end();
                if (offered || !failed.reason.starts_with(TlsGate::no_handshake)) throw;
                trial.note("it is not offered");
            }
        });
    };
    agrees("x25519", "We agree on keys by X25519 alone: the session goes on where that is offered", "X25519",
           group_x25519);
    agrees("p-256", "We agree on keys by P-256 alone: the session goes on where that is offered", "P-256",
           group_p_256);
}

void add_sessions(Catalogue& all) {
    all.push_back(client_case(
        "R-106/close-notify", "A client that leaves says goodbye, then close_notify", [](ClientTrial& trial) {
            encrypted(trial);
            ClientPeer& peer = trial.welcome();
            peer.send(peer.ours());
            peer.expect_goodbye({ErrorCode::unexpected_message, requirement::hello_first});
            if (peer.stream().state() != Stream::State::ended) throw Failed{"the connection was reset"};
        }));
    all.push_back(client_case("R-106/early-data",
                              "Our tickets allow early data: a client that comes again sends none",
                              [](ClientTrial& trial) {
                                  encrypted(trial);
                                  ClientPeer& first = trial.welcome();
                                  first.expect_service();
                                  first.stream().finish();
                                  first.expect_end();
                                  trial.accept_again().await_hello();
                              }));
}

}  // namespace

void add_tls_cases(Catalogue& all) {
    add_handshakes(all);
    add_sessions(all);
}

}  // namespace trochoid::conformance::client
