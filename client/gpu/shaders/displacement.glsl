// What displaces the surface (Displacement of draw_options.hpp): leaves sum_a, sum_b, sum_m and the variances as sum_sea does.
#include "sea.glsl"

const int displacement_trains = 0;
const int displacement_noise = 1;
const int displacement_fft = 2;

void displace(int list, ivec2 place, float spacing) { sum_sea(list, place, spacing); }
