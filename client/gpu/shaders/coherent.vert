// A corner of a triangle of the coherent mesh, fetched by the vertex's number.
#include "frame.glsl"
#include "spacing.glsl"
#include "surface.glsl"
#include "patch_directory.glsl"
#include "coherent_corner.glsl"

void main() {
    ivec2 place = corner_place();
    emit_surface(place, list_at(place), shown_spacing(place) * coarser, 0);
}
