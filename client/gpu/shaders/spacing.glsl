// Vertex spacing and edge levels; twin of client/scene/edge_level.hpp and protocol/model/displayed.hpp.

const int refinement_screen = 1;   // Refinement of draw_options.hpp
const int refinement_frustum = 2;
const float least_foreshortening = 0.5;
const float spacing_outside_view = 0.125;

/// Metres along x and z from the eye that the mesh is made for to a place relative to the anchor.
vec2 from_mesh_eye(ivec2 place) {
    precise float dx = (float(place.x - mesh_cell.x) - mesh_eye.x) * lattice_unit;
    precise float dz = (float(place.y - mesh_cell.y) - mesh_eye.y) * lattice_unit;
    return vec2(dx, dz);
}

/// Wanted vertex spacing in metres at a place of the still water, by the distance alone.
float sea_spacing(ivec2 place) {
    precise vec2 d = from_mesh_eye(place);
    precise float distance = sqrt((d.x * d.x + d.y * d.y) + mesh_eye.z * mesh_eye.z);
    precise float by_angle = distance * mesh_filter.y;
    return by_angle > mesh_filter.x ? by_angle : mesh_filter.x;
}

/// The same by the criterion in force: outside of the view it grows with the distance from the view.
float mesh_spacing(ivec2 place) {
    precise float spacing = sea_spacing(place);
    if (choice.z != refinement_frustum) return spacing;
    precise vec2 d = from_mesh_eye(place);
    precise float inside = 0.0;
    for (int i = 0; i < 4; ++i) {
        precise float from_side = (mesh_sides[i].x * d.x + mesh_sides[i].z * d.y) +
                                  (mesh_sides[i].w - mesh_sides[i].y * mesh_eye.z);
        inside = min(inside, from_side);
    }
    precise float outside = -inside * spacing_outside_view;
    return max(spacing, outside);
}

/// Square of an edge's length in metres as the criterion sees it: on the screen, the part across the line of sight. The edge in
/// lattice units, and its middle.
float mesh_length2(ivec2 middle, ivec2 edge) {
    precise float x = float(edge.x) * lattice_unit;
    precise float z = float(edge.y) * lattice_unit;
    precise float whole = x * x + z * z;
    if (choice.z != refinement_screen) return whole;
    precise vec2 d = from_mesh_eye(middle);
    precise float along = x * d.x + z * d.y;
    precise float distance2 = (d.x * d.x + d.y * d.y) + mesh_eye.z * mesh_eye.z;
    precise float across = whole - along * along / distance2;
    precise float least = whole * (least_foreshortening * least_foreshortening);
    return max(across, least);
}

/// Spacing that the displayed waves at a place are chosen for: nowhere finer than the mesh.
float shown_spacing(ivec2 place) {
    if (choice.z != refinement_screen) return mesh_spacing(place);
    precise vec2 d = from_mesh_eye(place);
    precise float height2 = mesh_eye.z * mesh_eye.z;
    precise float share = sqrt(height2 / ((d.x * d.x + d.y * d.y) + height2));
    precise float spacing = sea_spacing(place) / max(share, least_foreshortening);
    return spacing;
}

/// Segments of an edge from a place, `side` lattice units along x or z: 2 to 64, a power of two.
int edge_level(ivec2 start, bool along_x, int side) {
    int half_side = side >> 1;
    ivec2 middle = start + (along_x ? ivec2(half_side, 0) : ivec2(0, half_side));
    precise float length = float(side) * lattice_unit;
    if (choice.z == refinement_screen) length = sqrt(mesh_length2(middle, along_x ? ivec2(side, 0) : ivec2(0, side)));
    precise float wanted = length / mesh_spacing(middle);
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

#ifdef UNEVEN_STEPS
// A mesh whose cells may be far longer than wide says how its vertices lie, before anything is summed; twin of VertexSteps in
// client/scene/projected_grid.hpp.
vec2 step_along;      // to the next vertices, m along x and z
vec2 step_across;
float least_spacing;  // whatever the direction, m: that of what the server sends

/// Spacing in metres that a wave is filtered by: as far as vertices are apart along its own direction, so that waves which run
/// across long cells stay. The wave turns by k (rad/m) and dies away like waves of `fall`; of isotropic meshes `spacing`.
float wave_spacing(vec2 k, vec2 fall, float wavelength, float spacing) {
    vec4 turned = vec4(dot(k, step_along), dot(k, step_across), dot(fall, step_along), dot(fall, step_across));
    return max(wavelength * length(turned) * 0.15915494, least_spacing);
}

/// Least and most that wave_spacing can be, whatever the direction.
vec2 spacing_limits(float spacing) {
    float squares = dot(step_along, step_along) + dot(step_across, step_across);
    float area = step_along.x * step_across.y - step_along.y * step_across.x;
    float most = sqrt(max(0.5 * (squares + sqrt(max(squares * squares - 4.0 * area * area, 0.0))), 1e-12));
    return max(vec2(abs(area) / most, most), least_spacing);
}

/// Whether a shorter wave than one without a share may have one.
bool shorter_may_show(float wavelength, float shortest) { return wavelength > 2.0 * shortest; }
#else
float wave_spacing(vec2 k, vec2 fall, float wavelength, float spacing) { return spacing; }
vec2 spacing_limits(float spacing) { return vec2(spacing); }
bool shorter_may_show(float wavelength, float shortest) { return false; }
#endif

/// Share of a train of this wavelength that is displayed at a vertex spacing, both in metres.
float displayed_weight(float wavelength, float spacing) {
    float t = clamp((wavelength / spacing - 2.0) / 2.0, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}
