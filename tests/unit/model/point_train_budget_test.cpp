#include "protocol/model/point_train_budget.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

uint64_t draw(uint64_t& state) { return state = splitmix64(state); }

WaveTrain train_of(uint64_t& chance) {
    WaveTrain t;
    t.kx = static_cast<int32_t>(draw(chance) % 400'000) - 200'000;
    t.kz = static_cast<int32_t>(draw(chance) % 200'000) + 20'000;
    t.omega = uint64_t{1} << 43;
    t.phase = static_cast<uint32_t>(draw(chance));
    t.amplitude = 0.01F + static_cast<float>(draw(chance) % 1000) * 0.001F;
    t.choppiness = 0.3F;
    return t;
}

std::shared_ptr<const PreparedBox> box_of(uint32_t id, int trains, LatticePoint corner, int64_t side,
                                          uint64_t seed) {
    WaveTrainBox box;
    box.id = {id};
    box.first_train = {id * 100};
    box.origin = corner;
    box.length = side;
    box.width = side;
    uint64_t chance = seed;
    for (int i = 0; i < trains; ++i) box.trains.push_back(train_of(chance));
    return prepare(box, {});
}

constexpr int64_t km = 1000 * lattice_per_metre;

BudgetQuestion question(double point_trains) {
    BudgetQuestion q;
    q.region = {{0, 0}, {4 * km, 4 * km}};
    q.from = {0};
    q.until = {10 * microseconds_per_second};
    q.points = 1000.0;
    q.point_trains = point_trains;
    return q;
}

/// Boxes over all, half and a quarter of the region, and one far away.
Sea mixed_sea() {
    return Sea({box_of(1, 5, {-km, -km}, 6 * km, 7), box_of(2, 4, {-km, -km}, 3 * km, 8),
                box_of(3, 4, {2 * km, -km}, 6 * km, 9), box_of(4, 3, {90 * km, 0}, km, 10)});
}

double value_of(const Sea& sea, const BudgetQuestion& q, const BudgetChoice& c) {
    double value = 0.0;
    for (const auto& box : sea.boxes())
        for (const BoxShare& share : c.boxes) {
            if (share.box != box->record.id) continue;
            const LatticeRect b = bounds_over(box->record, q.from, q.until);
            const auto side = [](int64_t a, int64_t z) { return static_cast<double>(z - a + 1); };
            const double cover =
                side(std::max(b.min.x, q.region.min.x), std::min(b.max.x, q.region.max.x)) *
                side(std::max(b.min.z, q.region.min.z), std::min(b.max.z, q.region.max.z)) /
                (side(q.region.min.x, q.region.max.x) * side(q.region.min.z, q.region.max.z));
            for (const uint16_t t : share.trains)
                value += static_cast<double>(box->record.trains[t].amplitude) * cover;
        }
    return value;
}

TEST(PointTrainBudget, AnAmpleBudgetKeepsAllThatReachesTheRegion) {
    const Sea sea = mixed_sea();
    const BudgetChoice c = choose_within(sea, question(1e9));
    ASSERT_EQ(c.boxes.size(), 3U);  // the fourth is far away
    EXPECT_EQ(c.boxes[0].trains.size(), 5U);
    EXPECT_EQ(c.layers, displayed_layers);
    EXPECT_EQ(c.trains_lost, 0.0);
    EXPECT_EQ(c.layers_lost, 0.0);
    EXPECT_TRUE(c.best);
    EXPECT_DOUBLE_EQ(c.spent, c.asked);
}

TEST(PointTrainBudget, NothingIsKeptForNothing) {
    const BudgetChoice c = choose_within(mixed_sea(), question(0.0));
    for (const BoxShare& share : c.boxes) EXPECT_TRUE(share.trains.empty());
    EXPECT_EQ(c.spent, 0.0);
    EXPECT_GT(c.trains_lost, 0.0);
}

// The slow twin: every one of the 2^13 subsets.
TEST(PointTrainBudget, NoSubsetIsBetter) {
    const Sea sea = mixed_sea();
    for (const double budget : {500.0, 1500.0, 2300.0, 3333.0, 5000.0, 7000.0}) {
        const BudgetQuestion q = question(budget);
        const BudgetChoice c = choose_within(sea, q);
        EXPECT_TRUE(c.best);
        EXPECT_LE(c.spent, budget);
        const BudgetChoice all = choose_within(sea, question(1e9));
        double best = 0.0;
        for (unsigned mask = 0; mask < (1U << 13); ++mask) {
            BudgetChoice some = all;
            unsigned bit = 0;
            for (BoxShare& share : some.boxes)
                std::erase_if(share.trains, [&](uint16_t) { return (mask >> bit++ & 1U) == 0; });
            double cost = 0.0;
            for (const BoxShare& share : some.boxes) {
                BudgetChoice one;
                one.boxes = {{share.box, {share.trains.empty() ? uint16_t{0} : share.trains[0]}}};
                double cover = 0.0;
                for (const auto& box : sea.boxes())
                    if (box->record.id == share.box)
                        cover = value_of(sea, q, one) /
                                static_cast<double>(box->record.trains[one.boxes[0].trains[0]].amplitude);
                cost += cover * q.points * static_cast<double>(share.trains.size());
            }
            if (cost <= budget) best = std::max(best, value_of(sea, q, some));
        }
        EXPECT_NEAR(value_of(sea, q, c), best, 1e-9) << "budget " << budget;
    }
}

TEST(PointTrainBudget, TheLossIsBounded) {
    const Sea sea = mixed_sea();
    uint64_t chance = 3;
    for (const double budget : {1000.0, 4000.0, 6000.0}) {
        const BudgetChoice c = choose_within(sea, question(budget));
        const SeaInstant full(sea, {5 * microseconds_per_second});
        const SeaInstant less(reduced(sea, c), {5 * microseconds_per_second}, c.layers);
        double largest = 0.0;
        for (int i = 0; i < 400; ++i) {
            const LatticePoint p{static_cast<int64_t>(draw(chance) % static_cast<uint64_t>(4 * km)),
                                 static_cast<int64_t>(draw(chance) % static_cast<uint64_t>(4 * km))};
            largest =
                std::max(largest, std::abs(static_cast<double>(full.evaluate(p).ay - less.evaluate(p).ay)));
        }
        EXPECT_LE(largest, c.trains_lost + c.layers_lost + 1e-4);
        EXPECT_GT(largest, 0.0);
    }
}

TEST(PointTrainBudget, LayersComeInOrderAfterTheTrains) {
    WaveTrainBox box = box_of(1, 4, {-km, -km}, 6 * km, 5)->record;
    box.irregular.share = full_irregularity / 2;
    box.irregular.ukx = 20'000;
    box.irregular.vkz = 20'000;
    box.noise.amplitude = 0.05F;
    box.noise.octaves = 2;
    const Sea sea({prepare(box, {})});
    uint16_t before = 0;
    for (double budget = 0.0; budget < 20'000.0; budget += 500.0) {
        const BudgetChoice c = choose_within(sea, question(budget));
        EXPECT_EQ(c.layers.bits & before, before) << "a growing budget only adds";
        before = c.layers.bits;
        if (budget < 4000.0) {
            EXPECT_FALSE(c.layers.has(Layer::irregular));
            EXPECT_FALSE(c.layers.has(Layer::displayed_noise));
        }
    }
    EXPECT_EQ(before, displayed_layers.bits);
    const BudgetChoice some = choose_within(sea, question(6500.0));
    EXPECT_TRUE(some.layers.has(Layer::irregular));
    EXPECT_FALSE(some.layers.has(Layer::displayed_noise));
    EXPECT_GE(some.layers_lost, 0.05);
}

TEST(PointTrainBudget, AHugeSeaIsChosenGreedilyWithinAStatedGap) {
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (uint32_t id = 1; id <= 20; ++id)
        boxes.push_back(box_of(id, 250, {-km * id, -km}, (4 + id) * km, id));
    const Sea sea(std::move(boxes));
    const BudgetChoice c = choose_within(sea, question(1'234'567.0));
    EXPECT_LE(c.spent, 1'234'567.0);
    EXPECT_GE(c.gap, 0.0);
    EXPECT_LT(c.gap, 1.1);  // one train at most
}

}  // namespace
}  // namespace trochoid
