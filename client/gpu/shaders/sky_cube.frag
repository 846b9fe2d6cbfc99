// The sky that the sea reflects: clear sky, overcast and clouds, without the sun's disc.
#include "frame.glsl"
#include "sky.glsl"
#include "noise.glsl"
#include "clouds.glsl"
in vec3 direction;
out vec4 colour;

void main() {
    vec3 d = normalize(direction);
    // Just below the horizon too it is sky: waves lean, and mean levels of the map reach over it.
    vec4 cloud = clouds(normalize(vec3(d.x, max(d.y, 0.0), d.z)), 3);
    vec3 sky = sky_without_clouds(d);
    colour = vec4(min(sky * (1.0 - cloud.a) + cloud.rgb, vec3(60000.0)), 1.0);
}
