#pragma once
#include <cstddef>

namespace trochoid {

/// Bytes that operator new has given to this thread since the meter was made; what was freed meanwhile counts too.
class AllocationMeter {
public:
    AllocationMeter();
    size_t bytes() const;

private:
    size_t before_;
};

}  // namespace trochoid
