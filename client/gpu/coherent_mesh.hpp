#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "client/gpu/gl_objects.hpp"
#include "client/gpu/shader_program.hpp"
#include "client/scene/coherent_tree.hpp"
#include "client/scene/edge_level.hpp"

namespace trochoid {

/// What bringing a mesh up to date took.
struct CoherentWork {
    uint32_t triangles = 0;  ///< that it has now
    uint32_t passes = 0;     ///< over all triangles; 0 where the eye is as before
    bool from_base = false;  ///< made anew
    bool operator==(const CoherentWork&) const = default;
};

/// Paper D's mesh (section 3): triangles that stay in GPU memory between frames and are refined and coarsened by a geometry shader
/// with transform feedback. After update() the mesh is what the eye wants, to the last triangle, so it has no cracks;
/// whatever it was before.
class CoherentMesh {
public:
    CoherentMesh();

    /// Brings the mesh to what the eye wants; `anchor` is what the eye's cell is relative to. The Frame block with this eye must
    /// be bound. Of more triangles than `most_triangles` all are made coarser alike. Leaves program, layout and
    /// transform feedback binding changed.
    CoherentWork update(LatticePoint anchor, const MeshEye& eye, uint32_t most_triangles);
    /// Lists what may lie inside a view's planes (relative to the eye of the last update()) where the surface moves by up to
    /// `reach_m`, with the same Frame block; what is left out costs no vertex. The mesh itself stays as it is.
    void list_visible(LatticePoint anchor, const FrustumPlanes& planes, float reach_m);
    /// Number of triangles listed; waits for the GPU the first time.
    uint32_t visible();

    /// The next update starts from the base mesh.
    void forget() { count_ = 0; }

    uint32_t triangles() const { return count_; }
    LatticePoint origin() const { return window_.origin(); }
    const CoherentWindow& window() const { return window_; }
    /// The wanted spacing is multiplied by this so that the mesh fits.
    float coarser() const { return coarser_; }
    /// Bytes that its buffers hold.
    size_t bytes() const {
        return (stores_[0].capacity + stores_[1].capacity) * sizeof(CoherentTriangle) + list_capacity_ * 24;
    }

    /// Binds the listed triangles for shaders/coherent_corner.glsl; `program` is current.
    void bind_triangles(const ShaderProgram& program, LatticePoint anchor) const;
    /// Reads them back: for tests, slow.
    std::vector<CoherentTriangle> read() const;

private:
    struct Store {
        GlBuffer buffer;
        GlVertexArray layout;
        size_t capacity = 0;  // triangles
    };
    struct Eye {
        LatticePoint anchor;
        MeshEye eye;
        bool same_as(const Eye& other) const;
        /// Whether the other wants the same mesh: where it looks matters by the frustum only.
        bool same_mesh_as(const Eye& other) const;
    };
    struct Pass {
        bool overflowed = false;
        bool finished = false;
        uint32_t written = 0;
    };
    static void attach(const Store& store);
    static void reserve(Store& store, size_t triangles);
    void reserve_list(size_t triangles);
    static size_t most_capacity();
    void take_window(LatticePoint eye);
    uint32_t converge(const Eye& now, uint32_t most_triangles);
    static bool is_cut(const Eye& from, const Eye& to);
    Pass run_pass(const ShaderProgram& program);

    ShaderProgram going_on_;
    ShaderProgram from_base_;  // the same with more room to emit
    std::array<Store, 2> stores_;
    ShaderProgram cull_;
    GlBuffer list_;  // corners of what is seen
    GlTexture list_texels_;
    size_t list_capacity_ = 0;         // triangles
    std::optional<uint32_t> visible_;  // in the list; unknown until the GPU has told
    std::optional<Eye> listed_for_;
    FrustumPlanes listed_{};    // moved outwards by the surface's reach
    Store fresh_;               // base triangles that a moved window brings in
    uint32_t fresh_count_ = 0;  // of them
    size_t current_ = 0;        // which store holds the mesh
    uint32_t count_ = 0;
    CoherentWindow window_;
    glm::ivec2 moved_{0};  // of the window, lattice units, not yet applied to the stored triangles
    std::optional<Eye> made_for_;
    float coarser_ = 1.0F;
    std::array<GLuint, 4> queries_{};

public:
    CoherentMesh(const CoherentMesh&) = delete;
    CoherentMesh& operator=(const CoherentMesh&) = delete;
    ~CoherentMesh();
};

}  // namespace trochoid
