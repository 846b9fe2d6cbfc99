#include <algorithm>

#include "tests/fuzz/fuzz_target.hpp"

// A fuzzer for one target: TROCHOID_FUZZ_TARGET, which CMake sets.

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t most);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    trochoid::TROCHOID_FUZZ_TARGET.run({data, size});
    return 0;
}

/// Half by what the target knows of its inputs, half by libFuzzer, and of those most with checksums that fit.
extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t most, unsigned int seed) {
    const trochoid::FuzzTarget& target = trochoid::TROCHOID_FUZZ_TARGET;
    trochoid::Dice dice(seed);
    if (target.mutate != nullptr && dice.coin()) {
        const trochoid::Bytes out = target.mutate(trochoid::Bytes(data, data + size), dice, most);
        if (!out.empty() && out.size() <= most) {
            std::copy(out.begin(), out.end(), data);
            return out.size();
        }
    }
    const size_t changed = LLVMFuzzerMutate(data, size, most);
    if (target.repair != nullptr && dice.between(0, 3) != 0) target.repair({data, changed});
    return changed;
}
