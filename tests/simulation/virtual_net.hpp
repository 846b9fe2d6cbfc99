#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tests/support/net/chaos_link.hpp"

namespace trochoid {

class VirtualWire;

/// One end of a byte stream under virtual time, with a socket's buffers and manners.
class VirtualEnd {
public:
    struct Moved {
        size_t bytes = 0;
        bool closed = false;
    };
    VirtualEnd(std::shared_ptr<VirtualWire> wire, int side) : wire_(std::move(wire)), side_(side) {}
    VirtualEnd(const VirtualEnd&) = delete;
    VirtualEnd& operator=(const VirtualEnd&) = delete;
    /// Closes.
    ~VirtualEnd();

    Moved read(std::span<uint8_t> into);
    Moved write(std::span<const uint8_t> bytes);
    /// Calls back once, later, when there is something to read (or the stream's end), or room to write.
    void when_readable(std::function<void()> ready);
    void when_writable(std::function<void()> ready);
    void finish();
    void close();

private:
    std::shared_ptr<VirtualWire> wire_;
    int side_;
};

/// A connection: two directions that suffer what the schedule says.
class VirtualWire : public std::enable_shared_from_this<VirtualWire> {
public:
    VirtualWire(const ConnectionFaults& faults, uint64_t seed);
    VirtualWire(const VirtualWire&) = delete;
    VirtualWire& operator=(const VirtualWire&) = delete;

    static std::unique_ptr<VirtualEnd> end(const std::shared_ptr<VirtualWire>& wire, int side) {
        return std::make_unique<VirtualEnd>(wire, side);
    }
    void cut(CutKind kind);
    /// What has not happened to it yet will not happen.
    void heal();
    /// Nobody is called back any more.
    void forget();
    std::optional<CutKind> was_cut() const { return cut_; }
    uint64_t delivered(int from_side) const { return ways_[static_cast<size_t>(from_side)].link.delivered(); }
    bool over() const { return reset_ || (ends_[0].closed && ends_[1].closed); }

private:
    friend class VirtualEnd;
    /// From one side to the other.
    struct Way {
        ChaosLink link;
        std::deque<uint8_t> arrived;
        bool finished = false;  // the end of the stream has arrived
        uint64_t put = 0;
        int64_t pump_at_us = INT64_MAX;
    };
    struct End {
        std::function<void()> readable;
        std::function<void()> writable;
        bool closed = false;
        bool finished = false;  // writes nothing more
    };
    Way& from(int side) { return ways_[static_cast<size_t>(side)]; }
    Way& towards(int side) { return ways_[static_cast<size_t>(1 - side)]; }
    End& at(int side) { return ends_[static_cast<size_t>(side)]; }
    size_t room(int side);
    void pump(int side);
    void wake(int side);
    void reset();

    std::array<Way, 2> ways_;
    std::array<End, 2> ends_;
    std::optional<CutKind> cut_;
    bool reset_ = false;
    bool silent_ = false;
};

/// Who listens where, and every connection's faults by its number.
class VirtualNet {
public:
    using Accept = std::function<void(std::unique_ptr<VirtualEnd>)>;
    struct Plan {
        ConnectionFaults faults;
        uint16_t port = 0;  ///< where it leads, whatever was asked for: a balancer stands in between
    };

    explicit VirtualNet(uint64_t seed) : seed_(seed) {}
    VirtualNet(const VirtualNet&) = delete;
    VirtualNet& operator=(const VirtualNet&) = delete;
    /// Drops what still waits for bytes, as an io_context drops its handlers.
    ~VirtualNet();

    /// What becomes of connection `number` to a port.
    std::function<Plan(uint64_t number, uint16_t port)> plan;

    void listen(uint16_t port, Accept accept);
    void deaf(uint16_t port);
    /// Calls back, later: the client's end, or nullptr where nobody listens.
    void connect(uint16_t port, std::function<void(std::unique_ptr<VirtualEnd>)> done);
    void cut_all(CutKind kind);
    void heal_all();
    uint64_t connections() const { return wires_.size(); }
    const std::vector<std::shared_ptr<VirtualWire>>& wires() const { return wires_; }

private:
    uint64_t seed_;
    std::vector<std::pair<uint16_t, Accept>> listening_;
    std::vector<std::shared_ptr<VirtualWire>> wires_;
};

}  // namespace trochoid
