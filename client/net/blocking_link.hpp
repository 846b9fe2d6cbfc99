#pragma once
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>

#include "client/net/connection.hpp"

namespace trochoid {

/// The server refused, or went away: one sentence that says what to do. `unreachable` where no session came about
/// because nothing answered at the address.
class LinkError : public std::runtime_error {
public:
    LinkError(const std::string& message, ErrorCode code, bool unreachable)
        : std::runtime_error(message), code_(code), unreachable_(unreachable) {}
    ErrorCode code() const { return code_; }
    bool unreachable() const { return unreachable_; }

private:
    ErrorCode code_;
    bool unreachable_;
};

struct LinkOptions {
    Endpoint server;
    std::string software;  ///< name and version for the hello
    std::string token;     ///< empty: viewer
    std::chrono::milliseconds patience{
        10000};  ///< for each answer; tracing land for a new wind takes a while
};

/// A camera that sees no water (high up, looking at the sky), for clients that want none but their sync regions'.
ViewState view_of_nothing();

/// A session for programs that ask and wait: it looks at nothing, so the server sends it next to no sea. Every call
/// blocks until the answer has come, and throws LinkError when none does. One thread at a time.
class BlockingLink {
public:
    /// Connects and exchanges hellos.
    explicit BlockingLink(LinkOptions options);
    BlockingLink(const BlockingLink&) = delete;
    BlockingLink& operator=(const BlockingLink&) = delete;
    /// Says goodbye.
    ~BlockingLink();

    const ServerHello& hello() const;
    /// Everything but ListBoxes. A refused command is an answer too: see its code.
    CommandReply command(Command command);
    BoxList list();
    ClockReply clock();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace trochoid
