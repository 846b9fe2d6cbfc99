// Vertex spacing and edge levels; twin of client/scene/edge_level.hpp and protocol/model/displayed.hpp.

/// Wanted vertex spacing in metres at a place of the still water, relative to the anchor.
float sea_spacing(ivec2 place) {
    precise float dx = (float(place.x - mesh_cell.x) - mesh_eye.x) * lattice_unit;
    precise float dz = (float(place.y - mesh_cell.y) - mesh_eye.y) * lattice_unit;
    precise float distance = sqrt((dx * dx + dz * dz) + mesh_eye.z * mesh_eye.z);
    precise float by_angle = distance * mesh_filter.y;
    return by_angle > mesh_filter.x ? by_angle : mesh_filter.x;
}

/// Segments of an edge from a place, `side` lattice units along x or z: 2 to 64, a power of two.
int edge_level(ivec2 start, bool along_x, int side) {
    int middle = side >> 1;
    precise float wanted = (float(side) * lattice_unit) / sea_spacing(start + (along_x ? ivec2(middle, 0) : ivec2(0, middle)));
    int level = 2;
    for (int next = 2; next < 64; next *= 2)
        if (wanted >= float(next) * 1.41421354) level = next * 2;
    return level;
}

/// Where the neighbour is one level coarser, its edge decides: aligned and twice as long.
int halved_edge_level(ivec2 start, bool along_x, int side) {
    int absolute = along_x ? camera_cell.z + start.x : camera_cell.w + start.y;
    int back = (absolute & side) != 0 ? side : 0;
    return edge_level(start - (along_x ? ivec2(back, 0) : ivec2(0, back)), along_x, side * 2) / 2;
}

/// Share of a train of this wavelength that is displayed at a vertex spacing, both in metres.
float displayed_weight(float wavelength, float spacing) {
    float t = clamp((wavelength / spacing - 2.0) / 2.0, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}
