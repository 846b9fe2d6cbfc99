// What trochoid-probe says of budgets and coarse evaluation, against the sea itself.
#include "client/app/probe_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "client/app/probe_options.hpp"
#include "client/sample/water_sampler.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {
namespace {

constexpr SyncRegion disc{{1'000, -5'000}, 500 * 1024};

/// Two boxes without limits: eight long high trains, and eight short low ones.
Sea two_seas() {
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (const int32_t id : {1, 2}) {
        WaveTrainBox box;
        box.id = {static_cast<uint32_t>(id)};
        box.first_train = {static_cast<uint32_t>(10 * id)};
        box.begin = {-1'000'000'000'000};
        for (int32_t i = 0; i < 8; ++i) {
            WaveTrain train;
            train.kx = (id == 1 ? 40'018 : 900'000) + 1'000 * i;
            train.kz = 8'021 * i;
            train.omega = 1'613'943'558'211ULL;
            train.amplitude = id == 1 ? 0.5F : 0.01F;
            train.choppiness = 0.4F;
            box.trains.push_back(train);
        }
        boxes.push_back(prepare(box, {}));
    }
    return Sea(boxes);
}

std::optional<ProbeOptions> probe(std::vector<const char*> words) {
    words.insert(words.begin(), "trochoid-probe");
    return read_probe_options(static_cast<int>(words.size()), words.data());
}

TEST(ProbeGrid, LiesInsideTheDisc) {
    for (const uint32_t side : {2U, 3U, 64U, 2048U}) {
        const auto grid = grid_within(disc, side);
        ASSERT_TRUE(grid);
        EXPECT_EQ(grid->size(), size_t{side} * side);
        const int32_t last = static_cast<int32_t>(side) - 1;
        for (const LatticePoint corner :
             {grid->at(0, 0), grid->at(last, 0), grid->at(0, last), grid->at(last, last)})
            EXPECT_TRUE(contains(disc, corner)) << side;
        EXPECT_GT(static_cast<double>(last) * static_cast<double>(grid->step_x), 1.4 * disc.radius - 2100.0);
    }
    EXPECT_FALSE(grid_within({{0, 0}, 100}, 2048));
    EXPECT_FALSE(grid_within({{0, 0}, 0}, 2));
}

TEST(ProbeGrid, ABudgetKeepsWhatMattersAndSaysWhatIsLost) {
    const Sea sea = two_seas();
    const LatticeGrid grid = *grid_within(disc, 64);
    const auto points = static_cast<double>(grid.size());
    const BudgetAnswer half = spend_budget(sea, {7'000'000}, grid, 8.0 * points);
    ASSERT_EQ(half.boxes.size(), 2U);
    EXPECT_EQ(half.boxes[0].kept, (std::vector<uint16_t>{0, 1, 2, 3, 4, 5, 6, 7})) << "the high ones";
    EXPECT_TRUE(half.boxes[1].kept.empty());
    EXPECT_NEAR(half.choice.trains_lost, 8 * 0.01, 1e-6);
    EXPECT_GT(half.height_seen, 0.01);
    EXPECT_TRUE(half.keeps_bound());
    const BudgetAnswer all = spend_budget(sea, {7'000'000}, grid, 1e9);
    EXPECT_EQ(all.choice.trains_lost, 0.0);
    EXPECT_EQ(all.height_seen, 0.0) << "everything is the sea itself";
    const BudgetAnswer nothing = spend_budget(sea, {7'000'000}, grid, 0.0);
    EXPECT_NEAR(nothing.choice.trains_lost, 8 * 0.51, 1e-5);
    EXPECT_TRUE(nothing.keeps_bound());
    EXPECT_NE(text_of(half).find("KEPT"), std::string::npos);
    const auto json = nlohmann::json::parse(json_line(half));
    EXPECT_EQ(json.at("boxes").at(0).at("kept").size(), 8U);
    EXPECT_DOUBLE_EQ(json.at("trains_lost_m").get<double>(), half.choice.trains_lost);
}

TEST(ProbeGrid, CoarseEvaluationKeepsItsBound) {
    const Sea sea = two_seas();
    const LatticeGrid grid = *grid_within({{0, 0}, 60 * 1024}, 200);
    const CoarseAnswer answer = evaluate_coarsely(sea, {7'000'000}, grid, {4, 12.0});
    EXPECT_EQ(answer.trains, 16U);
    EXPECT_EQ(answer.bound.trains, 8) << "the short ones are not long against the steps";
    EXPECT_GT(answer.height_seen, 0.0);
    EXPECT_LE(answer.height_seen, answer.bound.height);
    EXPECT_TRUE(answer.keeps_bound());
    EXPECT_GT(answer.exact_ms, 0.0);
    EXPECT_NE(text_of(answer).find("8 of 16 trains"), std::string::npos);
    EXPECT_EQ(nlohmann::json::parse(json_line(answer)).at("interpolated"), 8);
}

TEST(ProbeOptions, budgets_and_coarse_grids_need_a_region_alone) {
    const auto options = probe({"--region", "0,0,500", "--budget", "5e5", "--grid", "64", "--coarse", "8"});
    ASSERT_TRUE(options);
    EXPECT_EQ(options->budget, 5e5);
    EXPECT_EQ(options->coarse, 8);
    EXPECT_EQ(options->grid, 64U);
    EXPECT_TRUE(options->points.empty());
    EXPECT_TRUE(probe({"--point", "3,4", "--coarse", "2"}));
    for (const std::vector<const char*>& bad :
         {std::vector<const char*>{"--region", "0,0,500", "--coarse", "3"},
          {"--region", "0,0,500", "--budget", "-1"},
          {"--region", "0,0,500", "--budget", "nan"},
          {"--region", "0,0,500", "--budget", "1e6", "--compare"},
          {"--region", "0,0,500", "--coarse", "4", "--watch"},
          {"--region", "0,0,0.5", "--coarse", "4", "--grid", "2048"},
          {"--budget", "1e6"}})
        EXPECT_THROW(probe(bad), OperatorError) << bad.back();
}

}  // namespace
}  // namespace trochoid
