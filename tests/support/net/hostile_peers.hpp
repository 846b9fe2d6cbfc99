#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "protocol/units/error_code.hpp"

namespace trochoid {

/// How a hostile peer treats a server; when it is thrown out, it comes again at once.
enum class Hostility : uint8_t {
    slow_hello,      ///< a byte of its hello every 300 ms
    half_hello,      ///< all of a large hello but its last byte, then nothing
    silence,         ///< connects and says nothing
    magic_alone,     ///< connects, says what it speaks, and then nothing
    view_flood,      ///< logs in and sends views as fast as they are taken
    command_flood,   ///< logs in as a viewer and sends commands as fast as they are taken
    question_flood,  ///< logs in and asks for lists of boxes without reading the answers
    garbage,         ///< 64 KiB of noise
    oversize,        ///< announces a frame of a gigabyte and sends noise for it
    bad_token,       ///< a hello with a token that nobody signed
    hang_up          ///< connects and closes
};

struct HostileCounts {
    uint64_t connections = 0;
    uint64_t bytes_sent = 0;
    std::map<ErrorCode, uint64_t> goodbyes;  ///< codes that servers gave them
    uint64_t without_a_word = 0;             ///< thrown out without a goodbye that they could read
    bool operator==(const HostileCounts&) const = default;
};

/// Peers that attack a server on loopback, each from an address of 127.0.0.0/8 that it shares with few others, all on one thread that
/// gives way to every other on the machine. They stop with their owner.
class HostilePeers {
public:
    struct Group {
        Hostility hostility = Hostility::silence;
        int peers = 1;
        std::string token;  ///< of those that log in; of bad_token the token that they all send
    };
    HostilePeers(uint16_t port, const std::vector<Group>& groups);
    HostilePeers(const HostilePeers&) = delete;
    HostilePeers& operator=(const HostilePeers&) = delete;
    ~HostilePeers();

    HostileCounts counts() const;
    /// Connections that stand now.
    int standing() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace trochoid
