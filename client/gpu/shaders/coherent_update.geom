// One pass of the coherent tessellation (paper D, 3.2 and 3.3): a triangle of the last mesh becomes its part of the next one, finer or
// coarser by any number of levels. The mesh that an eye wants is a pure function of the eye: refined from the base until no edge
// wants more. So a triangle looks for the highest triangle above it that would now be divided another way. If there is none it
// stays, and is refined further; if there is one, that triangle's first descendant makes it anew and the others go.
#include "frame.glsl"
#include "spacing.glsl"
#include "coherent.glsl"
layout(points) in;
layout(points, max_vertices = MOST_POINTS) out;
in Record {
    ivec3 x;
    ivec3 z;
    uvec2 identity;
    uvec2 path;
} record[];

layout(stream = 0) out ivec2 corner_a;
layout(stream = 0) out ivec2 corner_b;
layout(stream = 0) out ivec2 corner_c;
layout(stream = 0) out uvec2 identity;
layout(stream = 0) out uvec2 path;
layout(stream = 1) out float unfinished;  // a point for each triangle that had to be left too coarse: another pass is needed

uniform ivec2 moved;  // the mesh's last origin relative to this one, lattice units

const int most_records = MOST_RECORDS;
const int most_levels = 22;       // P of more would not fit
const int half_side = 4 << 24;  // of the base mesh, lattice units

bool inside_window(Triangle t) {
    // The middle lies inside of the triangle's cell.
    return max(abs(t.x.x + t.x.y + t.x.z), abs(t.z.x + t.z.y + t.z.z)) < 3 * half_side;
}

/// Where this triangle's part of the new mesh begins; false if it has none.
bool begin_of(inout Triangle t) {
    Triangle above = t;
    bool first = true;  // child of all
    bool mine = true;
    while (!is_root(above)) {
        int divided, number;
        above = parent(above, divided, number);
        first = first && number == 0;
        bool clear;
        if (pattern_of(above, clear) != divided) {
            t = above;
            mine = first;
        }
        // All that is above a triangle with edges far too long was divided by pattern 1, and still is.
        if (clear && above.path == ones[level_of(above.identity)]) break;
    }
    return mine;
}

void emit(Triangle t) {
    corner_a = ivec2(t.x.x, t.z.x);
    corner_b = ivec2(t.x.y, t.z.y);
    corner_c = ivec2(t.x.z, t.z.z);
    identity = t.identity;
    path = t.path;
    EmitStreamVertex(0);
    EndStreamPrimitive(0);
}

void main() {
    Triangle t = Triangle(record[0].x + moved.x, record[0].z + moved.y, record[0].identity, record[0].path);
    if (!inside_window(t)) return;
    Triangle start = t;
    if (!begin_of(start)) return;
    // Depth first without a stack: the way back is in the numbers. `spread` triangles at most if all are divided as the path to
    // this one was, so that no branch takes the room of another.
    int level = level_of(start.identity);
    int depth = 0;
    int spread = 1;
    bool cut_short = false;
    t = start;
    for (;;) {
        bool clear;
        int pattern = level + depth < most_levels ? pattern_of(t, clear) : 0;
        int children = children_of(pattern);
        if (pattern != 0 && spread * children <= most_records) {
            t = child(t, pattern, 0);
            spread *= children;
            ++depth;
            continue;
        }
        cut_short = cut_short || pattern != 0;
        emit(t);
        int divided = 0;
        int number = 0;
        while (depth > 0) {
            t = parent(t, divided, number);
            --depth;
            spread /= children_of(divided);
            if (number + 1 < children_of(divided)) break;
            divided = 0;
        }
        if (divided == 0) break;
        t = child(t, divided, number + 1);
        spread *= children_of(divided);
        ++depth;
    }
    if (cut_short) {
        unfinished = 1.0;
        EmitStreamVertex(1);
        EndStreamPrimitive(1);
    }
}
