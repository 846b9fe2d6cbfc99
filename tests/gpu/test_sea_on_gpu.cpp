// The shaders' sea against the CPU's at the very points that the shaders chose (bar R2).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>

#include "client/gpu/offscreen_context.hpp"
#include "protocol/model/sea.hpp"
#include "tests/gpu/fixture_sea.hpp"
#include "tests/gpu/sea_probe.hpp"

namespace trochoid {
namespace {

/// The state's sea on the CPU.
Sea sea_of(const InterestState& state) {
    std::map<FieldId, std::shared_ptr<LandField>> fields;
    for (const auto& [key, entry] : state.blocks) {
        auto& field = fields[entry.field];
        if (!field) field = std::make_shared<LandField>(entry.field, entry.step_log2);
        field->set(entry.block);
    }
    std::vector<std::shared_ptr<const LandField>> list;
    list.reserve(fields.size());
    for (const auto& [id, field] : fields) list.push_back(field);
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (const auto& [id, box] : state.boxes) boxes.push_back(prepare(*box, list));
    return Sea(std::move(boxes));
}

/// The digest of sea.glsl over the CPU's phases.
uint32_t phases_of(const Sea& sea, SeaTime now, LatticePoint p) {
    uint32_t digest = 2166136261U;
    for (const auto& box : sea.boxes()) {
        if (envelope_at(box->record, instant_of(box->record, now), p).gain == 0) continue;
        for (size_t i = 0; i < box->record.trains.size(); ++i) {
            const WaveTrain& train = box->record.trains[i];
            const int16_t field = box->field_of_train[i];
            const uint32_t shift = field < 0 ? 0 : box->fields[static_cast<size_t>(field)]->sample(p).shift;
            digest = (digest ^ (phase_from_place(train, p.x, p.z) + phase_at_origin(train, now.us) + shift)) *
                     16777619U;
        }
    }
    return digest;
}

struct Comparison {
    size_t vertices = 0;
    size_t moved = 0;  // with any displacement at all
    size_t phase_differs = 0;
    size_t bits_differ = 0;  // in displacement or normal
    double worst_mm = 0;     // of displacement
    double worst_normal = 0;
};

Comparison compare(const InterestState& state, SeaTime now, const Camera& camera) {
    const Probe probe = probe_sea(state, now, camera);
    const Sea sea = sea_of(state);
    const SeaInstant instant(sea, now);
    Comparison result;
    for (size_t i = 0; i < probe.vertices.size(); i += 7) {
        const ProbedVertex& v = probe.vertices[i];
        const LatticePoint p{probe.anchor.x + v.x, probe.anchor.z + v.z};
        const SurfaceSample cpu = instant.evaluate(p);
        ++result.vertices;
        if (cpu.ay != 0.0F) ++result.moved;
        if (phases_of(sea, now, p) != v.phases) ++result.phase_differs;
        const float shift[3] = {cpu.ax, cpu.ay, cpu.az};
        const float normal[3] = {cpu.nx, cpu.ny, cpu.nz};
        bool same = true;
        for (int k = 0; k < 3; ++k) {
            // Zeros of either sign are the same place.
            same = same && shift[k] == v.shift[k] && normal[k] == v.normal[k];
            result.worst_mm = std::max(result.worst_mm, 1e3 * std::abs(static_cast<double>(shift[k]) -
                                                                       static_cast<double>(v.shift[k])));
            result.worst_normal = std::max(result.worst_normal, std::abs(static_cast<double>(normal[k]) -
                                                                         static_cast<double>(v.normal[k])));
        }
        if (!same) ++result.bits_differ;
    }
    fmt::print(
        "{}: {} vertices, {} moved, phases differ at {}, bits differ at {}, worst {:.6f} mm, worst normal {:.2e}\n",
        describe_gl(), result.vertices, result.moved, result.phase_differs, result.bits_differ,
        result.worst_mm, result.worst_normal);
    return result;
}

class SeaOnGpu : public testing::Test {
protected:
    static void SetUpTestSuite() { context_ = std::make_unique<OffscreenContext>(); }
    static void TearDownTestSuite() { context_.reset(); }

    static void expect_equal(const Comparison& c) {
        EXPECT_GT(c.vertices, 10'000U);
        EXPECT_GT(c.moved, c.vertices / 4);
        EXPECT_EQ(c.phase_differs, 0U);
        EXPECT_LE(c.worst_mm, 0.1);
        EXPECT_LE(c.worst_normal, 1e-4);
        // Software GL rounds as C++ does; a GPU may differ in the last bits, within the bound above.
        if (describe_gl().find("llvmpipe") != std::string::npos) {
            EXPECT_EQ(c.bits_differ, 0U);
        }
    }
    static std::unique_ptr<OffscreenContext> context_;
};
std::unique_ptr<OffscreenContext> SeaOnGpu::context_;

/// A fixture whose patches lie around a camera.
InterestState around(FixtureSource& source, const Camera& camera) {
    ViewState view = view_of(camera, glm::dvec3(0));
    view.accepted_error_px = 12.0F;
    source.set_view(view);
    return source.state();
}

WaveTrainBox storm(BoxId id, TrainId first, LatticePoint origin, double heading, double height) {
    WaveTrainBox box;
    box.id = id;
    box.first_train = first;
    box.origin = origin;
    box.ux = static_cast<int32_t>(std::lround(std::cos(heading) * 0x1p30));
    box.uz = static_cast<int32_t>(std::lround(std::sin(heading) * 0x1p30));
    box.length = to_lattice(16'000);
    box.width = to_lattice(14'000);
    box.ramp_rear = static_cast<int32_t>(to_lattice(3'001.3));
    box.ramp_front = static_cast<int32_t>(to_lattice(2'047.1));
    box.ramp_side = static_cast<int32_t>(to_lattice(1'777.7));
    box.trains = wind_sea(180.0, heading, height, 32, 11);
    return box;
}

TEST_F(SeaOnGpu, over_a_coast_with_fields_of_phase_and_gain) {
    FixtureSource source(shipped_terrain());
    Camera camera;
    camera.position = {to_lattice(-900), to_lattice(-2'600)};
    expect_equal(compare(around(source, camera), SeaTime{73'500'123}, camera));
}

TEST_F(SeaOnGpu, ten_metre_sea_after_ten_years_and_ten_thousand_kilometres) {
    FixtureSource source(TerrainGrid{});
    Camera camera;
    camera.position = {to_lattice(9'876'543.21), to_lattice(-7'654'321.9)};
    camera.fraction_x = 0.37;
    const LatticePoint origin{camera.position.x - to_lattice(7'000), camera.position.z - to_lattice(5'000)};
    source.add_box(storm({3}, {200}, origin, 0.6, 10.0));
    expect_equal(
        compare(around(source, camera), SeaTime{int64_t{315'576'000} * 1'000'000 + 987'654}, camera));
}

TEST_F(SeaOnGpu, a_box_that_grows_and_one_that_decays) {
    FixtureSource source(TerrainGrid{});
    Camera camera;
    camera.position = {to_lattice(-20'000'001.7), to_lattice(12'345'678.9)};
    const LatticePoint origin{camera.position.x - to_lattice(6'000), camera.position.z - to_lattice(9'000)};
    WaveTrainBox growing = storm({3}, {200}, origin, 1.1, 6.0);
    growing.begin = {1'000'000'000};
    growing.build_up_us = 900'000'000;
    growing.front_speed = 9U * 17'180U;
    WaveTrainBox fading = storm({4}, {300}, {origin.x + 77, origin.z - 991}, 0.2, 4.0);
    fading.end = {1'100'000'000};
    fading.decay_us = 777'777'777;
    // Unlimited along travel: only the sides ramp.
    WaveTrainBox band = storm({5}, {400}, origin, -0.9, 2.0);
    band.length = 0;
    for (const WaveTrainBox& box : {growing, fading, band}) source.add_box(box);
    expect_equal(compare(around(source, camera), SeaTime{1'650'000'017}, camera));
}

/// Any fields a peer may send: steps, negative shifts, gains up to 2, cells of the coarsest and the finest lattice.
TEST_F(SeaOnGpu, hostile_land_fields_of_every_step) {
    for (const uint8_t step_log2 : std::array<uint8_t, 4>{12, 15, 17, 20}) {
        SCOPED_TRACE(int{step_log2});
        FixtureSource source(TerrainGrid{});
        Camera camera;
        camera.position = {to_lattice(-30'123), to_lattice(5'432)};
        InterestState state = around(source, camera);
        const auto node_shift = [](int64_t x, int64_t z) {
            return static_cast<int32_t>((x * 2'654'435'761 ^ z * 40'503) % 4'000'000);
        };
        const int64_t side = int64_t{block_cells} << step_log2;
        for (int64_t bz = -20; bz <= 20; ++bz)
            for (int64_t bx = -20; bx <= 20; ++bx) {
                auto block = std::make_shared<LandBlock>();
                block->key = {static_cast<int32_t>(camera.position.x / side + bx),
                              static_cast<int32_t>(camera.position.z / side + bz)};
                if ((bx + bz) % 5 == 0) continue;
                for (int j = 0; j < block_nodes; ++j)
                    for (int i = 0; i < block_nodes; ++i) {
                        const int64_t x = int64_t{block->key.x} * block_cells + i;
                        const int64_t z = int64_t{block->key.z} * block_cells + j;
                        block->shift[static_cast<size_t>(j * block_nodes + i)] = node_shift(x, z);
                        block->gain[static_cast<size_t>(j * block_nodes + i)] =
                            static_cast<uint16_t>(node_shift(z, x) & 0xffff);
                    }
                state.blocks[{{9}, block->key}] = {{9}, step_log2, block};
            }
        WaveTrainBox box =
            storm({3}, {200}, {camera.position.x - to_lattice(5'000), camera.position.z - to_lattice(6'000)},
                  0.4, 10.0);
        box.begin = {-sea_time_bound};
        for (size_t i = 0; i < box.trains.size(); ++i) box.trains[i].field = {i % 3 == 0 ? 0U : 9U};
        state.boxes[box.id] = std::make_shared<const WaveTrainBox>(box);
        for (auto& [key, patch] : state.patches) patch.boxes.push_back({box.id, 32});
        expect_equal(compare(state, SeaTime{-5'000'000'000'017}, camera));
    }
}

}  // namespace
}  // namespace trochoid
