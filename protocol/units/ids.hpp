#pragma once
#include <array>
#include <compare>
#include <cstdint>

namespace trochoid {

/// Id of a wave train. Ids are never reused within a world instance; 0 means none. The sum runs in ascending order.
struct TrainId {
    uint32_t value = 0;
    auto operator<=>(const TrainId&) const = default;
};

/// Id of a wave train box (WTB). Boxes in ascending id hold trains in ascending id.
struct BoxId {
    uint32_t value = 0;
    auto operator<=>(const BoxId&) const = default;
};

/// Id of a land field (phase shift and gain on nodes), one per box and band.
struct FieldId {
    uint32_t value = 0;
    auto operator<=>(const FieldId&) const = default;
};

/// 128 bits that name one life of a world; clients drop their store when it changes.
struct WorldInstance {
    std::array<uint8_t, 16> bytes{};
    auto operator<=>(const WorldInstance&) const = default;
};

/// Position in the event log: the number of events before it.
struct LogPosition {
    uint64_t value = 0;
    auto operator<=>(const LogPosition&) const = default;
};

}  // namespace trochoid
