#include "protocol/model/simd/coarse_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/simd/random_sea.hpp"

namespace trochoid {
namespace {

struct Planes {
    explicit Planes(size_t n) : values(15, std::vector<float>(n)) {}
    SurfacePlanes pointers() {
        return {values[0].data(),  values[1].data(),  values[2].data(),  values[3].data(),
                values[4].data(),  values[5].data(),  values[6].data(),  values[7].data(),
                values[8].data(),  values[9].data(),  values[10].data(), values[11].data(),
                values[12].data(), values[13].data(), values[14].data()};
    }
    std::vector<std::vector<float>> values;
};

double largest_difference(const Planes& a, const Planes& b, size_t plane) {
    double most = 0.0;
    for (size_t i = 0; i < a.values[plane].size(); ++i)
        most = std::max(most, std::abs(static_cast<double>(a.values[plane][i]) -
                                       static_cast<double>(b.values[plane][i])));
    return most;
}

/// Open water with long waves; some boxes are limited, and their trains may not be interpolated near the edges.
SeaInstant long_sea(uint64_t seed) {
    RandomSeaOptions options{.boxes = 5, .trains = 12, .land = seed % 2 == 0};
    return {random_sea(seed, options), {30'000'000}};
}

TEST(CoarseGrid, TheBoundHoldsEverywhere) {
    int interpolated = 0;
    for (uint64_t seed = 1; seed <= 40; ++seed)
        for (const int factor : {2, 4, 8, 16}) {
            const SeaInstant sea = long_sea(seed);
            const LatticeGrid grid{{-100'000, 40'000}, 1024, 700, 101, 67};
            Planes exact(grid.size());
            Planes coarse(grid.size());
            Workers workers(2);
            evaluate_grid(sea, grid, exact.pointers(), workers);
            const CoarseBound bound =
                evaluate_coarse_grid(sea, grid, coarse.pointers(), {.factor = factor, .ratio = 6.0}, workers);
            interpolated += bound.trains;
            EXPECT_LE(largest_difference(exact, coarse, 0), bound.horizontal) << seed;
            EXPECT_LE(largest_difference(exact, coarse, 1), bound.height) << seed;
            EXPECT_LE(largest_difference(exact, coarse, 2), bound.horizontal) << seed;
            EXPECT_LE(largest_difference(exact, coarse, 7), bound.slope) << seed;
            EXPECT_LE(largest_difference(exact, coarse, 8), bound.slope) << seed;
        }
    EXPECT_GT(interpolated, 100);
}

TEST(CoarseGrid, OneWaveComesNearItsBound) {
    WaveTrainBox box;
    box.id = {1};
    box.first_train = {1};
    box.trains.push_back({41943, 0, 1'000'000'000'000, 0, 1.0F, 1.0F, {}});  // 100 m
    const SeaInstant sea(Sea({prepare(box, {})}), {0});
    const LatticeGrid grid{{0, 0}, 1024, 1024, 200, 8};
    Planes exact(grid.size());
    Planes coarse(grid.size());
    Workers workers(1);
    evaluate_grid(sea, grid, exact.pointers(), workers);
    const CoarseBound bound =
        evaluate_coarse_grid(sea, grid, coarse.pointers(), {.factor = 8, .ratio = 4.0}, workers);
    EXPECT_EQ(bound.trains, 1);
    // (2 pi / 100 m * 8 m)^2 / 8
    EXPECT_NEAR(bound.height, 0.03158, 1e-4);
    const double found = largest_difference(exact, coarse, 1);
    EXPECT_LE(found, bound.height);
    EXPECT_GT(found, 0.8 * bound.height);
}

TEST(CoarseGrid, FieldsKeepWhatTheyLieOver) {
    const auto field = [](uint32_t id, BlockKey key, std::shared_ptr<const LandField> base) {
        auto made = std::make_shared<LandField>(FieldId{id}, uint8_t{16});
        auto block = std::make_shared<LandBlock>();
        block->key = key;
        made->set(std::move(block));
        made->set_base(std::move(base));
        return made;
    };
    // The lower field alone has a block here: no wave gets past it.
    const std::vector<std::shared_ptr<const LandField>> fields{field(1, {0, 0}, nullptr),
                                                               field(2, {5, 5}, nullptr)};
    WaveTrainBox box;
    box.id = {1};
    box.first_train = {1};
    box.overlays = {{{2}, {1}}};
    box.trains.push_back({41943, 0, 1'000'000'000'000, 0, 1.0F, 1.0F, {}});           // 100 m
    box.trains.push_back({419430, 0, 3'000'000'000'000, 0, 1.0F, 1.0F, FieldId{2}});  // 10 m
    const SeaInstant sea(Sea({prepare(box, fields)}), {0});
    const LatticeGrid grid{{0, 0}, 1024, 1024, 100, 8};
    Planes exact(grid.size());
    Planes coarse(grid.size());
    Workers workers(1);
    evaluate_grid(sea, grid, exact.pointers(), workers);
    const CoarseBound bound =
        evaluate_coarse_grid(sea, grid, coarse.pointers(), {.factor = 8, .ratio = 4.0}, workers);
    EXPECT_EQ(bound.trains, 1);
    EXPECT_LE(largest_difference(exact, coarse, 1), bound.height);
}

TEST(CoarseGrid, NothingLongIsTheExactGrid) {
    const SeaInstant sea = long_sea(3);
    const LatticeGrid grid{{-100'000, 40'000}, 1024, 1024, 70, 20};
    Planes exact(grid.size());
    Planes coarse(grid.size());
    Workers workers(1);
    evaluate_grid(sea, grid, exact.pointers(), workers);
    const CoarseBound bound =
        evaluate_coarse_grid(sea, grid, coarse.pointers(), {.factor = 16, .ratio = 1e6}, workers);
    EXPECT_EQ(bound.trains, 0);
    EXPECT_EQ(exact.values, coarse.values);
}

TEST(CoarseGrid, TheSameForAnyNumberOfThreads) {
    const LatticeGrid grid{{-100'000, 40'000}, 1024, 1024, 150, 90};
    Workers workers(1);
    Workers seven(7);
    const CoarseOptions options{.factor = 4, .ratio = 8.0};
    int interpolated = 0;
    for (uint64_t seed = 1; seed <= 8; ++seed) {
        const SeaInstant sea = long_sea(seed);
        Planes one(grid.size());
        Planes many(grid.size());
        interpolated += evaluate_coarse_grid(sea, grid, one.pointers(), options, workers).trains;
        evaluate_coarse_grid(sea, grid, many.pointers(), options, seven);
        EXPECT_EQ(one.values, many.values) << seed;
    }
    EXPECT_GT(interpolated, 0);
}

}  // namespace
}  // namespace trochoid
