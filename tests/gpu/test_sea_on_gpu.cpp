// The shaders' sea against the CPU's at the very points that the shaders chose (bar R2).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "client/gpu/offscreen_context.hpp"
#include "tests/gpu/fixture_sea.hpp"
#include "tests/gpu/sea_comparison.hpp"

namespace trochoid {
namespace {

Comparison compare(const InterestState& state, SeaTime now, const Camera& camera,
                   Layers layers = displayed_layers) {
    DrawOptions options;
    options.layers = layers;
    return compare_sea(state, now, camera, options);
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

/// A camera with a sea around it for the features of session two.
struct Ground {
    FixtureSource source{TerrainGrid{}};
    Camera camera;
    SeaTime now{1'650'000'017};
    Ground() { camera.position = {to_lattice(4'000'123.7), to_lattice(-987'654.3)}; }
    LatticePoint at(double east, double south) const {
        return {camera.position.x + to_lattice(east), camera.position.z + to_lattice(south)};
    }
    InterestState state() { return around(source, camera); }
};

CourseLeg leg_of(LatticePoint origin, double heading, double speed) {
    const double q = speed * 1024e-6 * 0x1p24;
    return {{900'000'000},
            1'000'000'000'000,
            origin,
            static_cast<int32_t>(q * std::cos(heading)),
            static_cast<int32_t>(q * std::sin(heading))};
}

WaveTrainBox moving_storm(const Ground& g) {
    WaveTrainBox box = storm({3}, {200}, g.at(-24'000, -12'000), 0.3, 7.0);
    // 750 s at 24 m/s
    box.course = {leg_of(box.origin, 0.3, 24.0)};
    box.begin = {1'600'000'000};
    box.raised_us = 400'000'000;
    box.fade_us = 90'000'001;
    box.build_up_us = 700'000'003;
    return box;
}

IrregularHeight groups() {
    IrregularHeight i;
    i.share = 24'321;
    i.ukx = 13'000;
    i.ukz = 4'501;
    i.vkx = -4'500;
    i.vkz = 13'007;
    i.omega = 615'000'000'000'000ULL;
    i.phase_u = 0x12345678;
    i.phase_v = 0xdeadbeef;
    return i;
}

/// A ship of 8.3 m/s that has come 6 km, its stern 400 m from the camera.
WaveTrainBox ship(const Ground& g, double heading) {
    WaveTrainBox box;
    box.id = {6};
    box.first_train = {600};
    box.ux = static_cast<int32_t>(std::lround(std::cos(heading) * 0x1p30));
    box.uz = static_cast<int32_t>(std::lround(std::sin(heading) * 0x1p30));
    box.length = to_lattice(9'000);
    box.width = to_lattice(7'000);
    const double speed = 8.3, gone = speed * 750.0;
    const double u = -9'000 + 400 - gone, v = -3'500;
    box.origin =
        g.at(u * std::cos(heading) - v * std::sin(heading), u * std::sin(heading) + v * std::cos(heading));
    box.begin = {900'000'000};
    box.course = {leg_of(box.origin, heading, speed)};
    const double length = 6.283185307 * speed * speed / 9.81;
    box.wake.transverse = 0.55F;
    box.wake.diverging = 0.4F;
    box.wake.choppiness = 0.83F;
    box.wake.inverse_length = static_cast<uint32_t>(0x1p40 / (length * 1024.0));
    box.wake.group_speed = static_cast<uint32_t>(speed * 0.5 * 1024e-6 * 0x1p24);
    return box;
}

WaveTrainBox noisy(BoxId id, bool displayed_only) {
    WaveTrainBox box;
    box.id = id;
    box.first_train = {id.value * 100};
    box.begin = {-sea_time_bound};
    box.noise = {0.21F, 41'000, 7, 13, 22, displayed_only, 0xc0ffee};
    return box;
}

TEST_F(SeaOnGpu, a_storm_on_its_course_that_takes_over_from_another) {
    Ground g;
    g.source.add_box(moving_storm(g));
    expect_equal(compare(g.state(), g.now, g.camera));
}

TEST_F(SeaOnGpu, irregular_heights) {
    Ground g;
    WaveTrainBox box = storm({3}, {200}, g.at(-7'000, -5'000), 0.6, 8.0);
    box.irregular = groups();
    g.source.add_box(box);
    expect_equal(compare(g.state(), g.now, g.camera));
}

TEST_F(SeaOnGpu, round_waves_of_odd_widths) {
    for (const int64_t width : {to_lattice(14'000), to_lattice(9'999.137), to_lattice(1'048'000)}) {
        Ground g;
        WaveTrainBox box = storm({3}, {200}, g.at(-7'000, -to_metres(width) * 0.47), 0.1, 6.0);
        box.width = width;
        box.roundness = 31'001;
        g.source.add_box(box);
        expect_equal(compare(g.state(), g.now, g.camera));
    }
}

TEST_F(SeaOnGpu, a_ships_wake_before_and_after_it_has_stopped) {
    for (const double heading : {0.0, 2.1, -1.57}) {
        SCOPED_TRACE(heading);
        Ground g;
        WaveTrainBox box = ship(g, heading);
        g.source.add_box(box);
        expect_equal(compare(g.state(), g.now, g.camera));
        box.end = {1'600'000'000};
        box.decay_us = 400'000'000;
        g.source.add_box(box);
        expect_equal(compare(g.state(), g.now, g.camera));
    }
}

TEST_F(SeaOnGpu, noise_of_seven_octaves_by_layer) {
    Ground g;
    g.source.add_box(noisy({7}, false));
    WaveTrainBox fine = noisy({8}, true);
    fine.noise.step_log2 = 10;
    fine.noise.period_log2 = 40;
    fine.origin = g.at(-5'000, -4'000);
    fine.length = fine.width = to_lattice(9'000);
    fine.ramp_front = fine.ramp_rear = fine.ramp_side = static_cast<int32_t>(to_lattice(1'500));
    g.source.add_box(fine);
    const InterestState state = g.state();
    expect_equal(compare(state, g.now, g.camera));
    expect_equal(compare(state, g.now, g.camera, authoritative_layers));
    expect_equal(compare(state, SeaTime{-123'456'789'012'345}, g.camera));
}

/// Blocks of a field around a place; `odd` tells overlays from their bases.
void add_blocks(InterestState& state, FieldId id, LatticePoint middle, int odd) {
    const int64_t side = int64_t{block_cells} << 16;
    for (int64_t bz = -12; bz <= 12; ++bz)
        for (int64_t bx = -12; bx <= 12; ++bx) {
            // An overlay has some of the blocks; its base lacks others.
            if ((bx * 7 + bz * 3) % 3 != odd && odd != 0) continue;
            if (odd == 0 && (bx + bz) % 4 == 0) continue;
            auto block = std::make_shared<LandBlock>();
            block->key = {static_cast<int32_t>(middle.x / side + bx),
                          static_cast<int32_t>(middle.z / side + bz)};
            for (int j = 0; j < block_nodes; ++j)
                for (int i = 0; i < block_nodes; ++i) {
                    const auto n = static_cast<size_t>(j * block_nodes + i);
                    const int64_t x = int64_t{block->key.x} * block_cells + i;
                    const int64_t z = int64_t{block->key.z} * block_cells + j;
                    const int64_t dice = (x * 2'654'435'761 ^ z * 40'503) + odd * 77'777;
                    block->shift[n] = static_cast<int32_t>(dice % 900'000);
                    block->gain[n] = static_cast<uint16_t>((dice >> 5) & 0xffff);
                    block->orbit[n] = static_cast<uint16_t>((dice >> 9) & 0xffff);
                }
            state.blocks[{id, block->key}] = {id, 16, block};
        }
}

/// Everything that a box can be, in one sea.
InterestState everything(Ground& g) {
    WaveTrainBox box = moving_storm(g);
    box.irregular = groups();
    box.roundness = 20'000;
    box.noise = {0.1F, 30'000, 3, 11, 20, false, 5};
    for (size_t i = 0; i < box.trains.size(); ++i)
        box.trains[i].field = {i % 3 == 0 ? 0U : (i % 3 == 1 ? 14U : 9U)};
    box.overlays = {{{12}, {9}}, {{14}, {12}}};
    WaveTrainBox before = storm({4}, {300}, g.at(-7'000, -6'000), -0.4, 3.0);
    for (WaveTrain& train : before.trains) train.field = {9};
    for (const WaveTrainBox& b : {box, before, ship(g, 0.7), noisy({7}, false), noisy({8}, true)})
        g.source.add_box(b);
    InterestState state = g.state();
    add_blocks(state, {9}, g.camera.position, 0);
    add_blocks(state, {12}, g.camera.position, 1);
    add_blocks(state, {14}, g.camera.position, 2);
    return state;
}

TEST_F(SeaOnGpu, everything_at_once_and_each_layer_without) {
    Ground g;
    const InterestState state = everything(g);
    expect_equal(compare(state, g.now, g.camera));
    for (int bit = 0; bit < 9; ++bit) {
        SCOPED_TRACE(bit);
        const auto layer = static_cast<Layer>(1U << bit);
        const Comparison c = compare(state, g.now, g.camera, displayed_layers.without(layer));
        expect_equal(c);
        EXPECT_GT(c.changed, c.vertices / 20) << "a layer that changes nothing proves nothing";
    }
}

}  // namespace
}  // namespace trochoid
