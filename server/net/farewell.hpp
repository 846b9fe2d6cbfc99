#pragma once
#include <fmt/format.h>

#include "protocol/units/hash.hpp"
#include "protocol/wire/session_rules.hpp"
#include "server/net/monotonic.hpp"

// What is said to those who may come back.
namespace trochoid {

/// A goodbye with a retry time of one to three seconds that differs from one to the next (`id`), so that not all come back at once.
inline Goodbye farewell(const Error& error, uint64_t id) {
    Goodbye goodbye = goodbye_for(error);
    goodbye.retry = true;
    goodbye.retry_after_ms =
        static_cast<uint32_t>(1000 + splitmix64(id ^ static_cast<uint64_t>(monotonic_us())) % 2000);
    return goodbye;
}

inline Error shutting_down() {
    return {ErrorCode::shutting_down, "this server is shutting down: connect again later"};
}

inline Error hello_came_late(const Limits& limits) {
    return {ErrorCode::hello_deadline,
            fmt::format("no hello within {} ms: send it right after connecting", limits.hello_deadline_ms)};
}

}  // namespace trochoid
