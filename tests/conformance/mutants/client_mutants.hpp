#pragma once
#include "tests/conformance/mutants/mutant.hpp"

// Clients that break one requirement each: a real client behind the relay, with the kit as its server.
namespace trochoid::conformance::mutants {

/// They pass by what a server may not say.
void add_forgiving_clients(std::vector<Mutant>& all);
/// They say what no client may, or at a wrong moment.
void add_lying_clients(std::vector<Mutant>& all);
/// They take hellos, results and clocks otherwise than the standard has it.
void add_erring_clients(std::vector<Mutant>& all);
/// They come again with what is not theirs.
void add_returning_clients(std::vector<Mutant>& all);

/// They break what lies below the messages: first bytes, WebSocket, TLS.
void add_clients_below_messages(std::vector<Mutant>& all);

/// From the fourth clock request on, about 150 ms after the hellos: most cases are over by then. Told once a connection.
template <class Say>
MakeSpoiler once_settled(Say say) {
    return spoils_client<ClockRequest>([say] {
        return [say, requests = 0](ClockRequest&, const Talk& talk, Link& link) mutable {
            constexpr int settled = 4;
            if (++requests == settled) say(talk, link);
            return Fate::kept;
        };
    });
}

/// What a client says that takes something for wrong which is right: its goodbye, and the end.
void refuse_server(Link& link, ErrorCode code, uint16_t requirement);

}  // namespace trochoid::conformance::mutants
