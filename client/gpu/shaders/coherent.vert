// A corner of a triangle of the coherent mesh, fetched by the vertex's number.
#include "frame.glsl"
#include "spacing.glsl"
#include "surface.glsl"
#include "patch_directory.glsl"
#include "coherent_corner.glsl"

void main() {
#ifndef TROCHOID_PROBE
    // What is not seen costs no sum.
    if (out_of_view(0.0)) {
        leave_out();
        return;
    }
#endif
    ivec2 place = corner_place();
    emit_surface(place, list_at(place), shown_spacing(place) * coarser, 0);
}
