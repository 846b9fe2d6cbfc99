// P2: scenarios 1 and 2 of paper A (tables 1 and 2, and the text between), theirs beside ours, and what culling saves.
#include <cmath>
#include <string>
#include <vector>

#include "protocol/model/simd/sea_grid.hpp"
#include "protocol/model/simd/vector_target.hpp"
#include "tests/bench/grid_case.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/stopwatch.hpp"

namespace trochoid::bench {
namespace {

constexpr int64_t side = 2048 * 1024;  // of the water grid, lattice units: 2 km

/// Effects of paper A's table 2.
struct Effects {
    bool refraction = true;
    bool noise = false;
    bool irregular = false;
    bool round = false;
};

/// Depth-dependent refraction: a shift that grows towards the middle of the water, a node every 64 m.
std::shared_ptr<const LandField> refraction_field() {
    auto field = std::make_shared<LandField>(FieldId{1}, uint8_t{16});
    for (int32_t bz = 0; bz < 2; ++bz)
        for (int32_t bx = 0; bx < 2; ++bx) {
            auto block = std::make_shared<LandBlock>();
            block->key = {bx, bz};
            block->gain.fill(unit_node_gain);
            for (int z = 0; z < block_nodes; ++z)
                for (int x = 0; x < block_nodes; ++x) {
                    const double nx = bx * block_cells + x - 16;
                    const double nz = bz * block_cells + z - 16;
                    block->shift[static_cast<size_t>(z * block_nodes + x)] =
                        static_cast<int32_t>(30'000 * std::exp(-(nx * nx + nz * nz) / 60.0));
                }
            field->set(std::move(block));
        }
    return field;
}

/// A square box with `trains` trains around a centre, its travel direction turned by its id.
std::shared_ptr<const PreparedBox> box_at(uint32_t id, int trains, LatticePoint centre, int64_t extent,
                                          const Effects& effects) {
    const Sea some = open_sea(24);
    const std::vector<WaveTrain>& supply = some.boxes()[0]->record.trains;
    WaveTrainBox box;
    box.id = {id};
    box.first_train = {id * 16};
    const double heading = 0.15 * id;
    box.ux = static_cast<int32_t>(std::lround(std::cos(heading) * 1073741824.0));
    box.uz = static_cast<int32_t>(std::lround(std::sin(heading) * 1073741824.0));
    box.length = box.width = extent;
    box.ramp_rear = box.ramp_front = box.ramp_side = 100 * 1024;
    const double c = std::cos(heading) * static_cast<double>(extent / 2);
    const double s = std::sin(heading) * static_cast<double>(extent / 2);
    box.origin = {centre.x - static_cast<int64_t>(c - s), centre.z - static_cast<int64_t>(s + c)};
    for (int i = 0; i < trains; ++i) {
        WaveTrain train = supply[(id * 3 + static_cast<uint32_t>(i)) % supply.size()];
        train.field = {effects.refraction ? 1U : 0U};
        box.trains.push_back(train);
    }
    if (effects.irregular)
        box.irregular = {full_irregularity / 2, 900, 200, -200, 900, 80'000'000'000, 1U << 30, 1U << 28};
    if (effects.round) box.roundness = full_roundness;
    std::vector<std::shared_ptr<const LandField>> fields;
    if (effects.refraction) fields.push_back(refraction_field());
    return prepare(std::move(box), fields);
}

/// A box over the whole water, however turned, moved to the east by `east`.
std::shared_ptr<const PreparedBox> box_over(uint32_t id, int trains, int64_t east, const Effects& effects) {
    return box_at(id, trains, {side / 2 + east, side / 2}, 2 * side, effects);
}

/// Paper A's noise acts everywhere: a box without trains or limits.
std::shared_ptr<const PreparedBox> noise_box() {
    WaveTrainBox box;
    box.id = {1000};
    box.first_train = {30'000};
    box.noise.amplitude = 0.02F;
    box.noise.step_log2 = 12;
    return prepare(std::move(box), {});
}

/// One scene and the planes that its points go to: displacement and normal, as the paper's water grid.
class Scene {
public:
    Scene(std::vector<std::shared_ptr<const PreparedBox>> boxes, int32_t n, const Effects& effects = {})
        : instant_(Sea(with_noise(std::move(boxes), effects)), {123'456'789}, displayed_layers),
          grid_{{0, 0}, side / n, side / n, n, n} {
        for (auto& plane : planes_) plane.resize(grid_.size());
    }
    void evaluate(Workers& workers) {
        evaluate_grid(instant_, grid_,
                      SurfacePlanes{.ax = planes_[0].data(),
                                    .ay = planes_[1].data(),
                                    .az = planes_[2].data(),
                                    .nx = planes_[3].data(),
                                    .ny = planes_[4].data(),
                                    .nz = planes_[5].data()},
                      workers);
    }

private:
    static std::vector<std::shared_ptr<const PreparedBox>> with_noise(
        std::vector<std::shared_ptr<const PreparedBox>> boxes, const Effects& effects) {
        if (effects.noise) boxes.push_back(noise_box());
        return boxes;
    }
    SeaInstant instant_;
    LatticeGrid grid_;
    std::vector<float> planes_[6];
};

/// Times of scenes on one core, interleaved.
std::vector<double> times_of(std::vector<Scene*> scenes, const Report& report, int more_rounds = 1) {
    Workers one_core(1);
    std::vector<std::function<void()>> contenders;
    for (Scene* scene : scenes) contenders.emplace_back([scene, &one_core] { scene->evaluate(one_core); });
    const Interleaved measured(contenders, more_rounds * (report.quick() ? 5 : 21),
                               report.quick() ? 0.002 : 0.02);
    std::vector<double> times;
    for (size_t i = 0; i < scenes.size(); ++i) times.push_back(measured.time(i));
    return times;
}

std::vector<std::shared_ptr<const PreparedBox>> seven(int visible, const Effects& effects) {
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (int i = 0; i < 7; ++i)
        boxes.push_back(box_over(static_cast<uint32_t>(i + 1), 1, i < visible ? 0 : 8 * side, effects));
    return boxes;
}

void scenario_1(Report& report) {
    constexpr double theirs[] = {3.20, 12.2, 49.9, 199.0};
    std::vector<std::unique_ptr<Scene>> scenes;
    std::vector<Scene*> pointers;
    const Effects effects;
    for (const int32_t n : {64, 128, 256, 512}) {
        scenes.push_back(
            std::make_unique<Scene>(std::vector{box_over(1, 1, 0, effects), box_over(2, 2, 0, effects)}, n));
        pointers.push_back(scenes.back().get());
    }
    const std::vector<double> times = times_of(pointers, report);
    fmt::print("scenario 1: two boxes, 1 + 2 trains, refraction\n{:>10} {:>14} {:>10} {:>8} {:>12}\n", "grid",
               "paper, ms", "ours, ms", "ratio", "ns/point");
    nlohmann::json points = nlohmann::json::array();
    nlohmann::json paper = nlohmann::json::array();
    nlohmann::json ours = nlohmann::json::array();
    for (size_t i = 0; i < 4; ++i) {
        const int n = 64 << i;
        fmt::print("{:>6}^2 {:>14.2f} {:>10.4f} {:>8.0f} {:>12.2f}\n", n, theirs[i], times[i] * 1e3,
                   theirs[i] / (times[i] * 1e3), times[i] * 1e9 / (n * n));
        report.figure(fmt::format("scenario 1, {}^2, ms", n), times[i] * 1e3);
        points.push_back(n * n);
        paper.push_back(theirs[i]);
        ours.push_back(times[i] * 1e3);
    }
    report.plot({{"title", "Scenario 1: 2 boxes, 3 trains, refraction (paper A, table 1)"},
                 {"x", "grid points"},
                 {"y", "ms"},
                 {"log", true},
                 {"curves",
                  {{{"name", "paper A (Athlon 64, 2 GHz)"}, {"x", points}, {"y", paper}, {"dashed", true}},
                   {{"name", "ours, one core"}, {"x", points}, {"y", ours}}}}});
    const double growth = (times[3] / times[1]) / 16.0;
    report.at_most("cost of a point, 512^2 against 128^2", growth, 1.25, "x");
    report.at_least("cost of a point, 512^2 against 128^2", growth, 0.75, "x");
}

void scenario_2(Report& report) {
    const Effects effects;
    std::vector<std::unique_ptr<Scene>> scenes;
    std::vector<Scene*> pointers;
    for (const int32_t n : {256, 512})
        for (int visible = 7; visible >= 0; --visible) {
            scenes.push_back(std::make_unique<Scene>(seven(visible, effects), n));
            pointers.push_back(scenes.back().get());
        }
    const std::vector<double> times = times_of(pointers, report);
    fmt::print(
        "\nscenario 2: seven boxes of one train, refraction; paper: 57.7 ms and 232.2 ms with all seven, 0.6 ms with none, "
        "3-10 and 20-40 ms less a culled box\n{:>10} {:>12} {:>12} {:>14} {:>14}\n",
        "visible", "256^2, ms", "512^2, ms", "gain 256^2", "gain 512^2");
    for (size_t i = 0; i < 8; ++i) {
        const auto gain = [&](size_t at) { return i == 0 ? 0.0 : (times[at - 1] - times[at]) * 1e3; };
        fmt::print("{:>10} {:>12.4f} {:>12.4f} {:>14.4f} {:>14.4f}\n", 7 - i, times[i] * 1e3,
                   times[8 + i] * 1e3, gain(i), gain(8 + i));
        report.figure(fmt::format("scenario 2, {} visible, 256^2, ms", 7 - i), times[i] * 1e3);
        report.figure(fmt::format("scenario 2, {} visible, 512^2, ms", 7 - i), times[8 + i] * 1e3);
    }
    nlohmann::json visible = nlohmann::json::array();
    nlohmann::json small = nlohmann::json::array();
    nlohmann::json large = nlohmann::json::array();
    for (size_t i = 0; i < 8; ++i) {
        visible.push_back(7 - i);
        small.push_back(times[i] * 1e3);
        large.push_back(times[8 + i] * 1e3);
    }
    report.plot(
        {{"title", "Scenario 2: 7 boxes of one train, refraction"},
         {"x", "boxes in view"},
         {"y", "ms"},
         {"log_y", true},
         {"curves",
          {{{"name", "paper A, 512^2: all"}, {"x", {7}}, {"y", {232.2}}, {"points", true}},
           {{"name", "paper A, 256^2: none and all"}, {"x", {0, 7}}, {"y", {0.6, 57.7}}, {"points", true}},
           {{"name", "ours, 512^2, one core"}, {"x", visible}, {"y", large}},
           {{"name", "ours, 256^2, one core"}, {"x", visible}, {"y", small}}}}});
}

void effects_table(Report& report) {
    struct Row {
        const char* name;
        Effects effects;
        double small, large;  // paper's ms
    };
    const Row rows[] = {{"none", {false, false, false, false}, 0, 0},
                        {"refraction", {true, false, false, false}, 1.2, 6},
                        {"noise", {false, true, false, false}, 3, 13},
                        {"irregular heights", {false, false, true, false}, 9.5, 39},
                        {"round waves", {false, false, false, true}, 0.5, 1.4}};
    std::vector<std::unique_ptr<Scene>> scenes;
    std::vector<Scene*> pointers;
    for (const int32_t n : {256, 512})
        for (const Row& row : rows) {
            scenes.push_back(std::make_unique<Scene>(seven(7, row.effects), n, row.effects));
            pointers.push_back(scenes.back().get());
        }
    const std::vector<double> times = times_of(pointers, report);
    fmt::print(
        "\nwhat each effect adds to scenario 2, all seven visible\n{:<20} {:>14} {:>12} {:>14} {:>12}\n",
        "effect", "paper 256^2", "ours 256^2", "paper 512^2", "ours 512^2");
    std::vector<std::string> names;
    std::vector<double> values[4];
    for (size_t i = 0; i < std::size(rows); ++i) {
        const double small = (times[i] - (i == 0 ? 0.0 : times[0])) * 1e3;
        const double large = (times[std::size(rows) + i] - (i == 0 ? 0.0 : times[std::size(rows)])) * 1e3;
        fmt::print("{:<20} {:>14.1f} {:>12.4f} {:>14.1f} {:>12.4f}\n", rows[i].name, rows[i].small, small,
                   rows[i].large, large);
        report.figure(fmt::format("{} adds, 256^2, ms", rows[i].name), small);
        report.figure(fmt::format("{} adds, 512^2, ms", rows[i].name), large);
        if (i == 0) continue;
        names.push_back(rows[i].name);
        values[0].push_back(rows[i].small);
        values[1].push_back(rows[i].large);
        values[2].push_back(small);
        values[3].push_back(large);
    }
    report.plot({{"title", "What each effect adds to scenario 2 (paper A, table 2)"},
                 {"x", "effect"},
                 {"y", "ms"},
                 {"log", true},
                 {"categories", names},
                 {"bars",
                  {{{"name", "paper A, 256^2"}, {"values", values[0]}, {"dashed", true}},
                   {{"name", "paper A, 512^2"}, {"values", values[1]}, {"dashed", true}},
                   {{"name", "ours, 256^2"}, {"values", values[2]}},
                   {{"name", "ours, 512^2"}, {"values", values[3]}}}}});
}

void culling(Report& report) {
    constexpr int32_t n = 512;
    constexpr int many = 200;
    constexpr int trains = 30;
    const Effects plain{.refraction = false};
    // A box of 1.2 km, ramps included; whole in the water of 2 km, half beyond its eastern edge, and elsewhere.
    const int64_t extent = side * 3 / 5;
    std::vector<std::shared_ptr<const PreparedBox>> boxes{
        box_at(1, trains, {side / 2, side / 2}, extent, plain)};
    Scene none({}, n);
    Scene whole(boxes, n);
    Scene half({box_at(1, trains, {side, side / 2}, extent, plain)}, n);
    for (uint32_t i = 0; i < many; ++i) boxes.push_back(box_over(2 + i, trains, 8 * side, plain));
    Scene culled(boxes, n);
    const std::vector<double> times = times_of({&none, &whole, &half, &culled}, report, 5);
    const double visible = times[1] - times[0];
    const double out_of_view = std::max(0.0, (times[3] - times[1]) / many);
    const double partly = times[2] - times[0];
    fmt::print(
        "\nculling, 512^2, a box of {} trains: in view {:.4f} ms, out of view {:.6f} ms, half in view {:.4f} ms\n",
        trains, visible * 1e3, out_of_view * 1e3, partly * 1e3);
    report.at_most("a culled box against a visible one", 100 * out_of_view / visible, 1.0, "%");
    report.at_most("a box half in view against a whole one", 100 * partly / visible, 60.0, "%");
}

void large_grid(Report& report) {
    if (!force_vector_target("AVX2")) {
        fmt::print("\nthis machine has no AVX2: 1024^2 is not measured\n");
        return;
    }
    GridCase grid(6, 1024);
    Workers two_cores(2);
    Workers one_core(1);
    const Interleaved wall({[&] { grid.evaluate(two_cores); }}, report.quick() ? 9 : 41, 0.0, Clock::wall);
    const Interleaved own({[&] { grid.evaluate(one_core); }}, report.quick() ? 5 : 21, 0.0);
    force_vector_target("");
    fmt::print(
        "1024^2 x 6 with normals, AVX2: {:.2f} ms on 2 cores by the wall clock, {:.2f} ms of one core's time\n",
        wall.time(0) * 1e3, own.time(0) * 1e3);
    report.at_most("1024^2 x 6 trains with normals, 2 AVX2 cores", wall.time(0) * 1e3, 6.0, " ms");
    report.figure("1024^2 x 6, two AVX2 cores, ms", wall.time(0) * 1e3);
    report.figure("1024^2 x 6, one AVX2 core, ms", own.time(0) * 1e3);
}

void bench(Report& report) {
    scenario_1(report);
    scenario_2(report);
    effects_table(report);
    culling(report);
    large_grid(report);
    report.write(fmt::format("{:.2f} ms for seven boxes on 256^2, paper 57.7 ms;",
                             report.kept("scenario 2, 7 visible, 256^2, ms")));
}

}  // namespace
}  // namespace trochoid::bench

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, trochoid::bench::bench); }
