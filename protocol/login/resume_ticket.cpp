#include "protocol/login/resume_ticket.hpp"

#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/rand.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "protocol/login/byte_layout.hpp"
#include "protocol/login/login_token.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

using Cipher = std::unique_ptr<EVP_CIPHER_CTX, decltype(&EVP_CIPHER_CTX_free)>;
using Bytes = std::vector<uint8_t>;

// Authenticated with every ticket, with its zero byte.
constexpr std::string_view domain{"trochoid-ticket-v1\0", 19};

// A sealed ticket (protocol/README.md, "Login"): version, initialisation vector, sealed content, tag.
constexpr uint8_t layout_version = 1;
constexpr size_t at_vector = 1;
constexpr size_t vector_bytes = 12;
constexpr size_t at_content = at_vector + vector_bytes;
constexpr size_t tag_bytes = 16;

// Its content; integers least significant byte first, what is not named is 0.
constexpr size_t at_role = 0;
constexpr size_t at_session = 8;
constexpr size_t at_instance = 16;
constexpr size_t at_issued = 32;
constexpr size_t at_expiry = 40;
constexpr size_t at_nonce = 48;
constexpr size_t content_bytes = 64;
constexpr size_t at_tag = at_content + content_bytes;
constexpr size_t sealed_bytes = at_tag + tag_bytes;
static_assert(sealed_bytes == 93 && sealed_bytes <= longest_ticket);

Error refused(const char* sentence) { return {ErrorCode::token_refused, sentence}; }

const unsigned char* domain_bytes() { return reinterpret_cast<const unsigned char*>(domain.data()); }

Bytes content_of(const ResumeTicket& ticket) {
    Bytes content(content_bytes);
    content[at_role] = static_cast<uint8_t>(ticket.role);
    put_u64(content, at_session, ticket.session);
    put_array(content, at_instance, ticket.instance.bytes);
    put_u64(content, at_issued, ticket.issued.value);
    put_u64(content, at_expiry, ticket.expiry.value);
    put_array(content, at_nonce, ticket.nonce);
    return content;
}

ResumeTicket ticket_of(std::span<const uint8_t> content) {
    ResumeTicket ticket;
    ticket.role = static_cast<Role>(content[at_role]);
    ticket.session = u64_at(content, at_session);
    ticket.instance.bytes = array_at<16>(content, at_instance);
    ticket.issued = {u64_at(content, at_issued)};
    ticket.expiry = {u64_at(content, at_expiry)};
    ticket.nonce = array_at<16>(content, at_nonce);
    return ticket;
}

// Nothing where the tag is wrong.
std::optional<Bytes> opened(std::span<const uint8_t> sealed, std::span<const uint8_t> key) {
    const Cipher cipher(EVP_CIPHER_CTX_new(), EVP_CIPHER_CTX_free);
    Bytes content(content_bytes);
    Bytes tag(sealed.begin() + at_tag, sealed.end());
    int length = 0;
    const bool good = cipher &&
                      EVP_DecryptInit_ex2(cipher.get(), EVP_aes_256_gcm(), key.data(),
                                          sealed.data() + at_vector, nullptr) == 1 &&
                      EVP_DecryptUpdate(cipher.get(), nullptr, &length, domain_bytes(),
                                        static_cast<int>(domain.size())) == 1 &&
                      EVP_DecryptUpdate(cipher.get(), content.data(), &length, sealed.data() + at_content,
                                        static_cast<int>(content_bytes)) == 1 &&
                      EVP_CIPHER_CTX_ctrl(cipher.get(), EVP_CTRL_GCM_SET_TAG, static_cast<int>(tag_bytes),
                                          tag.data()) == 1 &&
                      EVP_DecryptFinal_ex(cipher.get(), content.data() + length, &length) == 1;
    ERR_clear_error();
    if (!good) return std::nullopt;
    return content;
}

std::optional<uint8_t> hex_digit(char digit) {
    if (digit >= '0' && digit <= '9') return static_cast<uint8_t>(digit - '0');
    if (digit >= 'a' && digit <= 'f') return static_cast<uint8_t>(digit - 'a' + 10);
    if (digit >= 'A' && digit <= 'F') return static_cast<uint8_t>(digit - 'A' + 10);
    return std::nullopt;
}

}  // namespace

TicketKey TicketKey::random() {
    Secret key(bytes);
    const int done = RAND_priv_bytes(key.bytes().data(), static_cast<int>(bytes));
    TROCHOID_ASSERT(done == 1, "OpenSSL gave no random bytes ({})", done);
    return TicketKey(std::move(key));
}

std::optional<TicketKey> TicketKey::from_hex(std::string_view digits) {
    if (digits.size() != 2 * bytes) return std::nullopt;
    Secret key(bytes);
    for (size_t i = 0; i < bytes; ++i) {
        const std::optional<uint8_t> high = hex_digit(digits[2 * i]);
        const std::optional<uint8_t> low = hex_digit(digits[2 * i + 1]);
        if (!high || !low) return std::nullopt;
        key.bytes()[i] = static_cast<uint8_t>((*high << 4) | *low);
    }
    return TicketKey(std::move(key));
}

std::vector<uint8_t> TicketKey::seal(const ResumeTicket& ticket) const {
    TROCHOID_ASSERT(ticket.role <= Role::admin, "a ticket for role {}", static_cast<int>(ticket.role));
    Bytes sealed(sealed_bytes);
    sealed[0] = layout_version;
    const int drawn = RAND_bytes(sealed.data() + at_vector, static_cast<int>(vector_bytes));
    TROCHOID_ASSERT(drawn == 1, "OpenSSL gave no random bytes ({})", drawn);
    const Bytes content = content_of(ticket);
    const Cipher cipher(EVP_CIPHER_CTX_new(), EVP_CIPHER_CTX_free);
    int length = 0;
    const bool done = cipher &&
                      EVP_EncryptInit_ex2(cipher.get(), EVP_aes_256_gcm(), key_.bytes().data(),
                                          sealed.data() + at_vector, nullptr) == 1 &&
                      EVP_EncryptUpdate(cipher.get(), nullptr, &length, domain_bytes(),
                                        static_cast<int>(domain.size())) == 1 &&
                      EVP_EncryptUpdate(cipher.get(), sealed.data() + at_content, &length, content.data(),
                                        static_cast<int>(content.size())) == 1 &&
                      EVP_EncryptFinal_ex(cipher.get(), sealed.data() + at_content + length, &length) == 1 &&
                      EVP_CIPHER_CTX_ctrl(cipher.get(), EVP_CTRL_GCM_GET_TAG, static_cast<int>(tag_bytes),
                                          sealed.data() + at_tag) == 1;
    TROCHOID_ASSERT(done, "OpenSSL did not seal {} bytes", content.size());
    return sealed;
}

Result<ResumeTicket> TicketKey::open(std::span<const uint8_t> sealed, const WorldInstance& instance,
                                     UnixSeconds now) const {
    const Error unknown = refused(
        "the resume ticket is not one that this server can open: connect without it, with a token if one is needed");
    if (sealed.size() != sealed_bytes || sealed[0] != layout_version) return unknown;
    const std::optional<Bytes> content = opened(sealed, key_.bytes());
    if (!content) return unknown;
    const ResumeTicket ticket = ticket_of(*content);
    const uint64_t most = latest_unix_second;
    if (ticket.role > Role::admin || ticket.issued.value > most || ticket.expiry.value > most) return unknown;
    if (ticket.instance != instance)
        return refused(
            "the resume ticket is of another life of the world: connect without it, with a token if one is needed");
    if (ticket.issued.value > now.value + clock_skew || now > ticket.expiry)
        return refused("the resume ticket has expired: connect without it, with a token if one is needed");
    return ticket;
}

}  // namespace trochoid
