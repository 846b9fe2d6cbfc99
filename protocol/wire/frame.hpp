#pragma once
#include <array>
#include <optional>

#include "protocol/codec/codec.hpp"

namespace trochoid {

/// What a client sends once, before its first frame: "TROCHOID" in ASCII.
inline constexpr std::array<uint8_t, 8> stream_magic{'T', 'R', 'O', 'C', 'H', 'O', 'I', 'D'};

/// Header of a frame: u32 length of the payload in bytes, u32 zero, both little-endian. The payload follows.
inline constexpr size_t frame_header_bytes = 8;
std::array<uint8_t, frame_header_bytes> frame_header(uint32_t length);

/// The payload (1 byte to 2^32 - 1) behind its header, ready for a stream.
Bytes frame(std::span<const uint8_t> payload);

/// Cuts a stream into payloads, whatever pieces it comes in. Owns the part of one frame that has arrived, plus at most
/// read_ahead bytes: a header that announces much allocates nothing, an idle stream owns nothing.
class FrameReader {
public:
    enum class Opening : uint8_t {
        magic,   ///< a server reads the magic before the first frame
        frames,  ///< a client reads frames from the first byte
    };
    static constexpr size_t read_ahead = 1024;

    /// `longest`: payload limit in force, bytes.
    FrameReader(Opening opening, uint32_t longest);

    /// Holds for frames whose header has not been read whole yet: after a login in mid-chunk the rest of the chunk is
    /// judged by the new limit.
    void set_longest(uint32_t longest) { longest_ = longest; }

    /// Takes bytes from the front of `input` until a payload is whole or `input` is empty. The payload is 8-byte aligned.
    /// wrong_magic, malformed_frame and frame_too_long come with the bytes that prove them; the stream is lost then, and
    /// every later call repeats the error.
    Result<std::optional<Bytes>> next(std::span<const uint8_t>& input);

    /// Whether the stream may end here: after the magic, between two frames.
    bool between_frames() const { return magic_left_ == 0 && header_read_ == 0; }
    /// Bytes owned for the frame at hand.
    size_t allocated() const { return payload_.capacity(); }

private:
    bool read_magic(std::span<const uint8_t>& input);
    bool read_header(std::span<const uint8_t>& input);

    uint32_t longest_;
    size_t magic_left_;
    std::array<uint8_t, frame_header_bytes> header_{};
    size_t header_read_ = 0;
    uint32_t length_ = 0;
    Bytes payload_;
    std::optional<Error> error_;
};

}  // namespace trochoid
