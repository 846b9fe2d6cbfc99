#pragma once
#include <cstdint>
#include <span>

#include "protocol/wire/frame.hpp"

namespace trochoid {

/// What a stream turns out to be by its first bytes.
enum class StreamForm : uint8_t {
    undecided,  ///< more bytes are needed, three at most
    tls,        ///< a TLS record of a handshake
    http,       ///< an HTTP method begins with a capital letter
    raw,        ///< the magic; also whatever nothing else explains: the session refuses it with a code
};

/// The form of a stream that begins like this. Only a 'T' needs more than one byte: "TROCHOID" or "TRACE".
constexpr StreamForm form_of(std::span<const uint8_t> first) {
    constexpr uint8_t tls_handshake = 0x16;
    if (first.empty()) return StreamForm::undecided;
    if (first[0] == tls_handshake) return StreamForm::tls;
    if (first[0] < 'A' || first[0] > 'Z') return StreamForm::raw;
    constexpr size_t enough = 3;
    for (size_t i = 0; i < enough; ++i) {
        if (i == first.size()) return StreamForm::undecided;
        if (first[i] != stream_magic[i]) return StreamForm::http;
    }
    return StreamForm::raw;
}

/// A TLS ClientHello comes whole in its first record: at most this much with the record's header (bytes), as much as a frame before
/// login. Those of libraries are 200 to 600 bytes long, of browsers with keys
/// that quantum computers cannot find 1,700 and more.
inline constexpr size_t longest_tls_hello = 4096;
/// Enough of it to tell how long it is.
inline constexpr size_t tls_hello_begin = 9;

/// Bytes until a ClientHello is whole, by its first `tls_hello_begin`; 0: this is none, or not whole in its record.
constexpr size_t tls_hello_bytes(std::span<const uint8_t, tls_hello_begin> first) {
    constexpr size_t record_header = 5;
    constexpr size_t message_header = 4;
    const size_t record = size_t{first[3]} << 8 | first[4];
    const size_t message = size_t{first[6]} << 16 | size_t{first[7]} << 8 | first[8];
    const bool tls = first[0] == 0x16 && first[1] == 3 && first[2] <= 4;
    const bool client_hello = first[5] == 1 && message + message_header <= record;
    const size_t whole = record_header + record;
    return tls && client_hello && whole <= longest_tls_hello ? whole : 0;
}

}  // namespace trochoid
