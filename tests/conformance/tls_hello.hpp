#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace trochoid::conformance {

/// What a client's first record of TLS says.
struct TlsHello {
    size_t bytes = 0;                    ///< payload of the record
    std::vector<uint16_t> versions;      ///< offered, 0x0304 for 1.3
    std::vector<uint16_t> groups;        ///< for keys, in the numbers of RFC 8446 (4.2.7)
    std::vector<std::string> protocols;  ///< by ALPN
    bool early_data = false;
};

inline constexpr uint8_t tls_handshake_record = 0x16;
inline constexpr size_t tls_record_header_bytes = 5;
inline constexpr uint16_t tls_1_3 = 0x0304;
inline constexpr uint16_t group_p_256 = 23;
inline constexpr uint16_t group_x25519 = 29;

/// The record's payload, bytes; `header` has at least tls_record_header_bytes.
size_t tls_record_bytes(std::span<const uint8_t> header);
/// Reads a whole record, header and all, and judges it by: Failed where a client may not begin so. Of what does not begin
/// as TLS one byte will do.
TlsHello judge_tls_hello(std::span<const uint8_t> record);
/// For reports.
std::string text_of(const TlsHello& hello);

}  // namespace trochoid::conformance
