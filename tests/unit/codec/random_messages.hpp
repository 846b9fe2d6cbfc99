#pragma once
#include <array>
#include <cstdint>

#include "protocol/codec/messages.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {

/// Seeded, the same on every machine.
class Dice {
public:
    explicit Dice(uint64_t seed) : state_(splitmix64(seed)) {}
    uint64_t bits() { return state_ = splitmix64(state_); }
    /// Uniform in [least, most].
    int64_t between(int64_t least, int64_t most) {
        return least + static_cast<int64_t>(bits() % static_cast<uint64_t>(most - least + 1));
    }
    template <class T>
    T any() {
        return static_cast<T>(bits());
    }
    float real(float least, float most) {
        return least + (most - least) * (static_cast<float>(bits() >> 40) * 0x1p-24F);
    }
    bool coin() { return (bits() & 1U) != 0; }

private:
    uint64_t state_;
};

/// Legal values of every message, most of their fields anywhere in their range.
ClientMessage random_client_message(Dice& dice, size_t index);
ServerMessage random_server_message(Dice& dice, size_t index);
LogEvent random_event(Dice& dice, size_t index);
inline constexpr size_t client_kinds = std::variant_size_v<ClientMessage>;
inline constexpr size_t server_kinds = std::variant_size_v<ServerMessage>;
inline constexpr size_t event_kinds = 5;

/// Half of them plain, half with some of all that a box may have besides.
WaveTrainBox random_box(Dice& dice, uint32_t id, size_t trains);
/// A ship's box: no trains, one leg along u, a wake.
WaveTrainBox random_ship(Dice& dice, uint32_t id);
LandBlock random_block(Dice& dice, BlockKey key);
InterestDelta random_change(Dice& dice, size_t boxes, size_t blocks, size_t patches, size_t removals);

/// Lets the patches travel as planes: they ascend by key, each once.
void set_planes(Delta& delta);

/// Equal down to what their pointers point to.
bool same(const InterestDelta& a, const InterestDelta& b);
bool same(const ServerMessage& a, const ServerMessage& b);

}  // namespace trochoid
