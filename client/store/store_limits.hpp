#pragma once
#include <cstddef>

namespace trochoid {

/// What a client holds of a sea at most, whatever a server sends; beyond it the session ends with too_much_land: the server has
/// broken nothing, this client asks for more than it can hold. A server's own limits (Limits in its hello) count besides.
/// While a result replaces another both are held: twice as much for a moment.
struct StoreLimits {
    /// Look-up slots over the windows of all land fields, 16 bytes each: 256 MiB. A field's window is the bounding rectangle of its
    /// blocks, so two blocks far apart cost as much as all between them.
    size_t land_slots = size_t{1} << 24;
    /// Land blocks, 2.3 KiB each: 2.3 GiB. Forty winds over a coast in eight wide sync regions take a quarter of it.
    size_t land_blocks = size_t{1} << 20;
    bool operator==(const StoreLimits&) const = default;
};

}  // namespace trochoid
