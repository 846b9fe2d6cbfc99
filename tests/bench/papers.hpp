#pragma once
#include "tests/bench/report.hpp"

// P9: tables of the papers that the project follows, ours on the GPU beside theirs. Their figures are copied from the texts; what a
// paper shows only as a drawing is measured without theirs beside it.
namespace trochoid::bench {

/// Tables 1 and 2: times of the wave calculation by grid, boxes in view and effects, with the uniform mesher.
void paper_a(Report& report);
/// Section 5: trains evaluated a vertex, frame rates by screen grid, the cost against a Fourier transform.
void paper_b(Report& report);
/// Figures 3, 8 and 9: frame rate by number of waves, and the three methods.
void paper_c(Report& report);
/// Tables 2 and 3: gradient noise against a Fourier transform, frame rates by triangles.
void paper_d(Report& report);

}  // namespace trochoid::bench
