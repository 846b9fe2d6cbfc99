#include "tests/support/net/chaos_schedule.hpp"

#include "protocol/units/hash.hpp"

namespace trochoid {

namespace {

/// Dice of one connection: each throw the next of a row of its own.
class Dice {
public:
    Dice(uint64_t seed, uint64_t number) : state_(splitmix64(splitmix64(seed) ^ number)) {}
    /// 0 to below `end`, which is above 0.
    uint64_t below(uint64_t end) { return (state_ = splitmix64(state_)) % end; }
    bool in_a_thousand(uint32_t share) { return below(1000) < share; }

private:
    uint64_t state_;
};

}  // namespace

ConnectionFaults faults_of(const ChaosSchedule& schedule, uint64_t number) {
    ConnectionFaults faults = schedule.always;
    if (number >= schedule.spared_from) return faults;
    Dice dice(schedule.seed, number);
    const auto direction = [&]() -> LinkFaults& { return dice.below(2) == 0 ? faults.up : faults.down; };
    if (dice.in_a_thousand(schedule.stalls))
        direction().stall =
            Stall{dice.below(schedule.within),
                  1 + static_cast<int64_t>(dice.below(static_cast<uint64_t>(schedule.longest_stall_us) + 1))};
    if (dice.in_a_thousand(schedule.cuts))
        direction().cut = Cut{dice.below(schedule.within), static_cast<CutKind>(dice.below(3))};
    if (dice.in_a_thousand(schedule.flips))
        direction().flips = {Flip{dice.below(schedule.within), static_cast<uint8_t>(1U << dice.below(8))}};
    if (dice.in_a_thousand(schedule.delays)) {
        const auto most = static_cast<uint64_t>(schedule.longest_delay_us) + 1;
        faults.up.delay_us += static_cast<int64_t>(dice.below(most));
        faults.down.delay_us += static_cast<int64_t>(dice.below(most));
    }
    return faults;
}

}  // namespace trochoid
