#pragma once
#include <cstdint>
#include <memory>

namespace trochoid {

/// A real session server over a small sea whose first result has one wrong train. In a file of its own: both sides have a `Transport`.
class LyingServer {
public:
    LyingServer();
    LyingServer(const LyingServer&) = delete;
    LyingServer& operator=(const LyingServer&) = delete;
    ~LyingServer();

    uint16_t port() const;
    /// Hash of the state that a client of the default view has to end up with.
    uint64_t right_hash() const;
    uint64_t desyncs_of_trains();
    uint64_t resyncs();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace trochoid
