#pragma once

/// The same grid by the same sources, but compiled with -march=native and for that one instruction set, in a namespace of
/// its own: what runtime dispatch is compared with. Prepares once; evaluates the grid and returns the sum of its heights.
extern "C" double trochoid_native_grid(int trains, int points_per_side);
