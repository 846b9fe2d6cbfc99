// P3: batched authoritative queries, four Newton steps each, one core.
#include <cmath>
#include <string>
#include <vector>

#include "protocol/model/point_query.hpp"
#include "protocol/model/simd/vector_target.hpp"
#include "protocol/model/simd/water_batch.hpp"
#include "tests/bench/grid_case.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/stopwatch.hpp"

namespace trochoid::bench {
namespace {

/// A coast's field: shift, gain and orbit vary at every 64 m node.
std::shared_ptr<const LandField> coast_field(uint32_t id) {
    auto field = std::make_shared<LandField>(FieldId{id}, uint8_t{16});
    for (int32_t bz = -3; bz < 3; ++bz)
        for (int32_t bx = -3; bx < 3; ++bx) {
            auto block = std::make_shared<LandBlock>();
            block->key = {bx, bz};
            for (int z = 0; z < block_nodes; ++z)
                for (int x = 0; x < block_nodes; ++x) {
                    const double nx = bx * block_cells + x;
                    const double nz = bz * block_cells + z;
                    const auto i = static_cast<size_t>(z * block_nodes + x);
                    block->shift[i] = static_cast<int32_t>(40'000 * std::sin(0.07 * nx + id) + 9'000 * nz);
                    block->gain[i] = static_cast<uint16_t>(26'000 + 6'000 * std::sin(0.11 * nz + 0.05 * nx));
                    block->orbit[i] = static_cast<uint16_t>(20'000 + 3'000 * std::sin(0.09 * nx));
                }
            field->set(std::move(block));
        }
    return field;
}

/// The 60 trains of open_sea, in four bands of 15, each with a field of its own.
Sea coast_sea() {
    const Sea open = open_sea(60);
    WaveTrainBox box = open.boxes()[0]->record;
    std::vector<std::shared_ptr<const LandField>> fields;
    for (uint32_t band = 0; band < 4; ++band) {
        fields.push_back(coast_field(band + 1));
        for (size_t i = 0; i < 15; ++i) box.trains[band * 15 + i].field = {band + 1};
    }
    return Sea({prepare(std::move(box), fields)});
}

/// open_sea(60) so steep (0.7; the limit is 0.8) that the search takes more of its steps.
Sea steep_sea() {
    const Sea open = open_sea(60);
    WaveTrainBox box = open.boxes()[0]->record;
    for (WaveTrain& train : box.trains) train.amplitude *= 3.5F;
    return Sea({prepare(std::move(box), {})});
}

/// Places spread over 3 km, as ships and buoys are.
std::vector<LatticePoint> spread(size_t count) {
    std::vector<LatticePoint> places(count);
    for (size_t i = 0; i < count; ++i)
        places[i] = {static_cast<int64_t>(i * 2654435761U % 3'072'000) - 1'536'000,
                     static_cast<int64_t>(i * 40503U * 977U % 3'072'000) - 1'536'000};
    return places;
}

struct Bar {
    const char* target;
    double nanoseconds;
    double milliseconds;
};
constexpr Bar bars[] = {{"AVX3", 3.0, 0.18}, {"AVX2", 5.0, 0.30}};

void bench(Report& report) {
    constexpr double trains = 60.0;
    const std::vector<LatticePoint> places = spread(1000);
    std::vector<WaterPoint> water(places.size());
    const SeaInstant open(open_sea(60), {123'456'789});
    const SeaInstant coast(coast_sea(), {123'456'789});
    const SeaInstant steep(steep_sea(), {123'456'789});
    Workers one_core(1);
    const std::vector<std::string> targets = vector_targets();
    std::vector<std::function<void()>> contenders{[&] {
        for (size_t i = 0; i < 100; ++i) water[i] = water_at(open, places[i]);
    }};
    for (const std::string& target : targets)
        for (const SeaInstant* sea : {&open, &coast, &steep})
            contenders.emplace_back([&, target, sea] {
                force_vector_target(target);
                water_at_batch(*sea, places, water, one_core);
            });
    const Interleaved times(contenders, report.quick() ? 7 : 41, report.quick() ? 0.002 : 0.01);
    const double count = static_cast<double>(places.size());

    fmt::print("{:<20} {:>14} {:>15} {:>10} {:>15} {:>9}\n", "1000 places x 60", "open, ns/train",
               "coast, ns/train", "coast/open", "steep, ns/train", "open, ms");
    fmt::print("{:<20} {:>14.2f}\n", "one by one", times.time(0) * 1e9 / (100 * trains));
    double best = 0.0;
    std::vector<double> values[3];
    for (size_t i = 0; i < targets.size(); ++i) {
        const double open_ns = times.time(1 + 3 * i) * 1e9 / (count * trains);
        const double coast_ns = times.time(2 + 3 * i) * 1e9 / (count * trains);
        const double ratio = times.ratio(2 + 3 * i, 1 + 3 * i);
        const double whole = times.time(1 + 3 * i) * 1e3;
        const double steep_ns = times.time(3 + 3 * i) * 1e9 / (count * trains);
        if (i == 0) best = open_ns;
        fmt::print("{:<20} {:>14.2f} {:>15.2f} {:>10.2f} {:>15.2f} {:>9.3f}\n", targets[i], open_ns, coast_ns,
                   ratio, steep_ns, whole);
        values[0].push_back(open_ns);
        values[1].push_back(coast_ns);
        values[2].push_back(steep_ns);
        report.figure(targets[i] + " open ns per train and query", open_ns);
        report.figure(targets[i] + " coast ns per train and query", coast_ns);
        report.figure(targets[i] + " steep ns per train and query", steep_ns);
        for (const Bar& bar : bars)
            if (targets[i] == bar.target) {
                report.at_most(targets[i] + ": per train and query", open_ns, bar.nanoseconds, " ns");
                report.at_most(targets[i] + ": with four bands' fields", ratio, 1.6, "x");
                report.at_most(targets[i] + ": 1000 x 60", whole, bar.milliseconds, " ms");
            }
    }
    force_vector_target("");
    for (const SeaInstant* sea : {&open, &coast, &steep}) {
        water_at_batch(*sea, places, water, one_core);
        size_t wrong = 0;
        for (size_t i = 0; i < places.size(); i += 17)
            wrong += water[i] == water_at(*sea, places[i]) ? 0U : 1U;
        report.at_most("answers that differ from one by one", static_cast<double>(wrong), 0);
    }
    report.plot({{"title", "1000 places x 60 trains, one core"},
                 {"x", "instruction set"},
                 {"y", "ns per train and query"},
                 {"log", true},
                 {"categories", targets},
                 {"bars",
                  {{{"name", "open water"}, {"values", values[0]}},
                   {{"name", "open water, steepness 0.7"}, {"values", values[2]}},
                   {{"name", "four bands' land fields"}, {"values", values[1]}}}}});
    report.write(fmt::format("{:.2f} ns per train and query ({})", best, targets[0]));
}

}  // namespace
}  // namespace trochoid::bench

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, trochoid::bench::bench); }
