#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "client/scene/bed_map.hpp"
#include "client/scene/debug_lines.hpp"
#include "client/scene/land_table.hpp"
#include "client/scene/layer_names.hpp"
#include "client/scene/ripple_map.hpp"
#include "client/scene/sea_table.hpp"

namespace trochoid {
namespace {

std::shared_ptr<const LandBlock> block_at(int32_t x, int32_t z, int32_t shift) {
    auto block = std::make_shared<LandBlock>();
    block->key = {x, z};
    block->shift.fill(shift);
    block->gain.fill(unit_node_gain);
    return block;
}

void add(InterestState& state, FieldId field, const std::shared_ptr<const LandBlock>& block) {
    state.blocks[{field, block->key}] = {field, 16, block};
}

TEST(LandTable, slots_lead_to_the_blocks_of_their_field) {
    InterestState state;
    add(state, {3}, block_at(-2, 5, 111));
    add(state, {3}, block_at(1, 6, 222));
    add(state, {7}, block_at(0, 0, 333));
    LandTable table;
    EXPECT_TRUE(table.rebuild(state, 1'000, 100'000));
    EXPECT_EQ(table.block_count(), 3U);
    EXPECT_EQ(table.row_of({3}), 0);
    EXPECT_EQ(table.row_of({7}), 1);
    EXPECT_EQ(table.row_of({5}), -1);
    EXPECT_EQ(table.row_of({0}), -1);
    std::vector<std::array<int32_t, 4>> rows;
    const LatticePoint anchor{int64_t{1} << 21, -(int64_t{3} << 20)};
    table.append_fields(rows, anchor);
    ASSERT_EQ(rows.size(), 4U);
    // As the shader finds a block: node of the place, block of the node, slot of the block.
    const auto shift_at = [&](int field, LatticePoint p) {
        const auto& place = rows[static_cast<size_t>(field) * 2];
        const auto& window = rows[static_cast<size_t>(field) * 2 + 1];
        const int64_t node_x = place[0] + ((p.x - anchor.x) >> place[2]);
        const int64_t node_z = place[1] + ((p.z - anchor.z) >> place[2]);
        const int64_t column = node_x >> 4;
        const int64_t row = node_z >> 4;
        if (column < 0 || row < 0 || column >= window[0] || row >= window[1]) return -1;
        const int32_t first = table.slots()[static_cast<size_t>(place[3] + row * window[0] + column)];
        return first < 0 ? -1 : table.nodes()[static_cast<size_t>(first)][0];
    };
    const int64_t side = int64_t{block_cells} << 16;
    EXPECT_EQ(shift_at(0, {-2 * side, 5 * side}), 111);
    EXPECT_EQ(shift_at(0, {2 * side - 1, 7 * side - 1}), 222);
    EXPECT_EQ(shift_at(0, {0, 5 * side}), -1) << "a hole in the window";
    EXPECT_EQ(shift_at(0, {5 * side, 5 * side}), -1) << "outside the window";
    EXPECT_EQ(shift_at(1, {side - 1, 0}), 333);
}

TEST(LandTable, the_same_blocks_change_nothing_and_too_many_are_counted) {
    InterestState state;
    for (int32_t i = 0; i < 5; ++i) add(state, {1}, block_at(i, 0, i));
    add(state, {2}, block_at(0, 0, 9));
    LandTable table;
    EXPECT_TRUE(table.rebuild(state, 1'000, 100'000));
    EXPECT_FALSE(table.rebuild(state, 1'000, 100'000));
    add(state, {2}, block_at(0, 0, 10));
    EXPECT_TRUE(table.rebuild(state, 1'000, 100'000));
    EXPECT_EQ(table.left_out(), 0U);
    LandTable small;
    EXPECT_TRUE(small.rebuild(state, 4, 100'000));
    EXPECT_EQ(small.left_out(), 5U);
    EXPECT_EQ(small.row_of({1}), -1);
    EXPECT_EQ(small.row_of({2}), 0);
}

/// The shift that the shader finds in block (0, 0) of a row's window, whose first block it is; -1 where none lies.
int32_t first_shift(const LandTable& table, int row) {
    std::vector<std::array<int32_t, 4>> rows;
    table.append_fields(rows, {});
    const int32_t node = table.slots()[static_cast<size_t>(rows[static_cast<size_t>(row) * 2][3])];
    return node < 0 ? -1 : table.nodes()[static_cast<size_t>(node)][0];
}

TEST(LandTable, overlays_are_laid_over_their_bases) {
    InterestState state;
    add(state, {3}, block_at(0, 0, 111));
    add(state, {3}, block_at(1, 0, 112));
    auto flat = std::make_shared<LandBlock>(*block_at(0, 0, 0));
    flat->orbit.fill(3 * unit_node_orbit);
    add(state, {5}, flat);  // over 3: calm there again
    add(state, {7}, block_at(1, 0, 333));
    WaveTrainBox box;
    box.id = {1};
    box.trains.resize(3);
    box.trains[0].field = {5};
    box.trains[1].field = {7};
    box.trains[2].field = {8};  // over 3, no block of its own has come
    box.overlays = {{{5}, {3}}, {{7}, {5}}, {{8}, {3}}};
    LandTable table;
    EXPECT_TRUE(table.rebuild(state, 1'000, 100'000));
    EXPECT_EQ(table.row_of(box, {5}), -1) << "nobody reads the chain yet";
    state.boxes[{1}] = std::make_shared<const WaveTrainBox>(box);
    EXPECT_TRUE(table.rebuild(state, 1'000, 100'000)) << "the same blocks, another chain";
    EXPECT_FALSE(table.rebuild(state, 1'000, 100'000));
    EXPECT_EQ(table.block_count(), 4U) << "shared, not copied";
    EXPECT_EQ(first_shift(table, table.row_of({3})), 111);
    EXPECT_EQ(first_shift(table, table.row_of(box, {5})), 0)
        << "the overlay's own block counts, trivial or not";
    EXPECT_EQ(first_shift(table, table.row_of(box, {7})), 0) << "two fields down";
    EXPECT_EQ(first_shift(table, table.row_of(box, {8})), 111);
    EXPECT_EQ(table.largest_orbit(), 3.0F);
    // A base of another step does not count.
    state.blocks.at({{3}, {0, 0}}).step_log2 = state.blocks.at({{3}, {1, 0}}).step_log2 = 15;
    auto other = std::make_shared<LandBlock>(*flat);
    state.blocks.at({{5}, {0, 0}}).block = other;
    EXPECT_TRUE(table.rebuild(state, 1'000, 100'000));
    EXPECT_EQ(first_shift(table, table.row_of(box, {5})), 0);
    std::vector<std::array<int32_t, 4>> rows;
    table.append_fields(rows, {});
    EXPECT_EQ(rows[static_cast<size_t>(table.row_of(box, {5})) * 2 + 1][0], 1) << "one column: field 5 alone";
}

WaveTrainBox box_of(uint32_t id, int trains) {
    WaveTrainBox box;
    box.id = {id};
    box.first_train = {id * 100};
    for (int i = 0; i < trains; ++i) {
        WaveTrain train;
        train.kx = 60'000 * (i + 1);
        train.kz = -10'000;
        train.omega = 1'000'000'000'000ULL;
        train.phase = static_cast<uint32_t>(i) * 77U;
        train.amplitude = 0.5F;
        train.choppiness = 0.7F;
        box.trains.push_back(train);
    }
    return box;
}

InterestState two_boxes() {
    InterestState state;
    for (const auto& [id, trains] : {std::pair{4U, 3}, {9U, 5}})
        state.boxes[{id}] = std::make_shared<const WaveTrainBox>(box_of(id, trains));
    state.patches[{16, 0, 0}].boxes = {{{4}, 2}, {{9}, 5}};
    state.patches[{16, 1, 0}].boxes = {{{4}, 2}, {{9}, 5}};
    state.patches[{16, 2, 0}].boxes = {{{5}, 1}, {{9}, 99}};
    state.patches[{16, 3, 0}].boxes = {};
    return state;
}

TEST(SeaTable, lists_name_rows_and_trains_and_equal_ones_are_shared) {
    SeaTable table;
    table.rebuild(two_boxes(), LandTable{});
    EXPECT_EQ(table.train_count(), 8U);
    const int list = table.list_of({16, 0, 0});
    EXPECT_EQ(list, table.list_of({16, 1, 0}));
    EXPECT_EQ(table.lists()[static_cast<size_t>(list)], (ListTexel{2, 0}));
    EXPECT_EQ(table.lists()[static_cast<size_t>(list) + 1], (ListTexel{0, 2}));
    EXPECT_EQ(table.lists()[static_cast<size_t>(list) + 2], (ListTexel{box_row_texels, 5}));
    // A box that has not come yet is left out; no more trains than there are; who is not named lends its roughness.
    const auto partial = static_cast<size_t>(table.list_of({16, 2, 0}));
    EXPECT_EQ(table.lists()[partial], (ListTexel{2, 0}));
    EXPECT_EQ(table.lists()[partial + 1], (ListTexel{0, 0}));
    EXPECT_EQ(table.lists()[partial + 2], (ListTexel{box_row_texels, 5}));
    const int bare = table.list_of({16, 3, 0});
    EXPECT_EQ(table.lists()[static_cast<size_t>(bare)], (ListTexel{2, 0}));
    EXPECT_EQ(table.bounds_of_list(bare), WaveBounds{}) << "nothing of them moves it";
    EXPECT_EQ(table.lists()[0], (ListTexel{2, 0})) << "list 0 holds everything";
    EXPECT_NEAR(table.bounds_of_list(list).height, 4.0F, 0.01F);
}

TEST(SeaTable, rows_hold_the_phases_of_the_moment) {
    const InterestState state = two_boxes();
    SeaTable table;
    table.rebuild(state, LandTable{});
    for (const int64_t us : {int64_t{0}, int64_t{123'456'789'012}, int64_t{-55}}) {
        const auto records = table.records(LandTable{}, {}, SeaTime{us});
        ASSERT_EQ(records.size(), size_t{2 * box_row_texels + 8 * train_row_texels});
        const auto first = static_cast<size_t>(records[box_row_texels + 6][2]);
        for (size_t i = 0; i < 5; ++i) {
            const WaveTrain& train = state.boxes.at({9})->trains[i];
            EXPECT_EQ(records[first + i * train_row_texels][0], train.kx);
            EXPECT_EQ(static_cast<uint32_t>(records[first + i * train_row_texels][2]),
                      phase_at_origin(train, us));
            EXPECT_EQ(records[first + i * train_row_texels][3], -1);
        }
        // The last texel's tail: variances of this and all shorter trains.
        const auto tail = [&](size_t i, size_t c) {
            return std::bit_cast<float>(records[first + i * train_row_texels + 2][c]);
        };
        EXPECT_FLOAT_EQ(tail(4, 3), tail(4, 2));
        EXPECT_FLOAT_EQ(tail(3, 3), tail(3, 2) + tail(4, 3));
    }
}

TEST(SeaTable, a_limited_box_beyond_its_axes_reach_is_silent_but_kept) {
    InterestState state;
    WaveTrainBox far = box_of(1, 1);
    far.origin = {world_bound, world_bound};
    far.length = far.width = longest_side;
    state.boxes[{1}] = std::make_shared<const WaveTrainBox>(far);
    SeaTable table;
    table.rebuild(state, LandTable{});
    EXPECT_EQ(table.records(LandTable{}, {}, SeaTime{1})[1][3], 0);
    EXPECT_NE(table.records(LandTable{}, {world_bound, world_bound}, SeaTime{1})[1][3], 0);
}

TEST(SeaTable, features_have_rows_only_where_a_layer_shows_them) {
    InterestState state;
    WaveTrainBox box = box_of(1, 5);
    box.length = box.width = to_lattice(4'000);
    box.roundness = 9'000;
    box.irregular.share = 1'000;
    box.irregular.ukx = box.irregular.vkz = 4'000;
    box.noise = {0.05F, 30'000, 3, 10, 20, true, 1};
    box.course = {{{0}, 1'000'000'000, {0, 0}, 17'180, 0}};
    state.boxes[{1}] = std::make_shared<const WaveTrainBox>(box);
    WaveTrainBox ship = box;
    ship.id = {2};
    ship.trains.clear();
    ship.roundness = 0;
    ship.irregular = {};
    ship.noise = {};
    ship.wake = {0.5F, 0.4F, 0.8F, 20'000'000, 70'000};
    state.boxes[{2}] = std::make_shared<const WaveTrainBox>(ship);
    state.patches[{16, 0, 0}].boxes = {{{2}, 0}};
    SeaTable table;
    table.rebuild(state, LandTable{});
    const auto list = static_cast<size_t>(table.list_of({16, 0, 0}));
    EXPECT_EQ(table.lists()[list + 2], (ListTexel{box_row_texels, 0})) << "a wake shows without any train";
    EXPECT_GT(table.bounds_of_list(static_cast<int>(list)).height, 0.5F);
    const auto all = table.records(LandTable{}, {}, SeaTime{10'000'000});
    const size_t plain = 2 * box_row_texels + 5 * train_row_texels;
    EXPECT_EQ(all.size(), plain + irregular_row_texels + 3 + 3 * octave_row_texels + wake_row_texels);
    const auto& features = all[7];
    EXPECT_EQ(features[0], static_cast<int32_t>(plain));
    EXPECT_EQ(features[1], -1);
    EXPECT_EQ(all[box_row_texels + 7][1], static_cast<int32_t>(all.size()) - wake_row_texels);
    const auto none = table.records(LandTable{}, {}, SeaTime{10'000'000}, Layers{}.with(Layer::trains));
    EXPECT_EQ(none.size(), plain);
    EXPECT_EQ(none[7], (RecordTexel{-1, -1, -1, -1}));
    // 10 s at 1 m/s: the corner has gone 10 m east (Q.24 and Q2.30: to the millimetre).
    const int64_t u = (int64_t{all[0][1]} << 32 | static_cast<uint32_t>(all[0][0])) >> 30;
    EXPECT_NEAR(static_cast<double>(u), -10'240.0, 2.0);
    EXPECT_EQ(wake_texels().size(), 2U * (wake_cells + 1) + wake_root_cells + 1);
}

TEST(LayerNames, sets_sums_and_differences) {
    EXPECT_EQ(layers_named("all"), displayed_layers);
    EXPECT_EQ(layers_named("none"), Layers{});
    EXPECT_EQ(layers_named("authoritative"), authoritative_layers);
    EXPECT_EQ(layers_named("trains,wakes"), Layers{}.with(Layer::trains).with(Layer::wakes));
    EXPECT_EQ(layers_named("-capillary"), authoritative_layers);
    EXPECT_EQ(layers_named("-noise,-round,+noise"), displayed_layers.without(Layer::round));
    EXPECT_EQ(layers_named("all,-trains"), displayed_layers.without(Layer::trains));
    for (const char* wrong : {"", "trains,", ",", "waves", "--noise", "-", "trains noise"})
        EXPECT_EQ(layers_named(wrong), std::nullopt) << wrong;
    Layers every;
    for (const NamedLayer& l : layers_by_importance) every = toggled(every, l.layer);
    EXPECT_EQ(every, displayed_layers) << "each layer has its name and key";
}

TEST(BedMap, takes_the_finest_tile_and_the_open_sea_elsewhere) {
    TerrainGrid grid;
    grid.origin_x = grid.origin_z = -(int64_t{1} << 21);
    grid.columns = grid.rows = 130;
    grid.heights.resize(130 * 130);
    for (size_t i = 0; i < grid.heights.size(); ++i)
        grid.heights[i] = static_cast<int16_t>((i * 7919) % 4000 - 2000);
    const TerrainExtent extent{grid.origin_x, grid.origin_z, grid.spacing_log2,
                               grid.columns,  grid.rows,     grid.open_sea_depth};
    EXPECT_EQ(make_bed_map(extent, {}).heights[5], -60.0F);
    std::vector<std::shared_ptr<const TerrainTile>> tiles{
        std::make_shared<const TerrainTile>(make_tile(grid, {0, 0, 0})),
        std::make_shared<const TerrainTile>(make_tile(grid, {1, 0, 0}))};
    const BedMap map = make_bed_map(extent, tiles);
    ASSERT_EQ(map.columns, 130U);
    for (const uint32_t row : {0U, 13U, 64U})
        for (const uint32_t column : {0U, 31U, 63U})
            EXPECT_FLOAT_EQ(map.heights[row * 130 + column],
                            static_cast<float>(grid.heights[row * 130 + column]) / 32.0F);
    // Only the coarse tile there: its own samples are exact, those between interpolated.
    EXPECT_FLOAT_EQ(map.heights[100 * 130 + 100], static_cast<float>(grid.heights[100 * 130 + 100]) / 32.0F);
    const float between =
        0.5F * static_cast<float>(grid.heights[100 * 130 + 100] + grid.heights[100 * 130 + 102]) / 32.0F;
    EXPECT_NEAR(map.heights[100 * 130 + 101], between, 1e-4F);
}

TEST(RippleMap, has_unit_slope_and_keeps_its_variance_through_all_levels) {
    const RippleMap map = make_ripple_map(128, 5);
    ASSERT_EQ(map.levels.size(), 8U);
    double squares = 0;
    for (const auto& texel : map.levels[0]) squares += static_cast<double>(texel[2]);
    EXPECT_NEAR(squares / static_cast<double>(map.levels[0].size()), 1.0, 0.02);
    const auto& top = map.levels.back();
    ASSERT_EQ(top.size(), 1U);
    EXPECT_NEAR(top[0][0], 0.0F, 1e-3F) << "slopes average out";
    EXPECT_NEAR(top[0][2], 1.0F, 0.02F) << "their variance does not";
}

TEST(DebugLines, outline_follows_the_box_and_points_have_their_colours) {
    InterestState state;
    WaveTrainBox box = box_of(1, 1);
    box.origin = {to_lattice(100), to_lattice(50)};
    box.ux = 0;
    box.uz = 1 << 30;  // travels south, so across is west
    box.length = to_lattice(400);
    box.width = to_lattice(300);
    state.boxes[{1}] = std::make_shared<const WaveTrainBox>(box);
    SceneInput input;
    input.rays.push_back({{0, 0}, {to_lattice(10), 0}, {{{to_lattice(5), 0}, ActionKind::blocked}}});
    DrawOptions options;
    options.boxes = options.rays = true;
    const CameraFrame frame = frame_of(Camera{}, DepthRange::classic);
    const DebugLines lines = make_debug_lines(input, state, frame, SeaMesh{}, options);
    float west = 1e9F;
    float south = -1e9F;
    for (const LineVertex& v : lines.lines) {
        west = std::min(west, v.x);
        south = std::max(south, v.z);
    }
    EXPECT_NEAR(west, 100 - 300, 0.01F);
    EXPECT_NEAR(south, 50 + 400, 0.01F);
    ASSERT_EQ(lines.points.size(), 1U);
    EXPECT_EQ(lines.points[0].tint, tint_of(ActionKind::blocked));
    EXPECT_TRUE(make_debug_lines(input, state, frame, SeaMesh{}, DrawOptions{}).lines.empty());
}

TEST(DebugLines, a_ship_stands_where_its_course_has_brought_it) {
    InterestState state;
    WaveTrainBox box = box_of(1, 0);
    box.length = to_lattice(1'000);
    box.width = to_lattice(800);
    box.ux = 1 << 30;
    box.uz = 0;
    box.course = {{{0}, 1'000'000'000, box.origin, 5 * 17'180, 0}};
    box.wake = {0.5F, 0.4F, 0.8F, 20'000'000, 43'000};
    state.boxes[{1}] = std::make_shared<const WaveTrainBox>(box);
    SceneInput input;
    input.now = {100'000'000};
    DrawOptions options;
    options.boxes = true;
    const DebugLines lines =
        make_debug_lines(input, state, frame_of(Camera{}, DepthRange::classic), SeaMesh{}, options);
    float farthest_east = 0.0F;
    for (const LineVertex& v : lines.lines) farthest_east = std::max(farthest_east, v.x);
    // The course runs on to 1000 s: the ship's 1000 m and 5 m/s.
    EXPECT_NEAR(farthest_east, 1'000 + 5'000, 1.0F);
    const bool bow = std::any_of(lines.lines.begin(), lines.lines.end(), [](const LineVertex& v) {
        return std::abs(v.x - 1'550) < 1.0F && std::abs(v.z - 400) < 0.1F;
    });
    EXPECT_TRUE(bow);
}

}  // namespace
}  // namespace trochoid
