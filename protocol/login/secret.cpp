#include "protocol/login/secret.hpp"

#include <openssl/crypto.h>

namespace trochoid {

Secret::~Secret() { OPENSSL_cleanse(bytes_.data(), bytes_.size()); }

}  // namespace trochoid
