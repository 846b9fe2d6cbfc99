#pragma once
#include <functional>
#include <optional>

#include "tests/conformance/mutants/relay.hpp"

namespace trochoid::conformance::mutants {

/// Cuts one direction of a connection into what a spoiler gets: the magic, payloads, or bytes of other kinds of streams. Unlike
/// FrameReader it refuses nothing: what is wrong goes on as it came.
class FrameCutter {
public:
    enum class From : uint8_t { client, server };
    FrameCutter(From from, Spoiler& spoiler, Link& link) : from_(from), spoiler_(spoiler), link_(link) {
        if (from == From::server) kind_ = Kind::frames;
    }

    void take(std::span<const uint8_t> bytes);
    /// The stream has ended: what is left goes on as it is.
    void end();
    /// Payloads in force: of the first frame, which is the hello, and from the next header on.
    void set_longest(uint32_t first, uint32_t later) { first_longest_ = first, longest_ = later; }
    /// It is no raw stream: bytes go on as they come.
    void take_as_other() { kind_ = Kind::other; }
    bool is_other() const { return kind_ == Kind::other; }

private:
    enum class Kind : uint8_t { unknown, magic, frames, as_it_is, other };
    bool step();
    bool step_frame();
    void choose();
    void hand_on(Bytes bytes);
    Bytes cut(size_t count);

    const From from_;
    Spoiler& spoiler_;
    Link& link_;
    Kind kind_ = Kind::unknown;
    Bytes held_;
    uint64_t swallow_ = 0;
    uint32_t first_longest_ = 0;
    uint32_t longest_ = 0;
    bool first_ = true;
};

}  // namespace trochoid::conformance::mutants
