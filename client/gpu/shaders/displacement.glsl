// What displaces the surface (Displacement of draw_options.hpp): leaves sum_a, sum_b, sum_m and the variances as sum_sea does.
#include "sea.glsl"
#include "other_seas.glsl"

const int displacement_noise = 1;
const int displacement_fft = 2;

/// Of FarMethod: the normal map alone, without any sum.
const int far_method_texture = 2;

void displace(int list, ivec2 place, float spacing) {
    if (choice.y == far_method_texture) {
        still_sea(sea_state.x);
        return;
    }
    if (choice.x != displacement_noise && choice.x != displacement_fft) {
        sum_sea(list, place, spacing);
        return;
    }
    clear_sums();
    if (choice.x == displacement_noise)
        sum_noise(place, spacing);
    else
        sum_fft(place, spacing);
}
