#pragma once

namespace trochoid {

/// How a gravity wave of fixed frequency changes over depth D, omega^2 = g k tanh(k D) (paper A, eq. 4 without its change of
/// frequency), as functions of deep_kd = k0 D in radians with k0 = omega^2 / g. Looked up by linear interpolation in a table
/// made once with + - * / alone (tanh by its continued fraction), so equal on every machine.
/// Valid for deep_kd > 0; 2 pi and beyond is deep water: both ratios are the ones at 2 pi.

/// k(D) / k0, 1 in deep water; relative error below 2e-6 (tested against libm).
double wave_number_ratio(double deep_kd);

/// Linear shoaling sqrt(cg0 / cg(D)), relative error below 5e-6; at least 0.913 (at deep_kd near 1).
double shoaling_ratio(double deep_kd);

/// tanh x for x >= 0, relative error below 1e-14; 1 from 20 on.
double tanh_of(double x);

/// 2 pi; where deep_kd reaches it the depth is one wave length.
inline constexpr double two_pi_f64 = 0x1.921fb54442d18p+2;

}  // namespace trochoid
