#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <random>

#include "protocol/model/point_query.hpp"
#include "protocol/model/self_check.hpp"
#include "protocol/model/simd/sea_grid.hpp"
#include "protocol/model/simd/vector_target.hpp"
#include "protocol/model/simd/water_batch.hpp"
#include "tests/unit/simd/random_sea.hpp"

namespace trochoid {
namespace {

/// Every test runs once for each instruction set that this machine has.
class OnTarget : public testing::TestWithParam<std::string> {
protected:
    void SetUp() override { ASSERT_TRUE(force_vector_target(GetParam())); }
    void TearDown() override { force_vector_target(""); }
};

constexpr const char* value_names[15] = {"ax", "ay", "az", "pxx", "pxz", "pzx", "pzz", "yx",
                                         "yz", "nx", "ny", "nz",  "vx",  "vy",  "vz"};

/// The first value whose bits differ, or "". The sign of a zero counts.
template <class T>
std::string difference(const T& got, const T& wanted, const char* const* names, size_t values) {
    const auto* a = reinterpret_cast<const unsigned char*>(&got);
    const auto* b = reinterpret_cast<const unsigned char*>(&wanted);
    for (size_t i = 0; i < values; ++i)
        if (std::memcmp(a + i * 4, b + i * 4, 4) != 0) {
            float x = 0;
            float y = 0;
            std::memcpy(&x, a + i * 4, 4);
            std::memcpy(&y, b + i * 4, 4);
            return std::string(names[i]) + " " + std::to_string(x) + " instead of " + std::to_string(y);
        }
    return "";
}

void expect_grid(const SeaInstant& sea, const LatticeGrid& grid, unsigned threads, const std::string& what) {
    Workers workers(threads);
    std::vector<SurfaceSample> samples(grid.size());
    evaluate_grid(sea, grid, samples, workers);
    for (int32_t j = 0; j < grid.nz; ++j)
        for (int32_t i = 0; i < grid.nx; ++i) {
            const SurfaceSample wanted = sea.evaluate(grid.at(i, j));
            const auto at = static_cast<size_t>(j) * static_cast<size_t>(grid.nx) + static_cast<size_t>(i);
            const std::string off = difference(samples[at], wanted, value_names, 15);
            ASSERT_EQ(off, "") << what << ", point " << i << ", " << j << ", " << threads << " threads";
        }
}

void expect_water(const SeaInstant& sea, const std::vector<LatticePoint>& places, unsigned threads,
                  const std::string& what) {
    static constexpr const char* names[7] = {"height", "nx", "ny", "nz", "vx", "vy", "vz"};
    Workers workers(threads);
    std::vector<WaterPoint> water(places.size());
    water_at_batch(sea, places, water, workers);
    for (size_t i = 0; i < places.size(); ++i) {
        const WaterPoint wanted = water_at(sea, places[i]);
        ASSERT_EQ(difference(water[i], wanted, names, 7), "") << what << ", place " << i;
        ASSERT_EQ(water[i].rest, wanted.rest) << what << ", place " << i;
    }
    std::vector<SurfaceSample> samples(places.size());
    evaluate_batch(sea, places, samples, workers);
    for (size_t i = 0; i < places.size(); ++i)
        ASSERT_EQ(difference(samples[i], sea.evaluate(places[i]), value_names, 15), "")
            << what << ", rest point " << i;
}

std::vector<LatticePoint> random_places(uint64_t seed, size_t count, LatticePoint centre, int64_t reach) {
    std::mt19937_64 dice(seed);
    std::uniform_int_distribution<int64_t> off(-reach, reach);
    std::vector<LatticePoint> places(count);
    for (LatticePoint& p : places) p = {centre.x + off(dice), centre.z + off(dice)};
    return places;
}

TEST_P(OnTarget, GridsOfRandomSeasOfEveryFeature) {
    for (uint64_t seed = 1; seed <= 24; ++seed) {
        const Sea sea = random_sea(seed);
        const Layers layers = seed % 4 == 0 ? displayed_layers : authoritative_layers;
        const SeaInstant instant(sea, {static_cast<int64_t>(seed) * 3'000'000}, layers);
        // Odd sizes and steps from centimetres (many points a land cell) to beyond a cell.
        const int64_t step = int64_t{1} << (2 * (seed % 9));
        const LatticeGrid grid{
            {-70 * step, -20 * step}, step + static_cast<int64_t>(seed % 3), 2 * step + 1, 131, 37};
        expect_grid(instant, grid, 1, "seed " + std::to_string(seed));
    }
}

TEST_P(OnTarget, EachFeatureAlone) {
    const std::pair<const char*, bool RandomSeaOptions::*> features[] = {
        {"land", &RandomSeaOptions::land},          {"irregular", &RandomSeaOptions::irregular},
        {"round", &RandomSeaOptions::round},        {"noise", &RandomSeaOptions::noise},
        {"wakes", &RandomSeaOptions::wakes},        {"moving", &RandomSeaOptions::moving},
        {"unlimited", &RandomSeaOptions::unlimited}};
    for (const auto& [name, feature] : features)
        for (uint64_t seed = 100; seed < 104; ++seed) {
            RandomSeaOptions options{.land = false,
                                     .orbits = seed % 2 == 0,
                                     .irregular = false,
                                     .round = false,
                                     .noise = false,
                                     .wakes = false,
                                     .moving = false,
                                     .unlimited = false};
            options.*feature = true;
            const SeaInstant instant(random_sea(seed, options), {20'000'000}, displayed_layers);
            const LatticeGrid grid{{-800'000, -700'000}, 11'003, 23'001, 150, 65};
            expect_grid(instant, grid, 1, std::string(name) + ", seed " + std::to_string(seed));
        }
}

TEST_P(OnTarget, LayersSwitchedOffOneByOne) {
    const Sea sea = random_sea(7, {.boxes = 6});
    for (int bit = 0; bit < 9; ++bit) {
        const Layers layers{static_cast<uint16_t>(displayed_layers.bits & ~(1U << bit))};
        const SeaInstant instant(sea, {20'000'000}, layers);
        const LatticeGrid grid{{-800'000, -300'000}, 12'345, 20'001, 130, 40};
        expect_grid(instant, grid, 1, "without layer " + std::to_string(bit));
        expect_water(instant, random_places(9, 65, {}, 1'500'000), 1, "without layer " + std::to_string(bit));
    }
}

TEST_P(OnTarget, AnyNumberOfThreadsAndAnySize) {
    const SeaInstant instant(random_sea(5), {9'000'000});
    for (const unsigned threads : {1U, 2U, 7U, 16U})
        for (const auto& [nx, nz] : {std::pair{1, 1}, {3, 2}, {64, 16}, {65, 17}, {200, 50}, {0, 5}}) {
            const LatticeGrid grid{{-300'000, 100'000}, 4001, 2003, nx, nz};
            expect_grid(instant, grid, threads, std::to_string(nx) + " x " + std::to_string(nz));
        }
}

TEST_P(OnTarget, AtTheEndsOfTheWorldAndOfTime) {
    int64_t years = 0;
    for (const LatticePoint centre : {LatticePoint{world_bound - 3'000'000, -world_bound + 3'000'000},
                                      LatticePoint{-world_bound + 3'000'000, world_bound - 3'000'000},
                                      LatticePoint{9'000'000'000, 123'456'789'012 % world_bound}}) {
        const Sea sea = random_sea(static_cast<uint64_t>(years) + 40, {.centre = centre});
        const SeaInstant instant(sea, {years * 315'360'000'000'00 + 5'000'000});
        const LatticeGrid grid{{centre.x - 900'000, centre.z - 900'000}, 14'001, 50'001, 129, 34};
        expect_grid(instant, grid, 2, "far away");
        expect_water(instant, random_places(1, 100, centre, 1'500'000), 2, "far away");
        years += 5;
    }
    // Points on both sides of a box's reach of 2^31 units in one vector.
    const SeaInstant instant(random_sea(3, {.land = false}), {5'000'000}, displayed_layers);
    expect_grid(instant, {{-(int64_t{1} << 32), -(int64_t{1} << 32)}, 134'217'721, 268'435'001, 70, 33}, 1,
                "reach");
}

TEST_P(OnTarget, ReferenceSea) {
    const SeaInstant instant(reference_sea(), {600'000'000});
    expect_grid(instant, {{-1'000'000, -800'000}, 9'999, 20'011, 160, 64}, 1, "reference sea");
}

TEST_P(OnTarget, PlacesOfRandomSeas) {
    for (uint64_t seed = 1; seed <= 16; ++seed) {
        const SeaInstant instant(random_sea(seed), {static_cast<int64_t>(seed) * 2'500'000});
        const int64_t reach = int64_t{1} << (8 + seed);
        for (const size_t count : {size_t{1}, size_t{63}, size_t{200}})
            expect_water(instant, random_places(seed, count, {}, reach), seed % 2 == 0 ? 7 : 1,
                         "seed " + std::to_string(seed));
    }
}

/// A field around the origin whose nodes all differ; one block in `holes` is open water, none where that is 0.
std::shared_ptr<const LandField> rough_field(uint32_t id, uint8_t step, int64_t reach, uint64_t holes) {
    auto field = std::make_shared<LandField>(FieldId{id}, step);
    const BlockRange range = blocks_touching({{-reach, -reach}, {reach, reach}}, step);
    std::mt19937_64 dice(id);
    for (int32_t bz = range.first.z; bz <= range.last.z; ++bz)
        for (int32_t bx = range.first.x; bx <= range.last.x; ++bx) {
            if (holes != 0 && dice() % holes == 0) continue;
            auto block = std::make_shared<LandBlock>();
            block->key = {bx, bz};
            for (size_t i = 0; i < block->shift.size(); ++i) {
                block->shift[i] = static_cast<int32_t>(dice() % 200'000) - 100'000;
                block->gain[i] = static_cast<uint16_t>(dice());
                block->orbit[i] = static_cast<uint16_t>(dice());
            }
            field->set(std::move(block));
        }
    return field;
}

/// Six trains in an endless box whose envelope is 1: three of field 1, one of none, two of field 2.
Sea grown_sea(const std::shared_ptr<const LandField>& first, const std::shared_ptr<const LandField>& second) {
    WaveTrainBox box;
    box.id = {1};
    box.first_train = {1};
    const uint32_t fields[6] = {1, 1, 1, 0, 2, 2};
    for (int32_t i = 0; i < 6; ++i) {
        WaveTrain t;
        t.kx = 60'000 + 17'001 * i;
        t.kz = 90'001 - 40'003 * i;
        t.omega = 2'000'000'000'000ULL + 300'000'000'000ULL * static_cast<unsigned long long>(i);
        t.phase = 2'654'435'769U * static_cast<uint32_t>(i);
        t.amplitude = 0.4F - 0.05F * static_cast<float>(i);
        t.choppiness = 0.6F;
        t.field = {fields[i]};
        box.trains.push_back(t);
    }
    const std::shared_ptr<const LandField> both[] = {first, second};
    return Sea({prepare(std::move(box), both)});
}

TEST_P(OnTarget, FullyGrownBoxOverLand) {
    // Two lattices, with and without holes; places within a cell, over many blocks, and over more than a plan has a table for.
    for (const uint64_t holes : {0ULL, 2ULL}) {
        const Sea sea = grown_sea(rough_field(1, 16, 3'000'000, holes), rough_field(2, 12, 500'000, holes));
        const SeaInstant instant(sea, {77'000'000});
        for (const int64_t reach : {2'000, 400'000, 2'500'000, 1'000'000'000})
            for (const size_t count : {size_t{1}, size_t{17}, size_t{64}, size_t{150}})
                expect_water(instant, random_places(count, count, {}, reach), 1,
                             "holes " + std::to_string(holes) + ", reach " + std::to_string(reach));
        for (const int64_t step : {300, 5'000, 60'001})
            expect_grid(instant, {{-20 * step, -9 * step}, step, step + 1, 75, 20}, 1,
                        "grid " + std::to_string(step));
    }
}

TEST_P(OnTarget, WantedPlanesAlone) {
    const SeaInstant instant(random_sea(11), {9'000'000});
    const LatticeGrid grid{{-400'000, 100'000}, 5001, 7003, 77, 19};
    Workers workers(1);
    std::vector<SurfaceSample> all(grid.size());
    evaluate_grid(instant, grid, all, workers);
    std::vector<float> ay(grid.size(), 7.0F);
    std::vector<float> ny(grid.size(), 7.0F);
    evaluate_grid(instant, grid, SurfacePlanes{.ay = ay.data()}, workers);
    evaluate_grid(instant, grid, SurfacePlanes{.ny = ny.data()}, workers);
    for (size_t i = 0; i < all.size(); ++i) {
        ASSERT_EQ(std::bit_cast<uint32_t>(ay[i]), std::bit_cast<uint32_t>(all[i].ay)) << i;
        ASSERT_EQ(std::bit_cast<uint32_t>(ny[i]), std::bit_cast<uint32_t>(all[i].ny)) << i;
    }
}

TEST_P(OnTarget, StillWater) {
    const SeaInstant instant(Sea{}, {0});
    expect_grid(instant, {{0, 0}, 1024, 1024, 70, 20}, 2, "still");
    expect_water(instant, {{5, 7}, {-100, 12}}, 1, "still");
    expect_water(instant, {}, 2, "nothing asked");
}

INSTANTIATE_TEST_SUITE_P(Every, OnTarget, testing::ValuesIn(vector_targets()),
                         [](const auto& target) { return target.param; });

TEST(VectorTarget, UnknownNamesAreRefused) {
    const std::string best = vector_target();
    EXPECT_FALSE(force_vector_target("Babbage"));
    EXPECT_EQ(vector_target(), best);
}

}  // namespace
}  // namespace trochoid
