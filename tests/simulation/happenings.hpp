#pragma once
#include <cstdint>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {

class Dice {
public:
    explicit Dice(uint64_t seed) : state_(splitmix64(seed)) {}
    uint64_t next() { return state_ = splitmix64(state_); }
    uint64_t below(uint64_t end) { return next() % end; }
    int64_t between(int64_t least, int64_t most) {
        return least + static_cast<int64_t>(below(static_cast<uint64_t>(most - least + 1)));
    }
    bool one_in(uint64_t count) { return below(count) == 0; }

private:
    uint64_t state_;
};

/// Something that an admin may ask for, which may be refused: winds, ships, courses, ends, the land, the rate of time, a skip.
decltype(Command::action) some_command(Dice& dice, const std::vector<BoxId>& boxes, bool land);

/// One to three discs about the middle of the world.
std::vector<SyncRegion> some_regions(Dice& dice);

}  // namespace trochoid
