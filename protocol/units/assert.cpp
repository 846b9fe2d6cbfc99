#include "protocol/units/assert.hpp"

#include <cstdio>
#include <cstdlib>

namespace trochoid {

void assertion_failed(std::string_view expression, std::string_view operands, const char* file, int line) {
    fmt::print(stderr, "trochoid: assertion failed: {} ({}) at {}:{}\n", expression, operands, file, line);
    std::fflush(stderr);
    std::abort();
}

}  // namespace trochoid
