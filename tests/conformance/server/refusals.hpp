#pragma once
#include <functional>
#include <string>

#include "protocol/codec/codec.hpp"
#include "tests/conformance/server_trial.hpp"

// The most common kind of case: a valid session, one thing wrong, the right goodbye.
namespace trochoid::conformance::server {

/// What a server has to say to something wrong.
struct Answer {
    ErrorCode code = ErrorCode::none;
    uint16_t requirement = 0;
};

/// After a login this payload comes: the goodbye has to be that one.
Case refused(std::string id, std::string title, Bytes payload, Answer answer);
/// The same in the place of the hello, after the magic.
Case refused_first(std::string id, std::string title, Bytes payload, Answer answer);
/// After a login this payload comes: the session goes on.
Case taken(std::string id, std::string title, Bytes payload);
/// In the place of the hello: a session comes about.
Case taken_first(std::string id, std::string title, Bytes payload);

}  // namespace trochoid::conformance::server
