#include "client/gpu/coherent_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace trochoid {

namespace {

static_assert(std::endian::native == std::endian::little, "shaders read the low word of I and P first");

/// Triangles that one may become in a pass: two levels of all edges, and some more; from the base three levels, which takes
/// fewer passes.
constexpr uint32_t most_records = 24;
constexpr uint32_t most_records_from_base = 64;
constexpr size_t least_capacity = 1U << 14;
/// Attributes of a record: three corners, I, P.
constexpr GLuint attributes = sizeof(CoherentTriangle) / 8;
/// A listed triangle: three RG32I texels.
constexpr size_t texels_a_triangle = 3;
constexpr size_t listed_bytes = texels_a_triangle * 8;

/// Steps by which a mesh that does not fit is made coarser.
constexpr float coarser_step = 1.25F;

ShaderProgramOptions update_options(uint32_t records) {
    return {{fmt::format("MOST_RECORDS {}", records), fmt::format("MOST_POINTS {}", records + 1)},
            {"corner_a", "corner_b", "corner_c", "identity", "path"}};
}

/// P after n times pattern 1, for each n.
std::array<uint32_t, 2 * (coherent_most_levels + 1)> ones() {
    std::array<uint32_t, 2 * (coherent_most_levels + 1)> words{};
    uint64_t path = 0;
    for (size_t i = 0; i < words.size(); i += 2) {
        words[i] = static_cast<uint32_t>(path);
        words[i + 1] = static_cast<uint32_t>(path >> 32U);
        path = path_of_child(path, 1);
    }
    return words;
}

/// Squared factor over the wanted length from which on a right triangle's ancestors are surely divided by pattern 1, too. An
/// ancestor's edge is L' >= sqrt(2) L, L the longest of the triangle's, and its middle at most 1.12 L' away; the spacing changes
/// by at most 1/8 a metre. So 2 spacings there are at most L / factor + 0.28 L', below L' from a factor of 1.01; on the screen,
/// where L' may count half, from 1.9.
float surely_divided(const MeshEye& eye) {
    if (eye.filter.angle_per_vertex > 0.05F) return 1e30F;
    return eye.refinement == Refinement::screen ? 4.0F : 1.5F;
}

glm::ivec2 difference(LatticePoint a, LatticePoint b) {
    return {static_cast<int32_t>(a.x - b.x), static_cast<int32_t>(a.z - b.z)};
}

}  // namespace

/// Whether so little stays that it costs less to begin at the base: the eye went farther than a quarter of its distance from where
/// the mesh is finest, or rose or sank by half.
bool CoherentMesh::is_cut(const Eye& from, const Eye& to) {
    const auto metres = [](int64_t units) { return static_cast<double>(units) / 1024.0; };
    const double x = metres(to.anchor.x + to.eye.cell.x - from.anchor.x - from.eye.cell.x);
    const double z = metres(to.anchor.z + to.eye.cell.y - from.anchor.z - from.eye.cell.y);
    const auto height = [](const Eye& e) {
        const double finest = e.eye.filter.angle_per_vertex > 0 ? double{e.eye.filter.finest_spacing} /
                                                                      double{e.eye.filter.angle_per_vertex}
                                                                : 1e9;
        return std::hypot(double{e.eye.altitude}, finest);
    };
    const double low = std::min(height(from), height(to));
    const double high = std::max(height(from), height(to));
    return std::hypot(x, z) > 0.25 * low || high > 1.5 * low;
}

bool CoherentMesh::Eye::same_mesh_as(const Eye& other) const {
    Eye there = other;
    if (eye.refinement != Refinement::frustum) there.eye.sides = eye.sides;
    return same_as(there);
}

bool CoherentMesh::Eye::same_as(const Eye& other) const {
    const auto place = [](const Eye& e) {
        return LatticePoint{e.anchor.x + e.eye.cell.x, e.anchor.z + e.eye.cell.y};
    };
    MeshEye there = other.eye;
    there.cell = eye.cell;
    return place(*this) == place(other) && there == eye;
}

CoherentMesh::CoherentMesh()
    : going_on_({"coherent_update.vert", "coherent_update.geom"}, update_options(most_records)),
      from_base_({"coherent_update.vert", "coherent_update.geom"}, update_options(most_records_from_base)),
      cull_({"coherent_update.vert", "coherent_cull.geom"}, {{}, {"corner_a", "corner_b", "corner_c"}}) {
    glGenQueries(static_cast<GLsizei>(queries_.size()), queries_.data());
    for (const ShaderProgram* program : {&going_on_, &from_base_}) {
        program->use();
        glUniform2uiv(program->uniform("ones"), coherent_most_levels + 1, ones().data());
    }
    for (const Store* store : {&stores_[0], &stores_[1], &fresh_}) attach(*store);
}

CoherentMesh::~CoherentMesh() { glDeleteQueries(static_cast<GLsizei>(queries_.size()), queries_.data()); }

void CoherentMesh::attach(const Store& store) {
    store.layout.bind();
    glBindBuffer(GL_ARRAY_BUFFER, store.buffer.name());
    for (GLuint i = 0; i < attributes; ++i) {
        glEnableVertexAttribArray(i);
        glVertexAttribIPointer(i, 2, i < 3 ? GL_INT : GL_UNSIGNED_INT, sizeof(CoherentTriangle),
                               buffer_offset(i * 8));
    }
    glBindVertexArray(0);
}

void CoherentMesh::reserve(Store& store, size_t triangles) {
    if (store.capacity >= triangles) return;
    store.capacity = std::max(least_capacity, triangles);
    glBindBuffer(GL_TRANSFORM_FEEDBACK_BUFFER, store.buffer.name());
    glBufferData(GL_TRANSFORM_FEEDBACK_BUFFER,
                 static_cast<GLsizeiptr>(store.capacity * sizeof(CoherentTriangle)), nullptr,
                 GL_DYNAMIC_COPY);
}

void CoherentMesh::reserve_list(size_t triangles) {
    if (list_capacity_ >= triangles) return;
    list_capacity_ = std::max(least_capacity, triangles);
    glBindBuffer(GL_TRANSFORM_FEEDBACK_BUFFER, list_.name());
    glBufferData(GL_TRANSFORM_FEEDBACK_BUFFER, static_cast<GLsizeiptr>(list_capacity_ * listed_bytes),
                 nullptr, GL_DYNAMIC_COPY);
    list_texels_.bind(GL_TEXTURE_BUFFER, first_own_unit);
    glTexBuffer(GL_TEXTURE_BUFFER, GL_RG32I, list_.name());
}

size_t CoherentMesh::most_capacity() {
    GLint texels = 65'536;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
    return static_cast<size_t>(texels) / texels_a_triangle;
}

void CoherentMesh::take_window(LatticePoint eye) {
    const CoherentWindow next = count_ == 0 ? window_about(eye) : window_about(eye, window_);
    const bool overlap =
        std::max(std::abs(next.x - window_.x), std::abs(next.z - window_.z)) < coherent_cells;
    const bool keep = count_ != 0 && overlap;
    if (keep && next == window_) return;
    const std::vector<CoherentTriangle> base = keep ? base_triangles(next, window_) : base_triangles(next);
    moved_ = keep ? difference(window_.origin(), next.origin()) : glm::ivec2(0);
    if (!keep) count_ = 0;
    window_ = next;
    fresh_.buffer.fill(GL_ARRAY_BUFFER, std::span(base), GL_STREAM_DRAW);
    fresh_count_ = static_cast<uint32_t>(base.size());
}

CoherentMesh::Pass CoherentMesh::run_pass(const ShaderProgram& program) {
    const Store& from = stores_[current_];
    const Store& to = stores_[1 - current_];
    glUniform2i(program.uniform("moved"), moved_.x, moved_.y);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, to.buffer.name());
    glBeginQueryIndexed(GL_PRIMITIVES_GENERATED, 0, queries_[0]);
    glBeginQueryIndexed(GL_PRIMITIVES_GENERATED, 1, queries_[1]);
    glBeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, queries_[2]);
    glBeginTransformFeedback(GL_POINTS);
    if (count_ != 0) {
        from.layout.bind();
        glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(count_));
    }
    if (fresh_count_ != 0) {
        glUniform2i(program.uniform("moved"), 0, 0);
        fresh_.layout.bind();
        glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(fresh_count_));
    }
    glEndTransformFeedback();
    glEndQueryIndexed(GL_PRIMITIVES_GENERATED, 0);
    glEndQueryIndexed(GL_PRIMITIVES_GENERATED, 1);
    glEndQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
    std::array<GLuint, 3> results{};
    for (size_t i = 0; i < results.size(); ++i)
        glGetQueryObjectuiv(queries_[i], GL_QUERY_RESULT, &results[i]);
    return {results[2] < results[0], results[1] == 0, results[0]};
}

/// Runs passes until no triangle has to be left too coarse; returns how many.
uint32_t CoherentMesh::converge(const Eye& now, uint32_t most_triangles) {
    const glm::ivec2 origin = difference(window_.origin(), now.anchor);
    const ShaderProgram& program = count_ == 0 ? from_base_ : going_on_;
    program.use();
    glUniform2i(program.uniform("mesh_origin"), origin.x, origin.y);
    glUniform1f(program.uniform("surely"), surely_divided(now.eye));
    glUniform1f(program.uniform("coarser"), coarser_);
    glEnable(GL_RASTERIZER_DISCARD);
    uint32_t passes = 0;
    for (;;) {
        reserve(stores_[1 - current_], std::max<size_t>(stores_[current_].capacity, count_ + fresh_count_));
        const Pass pass = run_pass(program);
        ++passes;
        if (pass.written > most_triangles || pass.written > most_capacity()) {
            // Too many: all coarser, from where the mesh stands.
            coarser_ *= coarser_step;
            glUniform1f(program.uniform("coarser"), coarser_);
            continue;
        }
        if (pass.overflowed) {
            // What it was made of is still there: once more with room enough.
            reserve(stores_[1 - current_], std::min(most_capacity(), size_t{pass.written} * 3));
            continue;
        }
        current_ = 1 - current_;
        count_ = pass.written;
        fresh_count_ = 0;
        moved_ = glm::ivec2(0);
        if (pass.finished) break;
    }
    glDisable(GL_RASTERIZER_DISCARD);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
    return passes;
}

CoherentWork CoherentMesh::update(LatticePoint anchor, const MeshEye& eye, uint32_t most_triangles) {
    const Eye now{anchor, eye};
    CoherentWork work;
    const bool finer = coarser_ > 1.0F && count_ < most_triangles / 3;
    const bool too_many = count_ > most_triangles;
    if (count_ != 0 && made_for_ && made_for_->same_mesh_as(now) && !finer && !too_many) {
        work.triangles = count_;
        made_for_ = now;
        return work;
    }
    listed_for_.reset();
    if (finer) coarser_ = std::max(1.0F, coarser_ / coarser_step);
    if (made_for_ && is_cut(*made_for_, now)) forget();
    work.from_base = count_ == 0;
    take_window({anchor.x + eye.cell.x, anchor.z + eye.cell.y});
    work.passes = converge(now, std::max(most_triangles, 4096U));
    work.triangles = count_;
    made_for_ = now;
    return work;
}

void CoherentMesh::list_visible(LatticePoint anchor, const FrustumPlanes& planes, float reach_m) {
    FrustumPlanes wider = planes;
    for (glm::vec4& plane : wider) plane.w += reach_m;
    if (listed_for_ && made_for_ && listed_for_->same_as(*made_for_) && listed_ == wider) return;
    reserve_list(stores_[current_].capacity);
    const glm::ivec2 origin = difference(window_.origin(), anchor);
    cull_.use();
    glUniform2i(cull_.uniform("mesh_origin"), origin.x, origin.y);
    glUniform4fv(cull_.uniform("planes"), static_cast<GLsizei>(wider.size()), &wider[0].x);
    glEnable(GL_RASTERIZER_DISCARD);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, list_.name());
    glBeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, queries_[3]);
    glBeginTransformFeedback(GL_POINTS);
    stores_[current_].layout.bind();
    glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(count_));
    glEndTransformFeedback();
    glEndQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
    glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, 0);
    glDisable(GL_RASTERIZER_DISCARD);
    visible_.reset();
    listed_for_ = made_for_;
    listed_ = wider;
}

uint32_t CoherentMesh::visible() {
    if (!visible_) {
        GLuint written = 0;
        glGetQueryObjectuiv(queries_[3], GL_QUERY_RESULT, &written);
        visible_ = written;
    }
    return *visible_;
}

void CoherentMesh::bind_triangles(const ShaderProgram& program, LatticePoint anchor) const {
    list_texels_.bind(GL_TEXTURE_BUFFER, first_own_unit);
    const glm::ivec2 origin = difference(window_.origin(), anchor);
    glUniform1i(program.uniform("coherent_triangles"), first_own_unit);
    glUniform2i(program.uniform("mesh_origin"), origin.x, origin.y);
    glUniform1f(program.uniform("coarser"), coarser_);
}

std::vector<CoherentTriangle> CoherentMesh::read() const {
    std::vector<CoherentTriangle> triangles(count_);
    glBindBuffer(GL_ARRAY_BUFFER, stores_[current_].buffer.name());
    glGetBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(count_ * sizeof(CoherentTriangle)),
                       triangles.data());
    return triangles;
}

}  // namespace trochoid
