#include <gtest/gtest.h>

#include <cmath>

#include "client/app/probe_options.hpp"
#include "client/app/probe_report.hpp"
#include "client/ctl/ctl_options.hpp"
#include "client/ctl/ctl_report.hpp"
#include "client/ctl/text_table.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {
namespace {

std::optional<CtlOptions> ctl(std::vector<const char*> words) {
    words.insert(words.begin(), "trochoid-ctl");
    return read_ctl_options(static_cast<int>(words.size()), words.data());
}

std::optional<ProbeOptions> probe(std::vector<const char*> words) {
    words.insert(words.begin(), "trochoid-probe");
    return read_probe_options(static_cast<int>(words.size()), words.data());
}

TEST(TextTable, aligns_by_code_points_without_trailing_blanks) {
    TextTable table({{"BOX"}, {"NAME", TextTable::Align::left}, {"TO"}});
    table.add({"7", "swell", "90°"});
    table.add({"1234", "é", "5°"});
    EXPECT_EQ(table.text(), " BOX  NAME    TO\n   7  swell  90°\n1234  é       5°\n");
    TextTable last({{"A", TextTable::Align::left}, {"B", TextTable::Align::left}});
    last.add({"x", ""});
    EXPECT_EQ(last.text(), "A  B\nx\n");
}

TEST(CtlOptions, a_wind_in_the_worlds_units) {
    const auto options =
        ctl({"start-wind", "--speed", "12.5", "--towards", "360", "--origin", "-1.5,2000", "--fetch-km", "3",
             "--width-km", "0.5", "--life-s", "60", "--in", "2.5", "--or-refuse"});
    ASSERT_TRUE(options);
    const auto& start = std::get<CtlStartWind>(options->action);
    EXPECT_EQ(start.wind.speed, 12.5F);
    EXPECT_EQ(start.wind.towards_degrees, 0.0F);
    EXPECT_EQ(start.wind.origin, (LatticePoint{-1536, 2'048'000}));
    EXPECT_EQ(start.wind.fetch, 3'072'000);
    EXPECT_EQ(start.wind.width, 512'000);
    EXPECT_EQ(start.wind.life_us, 60'000'000);
    EXPECT_EQ(start.wind.trains, 16);
    EXPECT_TRUE(start.when.or_refuse);
    EXPECT_EQ(asked_time(start.when, {1'000'000}).us, 3'500'000);
}

TEST(CtlOptions, asked_times) {
    EXPECT_EQ(asked_time({}, {77}).us, -sea_time_bound);
    EXPECT_EQ(asked_time({-3.25, {}, false}, {77}).us, -3'250'000);
    EXPECT_EQ(asked_time({{}, 0.0, false}, {77}).us, 77);
}

TEST(CtlOptions, options_after_the_subcommand_count_too) {
    const auto options = ctl({"time", "--rate", "0", "--connect", "[::1]:99", "--json"});
    ASSERT_TRUE(options);
    EXPECT_EQ(options->server, (Endpoint{"::1", 99}));
    EXPECT_TRUE(options->json);
    EXPECT_EQ(std::get<CtlTime>(options->action).rate, 0.0);
    EXPECT_FALSE(std::get<CtlTime>(ctl({"time"})->action).rate);
}

TEST(CtlOptions, bad_ones_throw) {
    EXPECT_THROW(ctl({}), OperatorError);
    EXPECT_THROW(ctl({"list", "time"}), OperatorError);
    EXPECT_THROW(ctl({"time", "--rate", "17"}), OperatorError);
    EXPECT_THROW(ctl({"time", "--rate", "nan"}), OperatorError);
    EXPECT_THROW(ctl({"stop-wind"}), OperatorError);
    EXPECT_THROW(ctl({"stop-wind", "-1"}), OperatorError);
    EXPECT_THROW(ctl({"stop-wind", "1", "--at", "1", "--in", "1"}), OperatorError);
    EXPECT_THROW(ctl({"start-wind", "--speed", "9", "--towards", "1", "--origin", "5", "--fetch-km", "1",
                      "--width-km", "1"}),
                 OperatorError);
    EXPECT_THROW(ctl({"start-wind", "--speed", "9", "--towards", "1", "--origin", "5,5", "--fetch-km", "1",
                      "--width-km", "1", "--life-s", "0.5"}),
                 OperatorError);
}

TEST(CtlReport, sea_times) {
    EXPECT_EQ(sea_time_text({98'745'678'900}), "98745.678 s (1 d 03:25:45.678)");
    EXPECT_EQ(sea_time_text({-1'500'000}), "-1.500 s (-00:00:01.500)");
    EXPECT_EQ(sea_time_text(end_of_time), "never");
}

TEST(CtlReport, stages_of_a_box) {
    BoxSummary box;
    box.begin = {100};
    box.end = {200};
    box.decay_us = 50;
    box.gain_now = 0.5F;
    EXPECT_STREQ(stage_of(box, {99}), "waiting");
    EXPECT_STREQ(stage_of(box, {100}), "growing");
    box.gain_now = 1.0F;
    EXPECT_STREQ(stage_of(box, {199}), "grown");
    EXPECT_STREQ(stage_of(box, {200}), "decaying");
    EXPECT_STREQ(stage_of(box, {250}), "over");
    box.end = end_of_time;
    EXPECT_STREQ(stage_of(box, {sea_time_bound - 1}), "grown");
}

TEST(CtlReport, an_empty_list_and_a_deferral_are_said) {
    EXPECT_NE(report(BoxList{}, false).find("the sea is still"), std::string::npos);
    CtlOptions options;
    options.action = CtlStopWind{{4}, {}};
    CommandReply reply;
    reply.box = {4};
    reply.effective = {2'500'000};
    EXPECT_EQ(report(reply, options, {-sea_time_bound}),
              "box 4: the decay starts at sea time 2.500 s (00:00:02.500)\n");
    EXPECT_NE(report(reply, options, {1'000'000}).find("deferred by 1.500 s"), std::string::npos);
}

TEST(ProbeOptions, regions_and_points) {
    const auto options =
        probe({"--region", "-100,50.5,20", "--region", "0,0,0", "--point", "1,-2", "--points", "10"});
    ASSERT_TRUE(options);
    EXPECT_EQ(options->regions, (std::vector<SyncRegion>{{{-102'400, 51'712}, 20'480}, {{0, 0}, 0}}));
    ASSERT_EQ(options->points.size(), 11U);
    EXPECT_EQ(options->points[0], (LatticePoint{1024, -2048}));
    const auto around = probe({"--point", "0,0", "--point", "50,0", "--point", "500,0"});
    ASSERT_TRUE(around);
    EXPECT_EQ(around->regions.size(), 2U) << "50,0 lies in the disc around 0,0";
}

TEST(ProbeOptions, chosen_points_lie_inside_and_depend_on_the_seed_alone) {
    const std::vector<SyncRegion> regions{{{5000, -7000}, 3000}, {{1'000'000, 0}, 1}, {{9, 9}, 0}};
    const auto points = points_inside(regions, 3000, 5);
    ASSERT_EQ(points.size(), 3000U);
    for (size_t i = 0; i < points.size(); ++i) {
        const SyncRegion& region = regions[i % 3];
        const int64_t dx = points[i].x - region.centre.x;
        const int64_t dz = points[i].z - region.centre.z;
        EXPECT_LE(dx * dx + dz * dz, int64_t{region.radius} * region.radius);
    }
    EXPECT_EQ(points, points_inside(regions, 3000, 5));
    EXPECT_NE(points, points_inside(regions, 3000, 6));
}

TEST(ProbeReport, one_bit_is_a_difference) {
    ProbeSample ours;
    ours.point = {3, 4};
    ours.time = {5};
    SurfaceSample servers = ours.surface;
    ProbeComparison sum;
    compare(sum, ours, servers);
    EXPECT_EQ(sum, (ProbeComparison{1, 1, ""}));
    servers.yz = -0.0F;  // equal as a number
    compare(sum, ours, servers);
    EXPECT_EQ(sum.asked, 2U);
    EXPECT_EQ(sum.identical, 1U);
    EXPECT_NE(sum.first_difference.find("yz at x 3 z 4"), std::string::npos) << sum.first_difference;
    servers = ours.surface;
    servers.vz = std::nextafter(0.0F, 1.0F);
    compare(sum, ours, servers);
    EXPECT_EQ(sum.identical, 1U);
    EXPECT_NE(comparison_line(sum).find("1 of 3 identical"), std::string::npos);
    EXPECT_EQ(bits_of(ours.surface).size(), 15U);
}

}  // namespace
}  // namespace trochoid
