#include "server/world/integer_math.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>

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

}  // namespace

double natural_log(double x) {
    TROCHOID_ASSERT(x > 0.0, "logarithm of {}", x);
    return static_cast<double>(wide_log(x));
}

double cube_root(double x) {
    TROCHOID_ASSERT(x > 0.0, "cube root of {}", x);
    const Wide third = wide_log(x) / 3;
    Wide result;
    mp::default_ops::eval_exp(result.backend(), third.backend());
    return static_cast<double>(result);
}

double sine_of_half_turns(double x) { return static_cast<double>(wide_sine(wide_pi() * x)); }

HeadingVector heading_vector(double degrees) {
    const Wide radians = Wide(degrees) * wide_pi() / 180;
    return {static_cast<double>(wide_sine(radians)), static_cast<double>(-wide_cosine(radians))};
}

}  // namespace trochoid
