#include "tests/conformance/hostile.hpp"

namespace trochoid::conformance {

flatbuffers::uoffset_t misaligned_vector(Builder& b, size_t count, size_t words, size_t lead) {
    for (size_t i = 0; i < lead; ++i) b.PushElement<uint32_t>(0);
    b.StartVector(count * words, sizeof(uint32_t));
    for (size_t i = 0; i < count * words; ++i) b.PushElement<uint32_t>(0);
    return b.EndVector(count);
}

}  // namespace trochoid::conformance
