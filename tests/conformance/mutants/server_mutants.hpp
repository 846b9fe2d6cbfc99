#pragma once
#include <string>
#include <utility>

#include "tests/conformance/mutants/mutant.hpp"

namespace trochoid::conformance::mutants {

inline Mutant server_mutant(uint16_t requirement, std::string name, std::string what, MakeSpoiler make) {
    return {std::move(name), requirement, Side::server, std::move(what), std::move(make)};
}

/// A change of one connection's messages without state of its own.
template <class Message, class Change>
MakeSpoiler each_of_server(Change change) {
    return spoils_server<Message>(
        [change] { return std::function<Fate(Message&, const Talk&, Link&)>(change); });
}
template <class Message, class Change>
MakeSpoiler each_of_client(Change change) {
    return spoils_client<Message>(
        [change] { return std::function<Fate(Message&, const Talk&, Link&)>(change); });
}

/// Does not hear the goodbyes that fit, and leaves the client's connection open: the server has gone on, as far as can be seen.
MakeSpoiler no_goodbye(std::function<bool(const Goodbye&, const Talk&)> fits);

/// Says that goodbye in the server's place; nothing goes on after it.
Fate leave_with(ErrorCode code, Link& link);

}  // namespace trochoid::conformance::mutants
