#pragma once
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace trochoid {

/// One end of a TCP stream without a protocol: blocking, with a deadline on every wait.
class BytePeer {
public:
    using Milliseconds = std::chrono::milliseconds;
    static constexpr Milliseconds patience{5000};
    enum class Stream : uint8_t { open, finished, reset };

    /// Listens on a free port of 127.0.0.1; `accept` makes the stream.
    BytePeer();
    /// Connects to a port of 127.0.0.1.
    explicit BytePeer(uint16_t port);
    BytePeer(const BytePeer&) = delete;
    BytePeer& operator=(const BytePeer&) = delete;
    ~BytePeer();

    uint16_t port() const;
    /// False where nobody comes.
    bool accept(Milliseconds within = patience);
    /// False where the stream has broken.
    bool send(std::span<const uint8_t> bytes);
    /// Bytes until so many have come, the stream ends or the deadline passes.
    std::vector<uint8_t> receive(size_t count, Milliseconds within = patience);
    /// As the last `receive` has seen it.
    Stream stream() const;
    /// Tells the other end that nothing more comes.
    void finish();
    void hang_up();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace trochoid
