#include "protocol/login/nonce.hpp"

#include <openssl/rand.h>

#include "protocol/units/assert.hpp"

namespace trochoid {

Nonce random_nonce() {
    Nonce nonce{};
    const int done = RAND_bytes(nonce.data(), static_cast<int>(nonce.size()));
    TROCHOID_ASSERT(done == 1, "OpenSSL gave no random bytes ({})", done);
    return nonce;
}

}  // namespace trochoid
