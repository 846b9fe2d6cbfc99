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
    const auto& start = std::get<CtlCommand>(options->action);
    StartWind wind;
    wind.speed = 12.5F;
    wind.origin = {-1536, 2'048'000};
    wind.fetch = 3'072'000;
    wind.width = 512'000;
    wind.life_us = 60'000'000;
    EXPECT_EQ(start.action, CommandAction{wind}) << "all else is as by default";
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
    EXPECT_EQ(std::get<CtlCommand>(options->action).action, CommandAction{SetRate{0}});
    EXPECT_EQ(ctl({"time", "--rate", "1.5"})->action, CtlAction{(CtlCommand{SetRate{3U << 15}, {}})});
    EXPECT_EQ(ctl({"time"})->action, CtlAction{CtlTime{}});
}

std::vector<const char*> wind_words(std::vector<const char*> more) {
    std::vector<const char*> words{"start-wind", "--speed",    "25", "--towards",  "90", "--origin",
                                   "0,0",        "--fetch-km", "15", "--width-km", "10"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

TEST(CtlOptions, a_wind_with_all_that_waves_can_do) {
    const auto options = ctl(wind_words({"--trains",          "256",     "--directions", "8",
                                         "--spectrum",        "neumann", "--spreading",  "cosine-squared",
                                         "--reference-depth", "12.5",    "--round",      "0.25",
                                         "--irregular",       "1",       "--noise",      "0.03125",
                                         "--move-towards",    "180",     "--move-speed", "12"}));
    ASSERT_TRUE(options);
    const auto wind = std::get<StartWind>(std::get<CtlCommand>(options->action).action);
    EXPECT_EQ(wind.trains, 256);
    EXPECT_EQ(wind.directions, 8);
    EXPECT_EQ(wind.spectrum, Spectrum::neumann);
    EXPECT_EQ(wind.spreading, Spreading::cosine_squared);
    EXPECT_EQ(wind.reference_depth, 12.5F);
    EXPECT_EQ(wind.roundness, 0.25F);
    EXPECT_EQ(wind.irregularity, 1.0F);
    EXPECT_EQ(wind.noise, 0.03125F);
    EXPECT_EQ(wind.vx, 0.0F) << "no dust of a sine";
    EXPECT_EQ(wind.vz, 12.0F) << "south is +z";
    const auto west = ctl(wind_words({"--move-towards", "270", "--move-speed", "100"}));
    EXPECT_EQ(std::get<StartWind>(std::get<CtlCommand>(west->action).action).vx, -100.0F);
}

TEST(CtlOptions, a_ship_her_course_and_her_end) {
    const auto options = ctl(
        {"start-ship", "--from", "10,-20", "--towards", "360", "--speed", "9", "--name", "MS M\xc3\xb8we"});
    ASSERT_TRUE(options);
    EXPECT_EQ(std::get<CtlCommand>(options->action).action,
              (CommandAction{StartShip{{10'240, -20'480}, 0.0F, 9.0F, 100.0F, 0.0F, "MS M\xc3\xb8we"}}));
    const auto turn = ctl({"steer", "5", "--towards", "45.5", "--speed", "0", "--in", "3"});
    ASSERT_TRUE(turn);
    EXPECT_EQ(turn->action, CtlAction{(CtlCommand{Steer{{5}, 45.5F, 0.0F}, {{}, 3.0, false}})});
    for (const char* word : {"stop", "stop-wind"})
        EXPECT_EQ(ctl({word, "7"})->action, CtlAction{(CtlCommand{StopWind{{7}}, {}})});
}

TEST(CtlOptions, a_breakwater) {
    const auto options = ctl(
        {"breakwater", "--point", "1,-2", "--point", "-3.5,4", "--width", "12.5", "--crest", "-8", "--dig"});
    ASSERT_TRUE(options);
    EXPECT_EQ(std::get<CtlCommand>(options->action).action,
              (CommandAction{ChangeLand{{{1024, -2048}, {-3584, 4096}}, 12.5F, -8.0F, true}}));
    const auto plain = ctl({"breakwater", "--point", "0,0", "--point", "0,9"});
    EXPECT_EQ(std::get<ChangeLand>(std::get<CtlCommand>(plain->action).action),
              (ChangeLand{{{0, 0}, {0, 9216}}, 20.0F, 3.0F, false}));
}

/// The sentence that the words are refused with; empty where they are taken.
std::string refused(const std::vector<const char*>& words) {
    try {
        ctl(words);
    } catch (const OperatorError& error) {
        return error.what();
    }
    return {};
}

void expect_refused(const std::vector<const char*>& words, const char* says) {
    EXPECT_NE(refused(words).find(says), std::string::npos) << "'" << refused(words) << "' lacks " << says;
}

TEST(CtlOptions, bad_winds_say_what_is_wrong) {
    const auto is = [](std::vector<const char*> more, const char* says) {
        expect_refused(wind_words(std::move(more)), says);
    };
    EXPECT_EQ(refused(wind_words({})), "");
    is({"--trains", "257"}, "--trains: 257 is not a number in 1 to 256");
    is({"--trains", "nan"}, "--trains");
    is({"--directions", "5"}, "does not divide --trains 16");
    is({"--directions", "32"}, "does not divide");
    is({"--spectrum", "jonswop"}, "--spectrum: jonswop not in {");
    is({"--spectrum", "1"}, "--spectrum");
    is({"--spreading", ""}, "--spreading");
    is({"--reference-depth", "0.5"}, "1 to 12000");
    is({"--reference-depth", "inf"}, "--reference-depth");
    is({"--round", "nan"}, "--round: nan is not a number in 0 to 1");
    is({"--irregular", "1.5"}, "--irregular: 1.5 is not a number in 0 to 1");
    is({"--noise", "-0.5"}, "--noise");
    is({"--noise", ""}, "--noise");
    is({"--move-speed", "12"}, "--move-towards");
    is({"--move-towards", "12"}, "--move-speed");
    is({"--move-towards", "12", "--move-speed", "nan"}, "--move-speed");
    is({"--move-towards", "12", "--move-speed", "101"}, "--move-speed");
    is({"--at", "nan"}, "--at: nan");
}

TEST(CtlOptions, bad_ships_and_land_say_what_is_wrong) {
    const auto ship = [](std::vector<const char*> more, const char* says) {
        std::vector<const char*> words{"start-ship", "--from", "0,0", "--towards", "1", "--speed", "9"};
        words.insert(words.end(), more.begin(), more.end());
        expect_refused(words, says);
    };
    const std::string long_name(65, 'n');
    ship({"--length", "501"}, "--length: 501 is not a number in 1 to 500");
    ship({"--beam", "nan"}, "--beam");
    ship({"--beam", "101"}, "--beam 101 is above --length 100");
    ship({"--name", long_name.c_str()}, "64");
    ship({"--name", "two\nlines"}, "control characters");
    expect_refused({"start-ship", "--from", "0,0", "--towards", "1", "--speed", "0.4"}, "--speed");
    expect_refused({"start-ship", "--from", "0,nan", "--towards", "1", "--speed", "9"}, "--from");
    expect_refused({"start-ship", "--towards", "1", "--speed", "9"}, "--from is required");
    expect_refused({"steer", "--towards", "1", "--speed", "9"}, "BOX is required");
    expect_refused({"steer", "0", "--towards", "1", "--speed", "9"}, "BOX");
    expect_refused({"steer", "3", "--towards", "361", "--speed", "9"}, "--towards");
    expect_refused({"steer", "3", "--towards", "1"}, "--speed is required");
    expect_refused({"breakwater"}, "2 to 64 points, not 0: give --point X,Z");
    expect_refused({"breakwater", "--point", "1,2"}, "2 to 64 points, not 1");
    expect_refused({"breakwater", "--point", "1,2", "--point", ""}, "--point");
    expect_refused({"breakwater", "--point", "1,2", "--point", "3"}, "--point wants X,Z in metres");
    expect_refused({"breakwater", "--point", "1,2", "--point", "3,nan"}, "--point wants X,Z");
    expect_refused({"breakwater", "--point", "1,2", "--point", "3,4,5"}, "--point wants X,Z");
    expect_refused({"breakwater", "--point", "1,2", "--point", "3,34000000"}, "--point wants X,Z");
    expect_refused({"breakwater", "--point", "1,2", "--point", "3,4", "--width", "0"}, "--width");
    expect_refused({"breakwater", "--point", "1,2", "--point", "3,4", "--crest", "nan"}, "--crest");
    std::vector<const char*> many{"breakwater"};
    for (int i = 0; i < 65; ++i) many.insert(many.end(), {"--point", "1,2"});
    expect_refused(many, "2 to 64 points, not 65");
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
    CommandReply reply;
    reply.box = {4};
    reply.effective = {2'500'000};
    EXPECT_EQ(report(reply, StopWind{{4}}, {-sea_time_bound}, false),
              "box 4: the decay starts at sea time 2.500 s (00:00:02.500)\n");
    EXPECT_NE(report(reply, StopWind{{4}}, {1'000'000}, false).find("deferred by 1.500 s"),
              std::string::npos);
    const auto said = [&](const CommandAction& action) {
        return report(reply, action, {-sea_time_bound}, false);
    };
    EXPECT_EQ(said(SetRate{1U << 15}), "rate 0.5 from sea time 2.500 s (00:00:02.500) on\n");
    EXPECT_EQ(said(Steer{{4}, 0.0F, 5.0F}),
              "box 4: the new course holds from sea time 2.500 s (00:00:02.500) on\n");
    EXPECT_EQ(said(Steer{}), "box 4: lies still from sea time 2.500 s (00:00:02.500) on\n");
    EXPECT_EQ(said(StartShip{}), "box 4: the ship starts at sea time 2.500 s (00:00:02.500)\n");
    EXPECT_EQ(said(ChangeLand{}), "the land changes at sea time 2.500 s (00:00:02.500)\n");
    EXPECT_NE(report(reply, Steer{}, {0}, true).find("\"box\": 4"), std::string::npos);
    EXPECT_EQ(report(reply, ChangeLand{}, {0}, true).find("\"box\""), std::string::npos);
}

TEST(CtlReport, moving_boxes_are_listed_with_place_and_course) {
    BoxSummary ship;
    ship.box = {7};
    ship.name = "ferry";
    ship.kind = BoxKind::ship;
    ship.at = {-2'048'000, 1'024'512};
    ship.vx = -3.0F;
    ship.vz = 4.0F;
    BoxSummary swell;
    swell.box = {8};
    swell.name = "swell";
    const BoxList list{1, {5'000'000}, {ship, swell}, true};
    const std::string table = report(list, false);
    EXPECT_NE(table.find("KIND"), std::string::npos);
    EXPECT_NE(table.find("-2000  1000        5.0    217°       -\n"), std::string::npos) << table;
    EXPECT_NE(table.find("    0     0          -       -       -\n"), std::string::npos) << table;
    const std::string json = report(list, true);
    for (const char* part : {"\"kind\": \"ship\"", "\"x_m\": -2000.0", "\"z_m\": 1000.5", "\"vz_m_s\": 4.0"})
        EXPECT_NE(json.find(part), std::string::npos) << part;
    BoxSummary lying = ship;
    lying.vx = lying.vz = 0.0F;
    lying.gain_now = 1.0F;
    lying.end = end_of_time;
    lying.hull = {140.0F, 21.0F};
    EXPECT_STREQ(stage_of(lying, {1}), "lying");
    const BoxList stopped{1, {}, {lying}, true};
    EXPECT_NE(report(stopped, false).find("140 x 21.0\n"), std::string::npos) << report(stopped, false);
    EXPECT_NE(report(stopped, true).find("\"length_m\": 140.0"), std::string::npos);
    BoxSummary north = ship;
    north.vx = 0.0F;
    north.vz = -1.0F;
    EXPECT_NE(report(BoxList{1, {}, {north}, true}, false).find("1.0      0°"), std::string::npos);
}

TEST(CtlReport, refusals_say_what_to_do) {
    const auto said = [](ErrorCode code) { return refusal(CommandReply{1, code, "no", {}, {}, {}}); };
    // The server's message says what to do; the program adds only how it is told to, once.
    EXPECT_EQ(said(ErrorCode::not_moving), "the server refuses (605 world): no");
    EXPECT_EQ(said(ErrorCode::unknown_box), "the server refuses (602 world): no (trochoid-ctl list)");
    EXPECT_EQ(said(ErrorCode::token_required), "the server refuses (301 auth): no (--sign-with KEY)");
    EXPECT_NE(said(ErrorCode::no_terrain).find("606"), std::string::npos);
    EXPECT_NE(said(ErrorCode::too_many_legs).find("409 resource"), std::string::npos);
}

TEST(Options, servers_in_every_form_and_whom_to_trust) {
    EXPECT_EQ(ctl({"list", "--connect", "wss://sea.example"})->server,
              (Endpoint{"sea.example", 443, Transport::wss}));
    EXPECT_EQ(probe({"--point", "0,0", "--connect", "tls://[::1]:9"})->server,
              (Endpoint{"::1", 9, Transport::tls}));
    for (const char* file : {"/no/such/file.pem", ""}) {
        expect_refused({"list", "--connect", "tls://a:1", "--ca", file}, "--ca");
        EXPECT_THROW(probe({"--point", "0,0", "--connect", "tls://a:1", "--ca", file}), OperatorError);
    }
    const char* no_certificate = TROCHOID_SOURCE_DIR "/README.md";
    expect_refused({"list", "--connect", "tls://a:1", "--ca", no_certificate}, "holds no certificate");
    expect_refused({"list", "--ca", no_certificate}, "--connect tls://127.0.0.1:7421");
    expect_refused({"list", "--connect", "http://a:1"}, "wss://sea.example:7421");
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
