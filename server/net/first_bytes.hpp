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

}  // namespace trochoid
