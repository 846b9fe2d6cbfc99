#pragma once
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "tests/conformance/target.hpp"

namespace trochoid::conformance {

/// A well-behaved session that stands while the cases run: whatever they send, the server goes on answering it.
class Witness {
public:
    explicit Witness(const Target& target);
    Witness(const Witness&) = delete;
    Witness& operator=(const Witness&) = delete;
    ~Witness();

    /// Waits for an exchange with the server that begins after this call. Failed where none succeeds in time.
    void confirm();
    /// Exchanges so far, and the longest, microseconds.
    uint64_t exchanges() const;
    int64_t slowest_us() const;

private:
    void stand();

    const Target& target_;
    mutable std::mutex mutex_;
    std::condition_variable news_;
    uint64_t begun_ = 0;  // exchanges begun, and the last of them that succeeded
    uint64_t answered_ = 0;
    uint64_t exchanges_ = 0;
    int64_t slowest_us_ = 0;
    std::string trouble_;  // why the last one failed
    bool wanted_ = false;  // somebody waits: the next exchange begins at once
    bool over_ = false;
    std::thread thread_;
};

}  // namespace trochoid::conformance
