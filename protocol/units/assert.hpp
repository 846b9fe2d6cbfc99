#pragma once
#include <fmt/format.h>

#include <string_view>

namespace trochoid {

/// Prints what failed with its operands and aborts. Stays on in the shipped programs: a wrong sea is worse than none.
[[noreturn]] void assertion_failed(std::string_view expression, std::string_view operands, const char* file,
                                   int line);

}  // namespace trochoid

/// Our own bug. The second argument onwards is a fmt format that prints the operands.
#define TROCHOID_ASSERT(condition, ...)                                                                      \
    do {                                                                                                     \
        if (!(condition)) [[unlikely]]                                                                       \
            ::trochoid::assertion_failed(#condition, ::fmt::format(__VA_ARGS__), __FILE__, __LINE__);        \
    } while (false)
