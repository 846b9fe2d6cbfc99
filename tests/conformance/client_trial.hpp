#pragma once
#include <deque>
#include <memory>
#include <string>
#include <utility>

#include "tests/conformance/client_peer.hpp"
#include "tests/conformance/client_program.hpp"
#include "tests/conformance/listener.hpp"
#include "tests/conformance/target.hpp"
#include "tests/conformance/tls_stream.hpp"

namespace trochoid::conformance {

/// The client under test, and how it comes to us.
struct ClientTarget {
    /// For a shell, with {address} where we listen and {ca} where to read whom to trust; empty: whoever comes to `gate`.
    std::string command;
    Transport transport = Transport::tcp;
    std::shared_ptr<const ThrowawayAuthority> authority;  ///< of our certificates; null: no TLS
    std::shared_ptr<const TlsGate> tls;                   ///< null: no TLS
    std::shared_ptr<Listener> gate;                       ///< null: each case has its own
    Milliseconds patience{5000};                          ///< for an answer
    Milliseconds coming{5000};                            ///< for a connection
    Milliseconds longest_wait{8000};                      ///< longer waits are skipped
};

/// Where it listens, as clients are told.
std::string address_of(const Listener& gate, Transport transport);
/// How the client comes from now on, with a certificate of our own where it is by TLS. OperatorError where --run does not fit that, or
/// OpenSSL cannot.
void use_transport(ClientTarget& target, Transport transport);

/// One run of a case that tests a client: the program, which ends with it, and its connections.
class ClientTrial final : public Trial {
public:
    explicit ClientTrial(const ClientTarget& target);

    const ClientTarget& target() const { return target_; }
    /// The client's next connection, so far up its way; the first call starts the program. Failed where none comes.
    std::unique_ptr<Stream> come(Way way);
    /// From TCP so far up the client's way. Failed where TLS, or an upgrade, comes to nothing.
    std::unique_ptr<Stream> ascend(std::unique_ptr<Stream> tcp, Way way) const;
    /// The protocol over a stream of the client's. Nothing has been read.
    ClientPeer& meet(std::unique_ptr<Stream> stream);
    /// The client's next connection, ready for the protocol; the first call starts the program. Failed where none comes.
    ClientPeer& accept() { return meet(come(Way::whole)); }
    /// The connection after one that has ended. Skipped where the client does not come again within `longest_wait`.
    ClientPeer& accept_again() { return meet(ascend(come_again(), Way::whole)); }
    std::unique_ptr<Stream> come_again();
    /// Whether the client connects again within that time.
    bool comes_within(Milliseconds span) { return gate_->accept(span) != nullptr; }
    /// A session: the client's hello, and ours, changed as told.
    ClientPeer& welcome(const std::function<void(ServerHello&)>& change = [](ServerHello&) {});
    /// Ends the program. Failed where it has crashed.
    void finish();
    /// Whether it has ended by itself within that time; true where it was not ours to start.
    bool ended_by_itself(Milliseconds within) { return !program_ || program_->ended(within); }
    /// What it wrote last, for reports of failures.
    std::string last_words() const { return program_ ? program_->last_words(300) : std::string(); }

private:
    const ClientTarget& target_;
    std::shared_ptr<Listener> gate_;
    std::unique_ptr<ClientProgram> program_;
    std::deque<ClientPeer> peers_;
};

using ClientBody = std::function<void(ClientTrial&)>;
/// A case about a client.
Case client_case(std::string id, std::string title, ClientBody body);

// One function a file of client/: each adds its cases.
namespace client {
void add_hello_cases(Catalogue& catalogue);
void add_stream_cases(Catalogue& catalogue);
void add_web_cases(Catalogue& catalogue);
void add_tls_cases(Catalogue& catalogue);
void add_buffer_cases(Catalogue& catalogue);
void add_field_cases(Catalogue& catalogue);
void add_result_field_cases(Catalogue& catalogue);
void add_patch_plane_cases(Catalogue& catalogue);
void add_session_cases(Catalogue& catalogue);
void add_result_cases(Catalogue& catalogue);
void add_clock_cases(Catalogue& catalogue);
void add_terrain_cases(Catalogue& catalogue);
void add_return_cases(Catalogue& catalogue);
void add_golden_cases(Catalogue& catalogue);
void add_evolution_cases(Catalogue& catalogue);
}  // namespace client

}  // namespace trochoid::conformance
