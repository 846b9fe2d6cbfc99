#pragma once
#include <array>
#include <map>
#include <memory>

#include "client/gpu/gl_objects.hpp"
#include "client/gpu/shader_program.hpp"
#include "client/scene/terrain_mesh.hpp"

namespace trochoid {

/// Terrain tiles as meshes; each tile's vertices are uploaded once and dropped when nobody draws it for a while.
class LandPass {
public:
    LandPass();
    void draw(const TerrainSelection& selection, const CameraFrame& frame, bool wireframe);
    size_t tiles_held() const { return tiles_.size(); }

private:
    struct Tile {
        GlVertexArray layout;
        GlBuffer vertices;
        std::shared_ptr<const TerrainTile> source;  // keeps the address from being reused
        uint64_t last_frame = 0;
    };
    struct Indices {
        GlBuffer buffer;
        GLsizei count = 0;
    };
    Tile& tile_of(const std::shared_ptr<const TerrainTile>& source);
    void drop_unused();

    ShaderProgram program_{"land.vert", "land.frag"};
    GLint tile_uniform_ = -1;
    GLint height_unit_uniform_ = -1;
    std::map<const TerrainTile*, std::unique_ptr<Tile>> tiles_;
    std::array<std::array<Indices, terrain_strides>, 4> indices_;
    uint64_t frame_ = 0;
};

}  // namespace trochoid
