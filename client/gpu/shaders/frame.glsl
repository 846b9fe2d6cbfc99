// What every shader knows of the frame. Mirrors FrameUniforms in frame_uniforms.hpp (std140).
layout(std140) uniform Frame {
    mat4 clip_from_camera;   // from metres relative to the camera, axes of the world (x east, y up, z south)
    mat4 camera_from_clip;
    ivec4 camera_cell;       // xy: camera relative to the anchor; zw: low 32 bits of the anchor; lattice units
    vec4 camera_eye;         // xy: fraction of the cell, lattice units; z: altitude, m; w: 1 / (2 R), 1/m
    ivec4 mesh_cell;         // xy: as camera_cell, of the eye that the mesh is made for; z: layers (Layer of sea.hpp)
    vec4 mesh_eye;           // as camera_eye
    vec4 mesh_filter;        // finest vertex spacing, m; spacing over distance; 1 = authoritative (nothing fades)
    vec4 sun;                // unit vector towards the sun
    vec4 bed_transform;      // metres from the anchor to texture coordinates: xy scale, zw offset
    vec4 ripple_axes;        // directions of travel (x, z): xy of the finest and the coarsest ripples, zw of those between
    vec4 scroll;             // how far three layers of ripples have travelled along, tiles; w: all of them across
    vec4 picture;            // angle of a pixel, rad; haze, 1/m; sea time modulo 4096 s; metres that clouds have drifted
    vec4 foam;               // Jacobian below which foam starts; depth in m up to which surf breaks; open sea's bed, m; belt in
                             // which the bed falls to it outside the raster, m
    ivec4 choice;            // Displacement, FarMethod, Refinement of draw_options.hpp; 1 = the share of foam is drawn
    vec4 wind;               // direction of travel (x, z); speed at 10 m, m/s; hour of the day
    vec4 mesh_sides[4];      // of the view that the mesh is made for: inward normal and offset, m from its eye
    vec4 sun_light;          // irradiance of sun or moon across its rays; w: exposure
    vec4 sky_ambient;        // irradiance of the sky on a level plane, over pi; w: 1 = only the moon shines
    vec4 overcast;           // radiance of a closed cloud cover overhead; w: its share of the sky
    vec4 sea_state;          // at the camera: slope variance of all trains, of what ripples add to it; whitecaps' share of the
                             // sea as a quantile of the normal distribution; standard deviation of its Jacobian
    vec4 foam_map_place;     // middle of the foam map, m from the anchor (xy); its side, m, 0 = none; seconds since its update
};

const float lattice_unit = 0.0009765625;  // 2^-10 m

/// Metres from the camera to a lattice place at a height, on a flat sea.
vec3 from_camera(ivec2 place, float height) {
    vec2 units = vec2(place - camera_cell.xy) - camera_eye.xy;
    return vec3(units.x * lattice_unit, height - camera_eye.z, units.y * lattice_unit);
}

/// The display's curvature: y -= d^2 / (2 R).
vec3 curved(vec3 p) { return vec3(p.x, p.y - dot(p.xz, p.xz) * camera_eye.w, p.z); }
