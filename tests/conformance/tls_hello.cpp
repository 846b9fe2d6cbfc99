#include "tests/conformance/tls_hello.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "tests/conformance/verdict.hpp"

namespace trochoid::conformance {

namespace {

constexpr uint8_t client_hello = 1;
constexpr uint16_t supported_groups = 10;
constexpr uint16_t alpn = 16;
constexpr uint16_t early_data = 42;
constexpr uint16_t supported_versions = 43;

/// Numbers and vectors of TLS off the front (RFC 8446, 3).
class Reader {
public:
    explicit Reader(std::span<const uint8_t> bytes) : bytes_(bytes) {}
    bool empty() const { return bytes_.empty(); }
    std::span<const uint8_t> take(size_t count) {
        if (count > bytes_.size())
            throw Failed{"R-106: the ClientHello cannot be read: a length is too long"};
        const auto front = bytes_.first(count);
        bytes_ = bytes_.subspan(count);
        return front;
    }
    size_t number(size_t bytes) {
        size_t value = 0;
        for (const uint8_t byte : take(bytes)) value = value << 8 | byte;
        return value;
    }
    /// What stands behind a length of so many bytes.
    Reader vector(size_t length_bytes) { return Reader(take(number(length_bytes))); }
    std::vector<uint16_t> words() {
        std::vector<uint16_t> all;
        while (!empty()) all.push_back(static_cast<uint16_t>(number(2)));
        return all;
    }

private:
    std::span<const uint8_t> bytes_;
};

void read_extensions(Reader extensions, TlsHello& hello) {
    while (!extensions.empty()) {
        const size_t kind = extensions.number(2);
        Reader body = extensions.vector(2);
        if (kind == supported_groups) hello.groups = body.vector(2).words();
        if (kind == supported_versions) hello.versions = body.vector(1).words();
        if (kind == early_data) hello.early_data = true;
        if (kind != alpn) continue;
        for (Reader names = body.vector(2); !names.empty();) {
            const size_t length = names.number(1);
            const auto name = names.take(length);
            hello.protocols.emplace_back(name.begin(), name.end());
        }
    }
}

TlsHello read(std::span<const uint8_t> payload) {
    constexpr size_t version_and_random = 2 + 32;
    TlsHello hello;
    hello.bytes = payload.size();
    Reader record(payload);
    if (record.number(1) != client_hello) throw Failed{"R-106: the first record is no ClientHello"};
    const size_t length = record.number(3);
    constexpr size_t head = 4;
    if (length > payload.size() - head)
        throw Failed{fmt::format(
            "R-106: the ClientHello is not whole in its first record: {} of its {} bytes are there",
            payload.size() - head, length)};
    Reader body(record.take(length));
    body.take(version_and_random);
    body.vector(1);  // session
    body.vector(2);  // ciphers
    body.vector(1);  // compression
    if (!body.empty()) read_extensions(body.vector(2), hello);
    return hello;
}

template <class T>
bool has(const std::vector<T>& list, const T& wanted) {
    return std::find(list.begin(), list.end(), wanted) != list.end();
}

}  // namespace

size_t tls_record_bytes(std::span<const uint8_t> header) {
    return static_cast<size_t>(header[3]) << 8 | header[4];
}

TlsHello judge_tls_hello(std::span<const uint8_t> record) {
    constexpr size_t most = 4091;
    if (record[0] != tls_handshake_record)
        throw Failed{fmt::format("R-104: the stream begins with {:02x}, TLS with {:02x}", record[0],
                                 tls_handshake_record)};
    if (const size_t bytes = tls_record_bytes(record); bytes > most)
        throw Failed{
            fmt::format("R-106: the ClientHello's record has {} bytes, {} are allowed", bytes, most)};
    TlsHello hello = read(record.subspan(tls_record_header_bytes, tls_record_bytes(record)));
    if (!has(hello.versions, tls_1_3)) throw Failed{"R-106: the ClientHello does not offer TLS 1.3"};
    if (!has(hello.groups, group_p_256) && !has(hello.groups, group_x25519))
        throw Failed{"R-106: the ClientHello offers neither X25519 nor P-256"};
    if (hello.early_data) throw Failed{"R-106: the ClientHello announces early data"};
    if (!hello.protocols.empty() && !has<std::string>(hello.protocols, "trochoid") &&
        !has<std::string>(hello.protocols, "http/1.1"))
        throw Failed{
            fmt::format("R-106: the ClientHello names {} by ALPN", fmt::join(hello.protocols, ", "))};
    return hello;
}

std::string text_of(const TlsHello& hello) {
    return fmt::format(
        "a ClientHello of {} bytes: versions {:04x}, groups {:x}, ALPN {}", hello.bytes,
        fmt::join(hello.versions, " "), fmt::join(hello.groups, " "),
        hello.protocols.empty() ? "nothing" : fmt::format("{}", fmt::join(hello.protocols, ", ")));
}

}  // namespace trochoid::conformance
