// Paper A's tables 1 and 2 and the text between on the GPU: a uniform grid seen whole from above.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/bench/frame_stage.hpp"
#include "tests/bench/papers.hpp"
#include "tests/gpu/sea_probe.hpp"

namespace trochoid::bench {
namespace {

constexpr double water_m = 1'024;  // side of the water grid
constexpr uint32_t box_side_m = 4'000;
const Layers nothing{};
const Layers gerstner = Layers{}.with(Layer::trains);
const Layers refracted = gerstner.with(Layer::refraction);

/// Shifts that grow towards the middle of the water, a node every 64 m.
std::vector<FieldBlock> refraction_field() {
    std::vector<FieldBlock> blocks;
    for (int32_t bz = -1; bz < 1; ++bz)
        for (int32_t bx = -1; bx < 1; ++bx) {
            auto block = std::make_shared<LandBlock>();
            block->key = {bx, bz};
            block->gain.fill(unit_node_gain);
            for (int z = 0; z < block_nodes; ++z)
                for (int x = 0; x < block_nodes; ++x) {
                    const double nx = bx * block_cells + x;
                    const double nz = bz * block_cells + z;
                    block->shift[static_cast<size_t>(z * block_nodes + x)] =
                        static_cast<int32_t>(30'000 * std::exp(-(nx * nx + nz * nz) / 60.0));
                }
            blocks.push_back({FieldId{1}, 16, std::move(block)});
        }
    return blocks;
}

/// A box over the whole water with every effect, its travel turned by its id; out of reach of the water if not in view.
WaveTrainBox box_of(uint32_t id, int trains, bool in_view) {
    WaveTrainBox box;
    box.id = {id};
    box.first_train = {id * 16};
    box.begin = {-sea_time_bound};
    const double heading = 0.15 * id;
    box.ux = static_cast<int32_t>(std::lround(std::cos(heading) * 1073741824.0));
    box.uz = static_cast<int32_t>(std::lround(std::sin(heading) * 1073741824.0));
    box.length = box.width = to_lattice(box_side_m);
    box.ramp_rear = box.ramp_front = box.ramp_side = static_cast<int32_t>(to_lattice(100));
    const double c = std::cos(heading) * box_side_m / 2;
    const double s = std::sin(heading) * box_side_m / 2;
    const double away = in_view ? 0 : 100'000;
    box.origin = {to_lattice(away - (c - s)), to_lattice(-(s + c))};
    for (int i = 0; i < trains; ++i) {
        WaveTrain train = deep_train(100.0 / (1 + i + 0.3 * id), heading, 0.3F, 0.8F, id * 7919U);
        train.field = {1};
        box.trains.push_back(train);
    }
    box.irregular = {full_irregularity / 2, 900, 200, -200, 900, 80'000'000'000, 1U << 30, 1U << 28};
    box.roundness = full_roundness;
    return box;
}

/// The paper's noise acts everywhere: a box without trains or limits.
WaveTrainBox noise_box() {
    WaveTrainBox box;
    box.id = {1'000};
    box.first_train = {30'000};
    box.begin = {-sea_time_bound};
    box.noise.amplitude = 0.02F;
    box.noise.step_log2 = 12;
    box.noise.displayed_only = false;
    return box;
}

DrawOptions grid_of(uint32_t cells, Layers layers) {
    DrawOptions options = bare_options(MesherKind::uniform);
    options.grid_cells = cells;
    options.grid_spacing_m = static_cast<float>(water_m / cells);
    options.authoritative = true;
    options.layers = layers;
    options.triangles_per_draw = 20'000;
    return options;
}

/// The whole grid is in the picture.
Camera above(uint32_t width, uint32_t height) { return looking(1'600, -1.5707, width, height); }

FrameCost frame_of_grid(Stage& stage, const KnownSea& sea, const Camera& camera, const DrawOptions& options,
                        bool quick) {
    return stage.measure(scene_of(sea, camera, options), camera, options, quick ? 1 : 4, 1);
}
double work_ms(Stage& stage, const KnownSea& sea, const DrawOptions& options, bool quick) {
    return frame_of_grid(stage, sea, above(64, 36), options, quick).work_ms();
}

KnownSea seven(int visible) {
    KnownSea sea{{}, refraction_field()};
    for (uint32_t i = 0; i < 7; ++i) sea.boxes.push_back(box_of(i + 1, 1, static_cast<int>(i) < visible));
    return sea;
}

void table_1(Report& report, Stage& small, Stage& large) {
    constexpr double calculation[] = {3.20, 12.2, 49.9, 199};
    constexpr double rendering[] = {0.80, 2.80, 10.8, 44.0};
    constexpr const char* rate[] = {">75", "42", "13", "4"};
    fmt::print(
        "\nA, table 1: scenario 1, two boxes of 1 + 2 trains, refraction (paper A: Athlon 64, 2 GHz, waves on the CPU)\n"
        "{:>8} {:>16} {:>9} {:>16} {:>9} {:>10} {:>9}\n",
        "grid", "waves, paper ms", "ours ms", "drawing, paper", "ours ms", "fps paper", "ours");
    const KnownSea sea{{box_of(1, 1, true), box_of(2, 2, true)}, refraction_field()};
    nlohmann::json points, theirs, ours, ours_drawing;
    for (size_t i = 0; i < (report.quick() ? 2 : 4); ++i) {
        const uint32_t n = 64U << i;
        // The first pictures of a size also find memory.
        work_ms(small, sea, grid_of(n, refracted), true);
        const double flat = work_ms(small, seven(0), grid_of(n, nothing), report.quick());
        const double waves = work_ms(small, sea, grid_of(n, refracted), report.quick()) - flat;
        const double drawing =
            frame_of_grid(large, sea, above(640, 480), grid_of(n, nothing), report.quick()).work_ms();
        const double whole =
            frame_of_grid(large, sea, above(640, 480), grid_of(n, refracted), report.quick()).ms;
        fmt::print("{:>6}^2 {:>16.2f} {:>9.2f} {:>16.2f} {:>9.2f} {:>10} {:>9.1f}\n", n, calculation[i],
                   waves, rendering[i], drawing, rate[i], 1e3 / whole);
        report.figure(fmt::format("A: scenario 1, {}^2, waves, ms", n), waves);
        report.figure(fmt::format("A: scenario 1, {}^2, drawing, ms", n), drawing);
        report.figure(fmt::format("A: scenario 1, {}^2, fps", n), 1e3 / whole);
        points.push_back(n * n);
        theirs.push_back(calculation[i]);
        ours.push_back(std::max(waves, 1e-3));
        ours_drawing.push_back(drawing);
    }
    report.plot({{"title", "A, table 1: scenario 1 by grid points"},
                 {"x", "grid points"},
                 {"y", "ms"},
                 {"log", true},
                 {"curves",
                  {{{"name", "paper A, waves (CPU of 2005)"}, {"x", points}, {"y", theirs}, {"dashed", true}},
                   {{"name", "ours, waves (GPU)"}, {"x", points}, {"y", ours}},
                   {{"name", "ours, drawing the still grid"}, {"x", points}, {"y", ours_drawing}}}}});
}

void culled_one_by_one(Report& report, Stage& small) {
    fmt::print(
        "\nA: scenario 2, seven boxes of one train (paper A: 57.7 ms and 232.2 ms with all, 0.6 ms with none, 3-10 and 20-40 ms "
        "less a culled box)\n{:>8} {:>12} {:>12} {:>16} {:>16}\n",
        "in view", "256^2, ms", "512^2, ms", "less, 256^2 ms", "less, 512^2 ms");
    nlohmann::json visible, ours_small, ours_large;
    // In haste the smaller grid alone.
    const size_t sizes = report.quick() ? 1 : 2;
    double before[2] = {0, 0};
    double flat[2] = {0, 0};
    for (size_t k = 0; k < sizes; ++k)
        flat[k] = work_ms(small, seven(0), grid_of(256U << k, nothing), report.quick());
    for (int boxes = 7; boxes >= 0; boxes -= report.quick() ? 7 : 1) {
        double ms[2] = {0, 0};
        for (size_t k = 0; k < sizes; ++k) {
            ms[k] = work_ms(small, seven(boxes), grid_of(256U << k, refracted), report.quick()) - flat[k];
            report.figure(fmt::format("A: scenario 2, {} in view, {}^2, ms", boxes, 256U << k), ms[k]);
        }
        fmt::print("{:>8} {:>12.2f} {:>12.2f}", boxes, ms[0], ms[1]);
        if (boxes < 7) fmt::print(" {:>16.2f} {:>16.2f}", before[0] - ms[0], before[1] - ms[1]);
        fmt::print("\n");
        before[0] = ms[0];
        before[1] = ms[1];
        visible.push_back(boxes);
        ours_small.push_back(ms[0]);
        ours_large.push_back(ms[1]);
    }
    report.plot(
        {{"title", "A: scenario 2, waves by boxes in view"},
         {"x", "boxes in view"},
         {"y", "ms"},
         {"curves",
          {{{"name", "paper A, 512^2: all"}, {"x", {7}}, {"y", {232.2}}, {"dashed", true}},
           {{"name", "paper A, 256^2: none, all"}, {"x", {0, 7}}, {"y", {0.6, 57.7}}, {"dashed", true}},
           {{"name", "ours, 512^2"}, {"x", visible}, {"y", ours_large}},
           {{"name", "ours, 256^2"}, {"x", visible}, {"y", ours_small}}}}});
}

/// Share of the grid's vertices that an effect moves: one that moves none was not measured.
double share_moved(const KnownSea& sea, Layers layers) {
    const Camera camera = above(64, 36);
    const DrawOptions base = grid_of(256, gerstner);
    const SceneInput scene = scene_of(sea, camera, base);
    const Probe before = probe_sea(*scene.state, scene.now, camera, base);
    const Probe after = probe_sea(*scene.state, scene.now, camera, grid_of(256, layers));
    size_t moved = 0;
    for (size_t i = 0; i < before.vertices.size() && i < after.vertices.size(); ++i)
        if (before.vertices[i].shift[1] != after.vertices[i].shift[1]) ++moved;
    return static_cast<double>(moved) / static_cast<double>(std::max<size_t>(1, before.vertices.size()));
}

void table_2(Report& report, Stage& small) {
    struct Effect {
        const char* name;
        Layers layers;
        double theirs[2];  // ms, 256^2 and 512^2
    };
    const Effect effects[] = {{"refraction", refracted, {1.2, 6}},
                              {"noise", gerstner.with(Layer::noise), {3, 13}},
                              {"irregular heights", gerstner.with(Layer::irregular), {9.5, 39}},
                              {"round waves", gerstner.with(Layer::round), {0.5, 1.4}}};
    fmt::print("\nA, table 2: what each effect adds to scenario 2\n{:<20} {:>14} {:>12} {:>14} {:>12}\n",
               "effect", "paper 256^2", "ours 256^2", "paper 512^2", "ours 512^2");
    KnownSea sea = seven(7);
    sea.boxes.push_back(noise_box());
    const size_t sizes = report.quick() ? 1 : 2;
    double base[2] = {0, 0};
    for (size_t k = 0; k < sizes; ++k)
        base[k] = work_ms(small, sea, grid_of(256U << k, gerstner), report.quick());
    std::vector<std::string> names;
    std::vector<double> values[4];
    for (const Effect& effect : effects) {
        double ours[2] = {0, 0};
        for (size_t k = 0; k < sizes; ++k) {
            ours[k] = work_ms(small, sea, grid_of(256U << k, effect.layers), report.quick()) - base[k];
            report.figure(fmt::format("A: {} adds, {}^2, ms", effect.name, 256U << k), ours[k]);
            values[k].push_back(effect.theirs[k]);
            values[2 + k].push_back(ours[k]);
        }
        fmt::print("{:<20} {:>14.1f} {:>12.2f} {:>14.1f} {:>12.2f}\n", effect.name, effect.theirs[0], ours[0],
                   effect.theirs[1], ours[1]);
        const double moved = share_moved(sea, effect.layers);
        fmt::print("{:<20} moves {:.0f}% of the vertices\n", "", 100 * moved);
        report.at_least(fmt::format("A: {}: vertices that it moves", effect.name), 100 * moved, 50, "%");
        names.emplace_back(effect.name);
    }
    report.plot({{"title", "A, table 2: what each effect adds"},
                 {"x", "effect"},
                 {"y", "ms"},
                 {"categories", names},
                 {"bars",
                  {{{"name", "paper A, 256^2"}, {"values", values[0]}, {"dashed", true}},
                   {{"name", "paper A, 512^2"}, {"values", values[1]}, {"dashed", true}},
                   {{"name", "ours, 256^2"}, {"values", values[2]}},
                   {{"name", "ours, 512^2"}, {"values", values[3]}}}}});
}

}  // namespace

void paper_a(Report& report) {
    Stage small(64, 36);
    Stage large(640, 480);
    table_1(report, small, large);
    culled_one_by_one(report, small);
    table_2(report, small);
}

}  // namespace trochoid::bench
