#include "server/world/integer_math.hpp"

#include <array>
#include <bit>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cstddef>
#include <cstdint>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

namespace mp = boost::multiprecision;
using Wide = mp::number<mp::cpp_bin_float<113, mp::digit_base_2>, mp::et_off>;

Wide wide_log(double x) {
    const Wide argument(x);
    Wide result;
    mp::default_ops::eval_log(result.backend(), argument.backend());
    return result;
}

Wide wide_exponential(const Wide& x) {
    Wide result;
    mp::default_ops::eval_exp(result.backend(), x.backend());
    return result;
}

Wide wide_sine(const Wide& radians) {
    Wide result;
    mp::default_ops::eval_sin(result.backend(), radians.backend());
    return result;
}

Wide wide_cosine(const Wide& radians) {
    Wide result;
    mp::default_ops::eval_cos(result.backend(), radians.backend());
    return result;
}

/// pi to 40 digits; 113 bits hold 34.
const Wide& wide_pi() {
    static const Wide value("3.141592653589793238462643383279502884197");
    return value;
}

/// 2^(i/64), and ln 2 / 64 as a head of 32 bits (its products with whole numbers are exact) and a tail.
struct ExponentialTable {
    std::array<double, 64> roots{};
    double per_step = 0.0;
    double step_head = 0.0;
    double step_tail = 0.0;
};

const ExponentialTable& exponential_table() {
    static const ExponentialTable made = [] {
        ExponentialTable table;
        const Wide step = wide_log(2.0) / 64;
        for (size_t i = 0; i < table.roots.size(); ++i)
            table.roots[i] = static_cast<double>(wide_exponential(step * static_cast<int>(i)));
        table.per_step = static_cast<double>(1 / step);
        const auto head = std::bit_cast<uint64_t>(static_cast<double>(step)) & ~uint64_t{0x1fffff};
        table.step_head = std::bit_cast<double>(head);
        table.step_tail = static_cast<double>(step - Wide(table.step_head));
        return table;
    }();
    return made;
}

}  // namespace

double exponential(double x) {
    TROCHOID_ASSERT(x <= 700.0, "e^{}", x);
    if (x < -700.0) return 0.0;
    const ExponentialTable& table = exponential_table();
    const double scaled = x * table.per_step;
    const auto steps = static_cast<int64_t>(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
    const auto whole = static_cast<double>(steps);
    // |r| <= ln 2 / 128: the sixth power is below 2^-54.
    const double r = (x - whole * table.step_head) - whole * table.step_tail;
    const double tail = r * r * (0.5 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0))));
    const double root = table.roots[static_cast<size_t>(steps & 63)];
    const double fraction = root + root * (r + tail);
    const auto exponent = static_cast<uint64_t>((steps >> 6) + 1023) << 52;
    return fraction * std::bit_cast<double>(exponent);
}

double hyperbolic_tangent(double x) {
    TROCHOID_ASSERT(x >= 0.0, "tanh {}", x);
    if (x >= 22.0) return 1.0;
    if (x >= 0.5) return 1.0 - 2.0 / (exponential(2.0 * x) + 1.0);
    const double square = x * x;
    double fraction = 19.0;
    for (int odd = 17; odd >= 1; odd -= 2) fraction = static_cast<double>(odd) + square / fraction;
    return x / fraction;
}

double natural_log(double x) {
    TROCHOID_ASSERT(x > 0.0, "logarithm of {}", x);
    return static_cast<double>(wide_log(x));
}

double cube_root(double x) {
    TROCHOID_ASSERT(x > 0.0, "cube root of {}", x);
    return static_cast<double>(wide_exponential(wide_log(x) / 3));
}

double power(double x, double y) {
    TROCHOID_ASSERT(x > 0.0, "{} to the power {}", x, y);
    return static_cast<double>(wide_exponential(wide_log(x) * y));
}

double sine_of_half_turns(double x) { return static_cast<double>(wide_sine(wide_pi() * x)); }

double cosine_of_half_turns(double x) { return static_cast<double>(wide_cosine(wide_pi() * x)); }

HeadingVector heading_vector(double degrees) {
    const Wide radians = Wide(degrees) * wide_pi() / 180;
    return {static_cast<double>(wide_sine(radians)), static_cast<double>(-wide_cosine(radians))};
}

}  // namespace trochoid
