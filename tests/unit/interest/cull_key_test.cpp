#include "server/interest/cull_key.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "server/interest/cull.hpp"
#include "server/interest/patch_selection.hpp"
#include "tests/unit/interest/sample_world.hpp"

namespace trochoid {
namespace {

constexpr SeaTime now{1'000'000'000};

ViewState moved(ViewState v, double metres) {
    v.position.x += to_lattice(metres);
    return v;
}

struct Keys {
    WorldState world = eight_box_world(60);
    InterestIndex index{world};
    ViewState view = looking({0, 0}, 20.0, 0.5, -0.1);
    CullKey first = choose_key(index, view, {}, nullptr, now);
};

TEST(CullKey, FirstKeyIsTheViewWithStatedSlackAndSpan) {
    const Keys k;
    EXPECT_EQ(k.first.anchor, k.view);
    EXPECT_EQ(k.first.slack, static_cast<uint32_t>(to_lattice(8.0)));
    EXPECT_LE(k.first.from, now);
    EXPECT_EQ(k.first.until, now + span_default_us);
    EXPECT_EQ(k.first.error_in_force_px, 1.0F);
    ViewState high = looking({0, 0}, 400.0, 0.5, -0.1);
    EXPECT_EQ(choose_key(k.index, high, {}, nullptr, now).slack, static_cast<uint32_t>(to_lattice(40.0)));
    ViewState telescope = k.view;
    telescope.tan_half_width = telescope.tan_half_height = 0.02F;
    EXPECT_EQ(choose_key(k.index, telescope, {}, nullptr, now).slack_tangent, 0.005F);
    EXPECT_EQ(k.first.slack_tangent, 0.15F);
    high.vx = 300.0F;
    EXPECT_EQ(choose_key(k.index, high, {}, nullptr, now).slack, static_cast<uint32_t>(to_lattice(150.0)));
}

TEST(CullKey, StaysWhileTheCameraStaysInsideTheAnchor) {
    const Keys k;
    EXPECT_EQ(choose_key(k.index, moved(k.view, 5.0), {}, &k.first, now + 20'000'000), k.first);
    const ViewState turned = looking({0, 0}, 20.0, 0.5 + 0.1, -0.1);
    EXPECT_EQ(choose_key(k.index, turned, {}, &k.first, now), k.first);
    ViewState negated = k.view;  // the same turn
    negated.qx = -negated.qx, negated.qy = -negated.qy, negated.qz = -negated.qz, negated.qw = -negated.qw;
    EXPECT_EQ(choose_key(k.index, negated, {}, &k.first, now), k.first);
}

TEST(CullKey, MovesWithTheCameraBeforeTheSlackIsUsedUp) {
    const Keys k;
    EXPECT_EQ(choose_key(k.index, moved(k.view, 7.0), {}, &k.first, now).anchor, moved(k.view, 7.0));
    const ViewState turned = looking({0, 0}, 20.0, 0.5 + 0.14, -0.1);
    EXPECT_EQ(choose_key(k.index, turned, {}, &k.first, now).anchor, turned);
    const ViewState up = looking({0, 0}, 27.0, 0.5, -0.1);
    EXPECT_EQ(choose_key(k.index, up, {}, &k.first, now).anchor, up);
    const ViewState back = looking({0, 0}, 20.0, 0.5 + 3.14159, -0.1);
    EXPECT_FALSE(within_anchor(k.first, back, 1.0));
    ViewState lens = k.view;
    lens.tan_half_width = 0.5F;
    EXPECT_EQ(choose_key(k.index, lens, {}, &k.first, now).anchor, lens);
}

/// Flies (and turns) over a network of that round trip, a view each 100 ms; how often the camera looked beyond what its last result to
/// arrive holds for.
int late_results(const InterestIndex& index, double round_trip_s, double speed, double turn, bool told) {
    constexpr int steps = 400;
    constexpr double interval_s = 0.1;
    const int behind =
        static_cast<int>(round_trip_s / interval_s + 0.5) + 1;  // views until a result is there
    std::vector<CullKey> chosen;
    int late = 0;
    for (int i = 0; i < steps; ++i) {
        const double t = i * interval_s;
        ViewState view = looking({to_lattice(speed * t), 0}, 20.0, 0.5 + turn * t, -0.1);
        view.vx = static_cast<float>(speed);
        const Motion motion = told ? Motion{round_trip_s + interval_s, turn} : Motion{interval_s, 0.0};
        chosen.push_back(choose_key(index, view, {}, chosen.empty() ? nullptr : &chosen.back(), now,
                                    span_default_us, 1024, motion));
        if (i >= behind && !within_anchor(chosen[static_cast<size_t>(i - behind)], view, 1.0)) ++late;
    }
    return late;
}

TEST(CullKey, PadsByMotionForAsLongAsAResultIsOnItsWay) {
    const Keys k;
    for (const double round_trip_s : {0.0, 0.1, 0.2, 0.4}) {
        EXPECT_EQ(late_results(k.index, round_trip_s, 30.0, 0.0, true), 0) << round_trip_s;
        EXPECT_EQ(late_results(k.index, round_trip_s, 0.0, 0.4, true), 0) << round_trip_s;
        EXPECT_EQ(late_results(k.index, round_trip_s, 30.0, 0.4, true), 0) << round_trip_s;
    }
    EXPECT_GT(late_results(k.index, 0.2, 30.0, 0.0, false), 10) << "or the test tells nothing";
    EXPECT_GT(late_results(k.index, 0.2, 0.0, 0.4, false), 10);
}

TEST(CullKey, MotionPadsWithinBounds) {
    const Keys k;
    ViewState fast = k.view;
    fast.vx = 10'000.0F;
    const CullKey key = choose_key(k.index, fast, {}, nullptr, now, span_default_us, 1024, {1e9, 1e9});
    EXPECT_EQ(key.slack, static_cast<uint32_t>(to_lattice(20'000.0)));
    EXPECT_EQ(key.slack_tangent, widest_slack_tangent);
    EXPECT_TRUE(could_be_chosen(key));
    EXPECT_TRUE(could_be_chosen(choose_key(k.index, fast, {}, nullptr, now)));
    CullKey forged = key;
    forged.slack += 1024;
    EXPECT_FALSE(could_be_chosen(forged));
    forged = key;
    forged.slack_tangent = 0.7F;
    EXPECT_FALSE(could_be_chosen(forged));
}

TEST(CullKey, RegionsAndLogPositionAreTakenOverInPlace) {
    Keys k;
    const std::vector<SyncRegion> regions{{{5, 6}, 700}};
    CullKey expected = k.first;
    expected.regions = regions;
    EXPECT_EQ(choose_key(k.index, k.view, regions, &k.first, now), expected);
    k.world.log_position = {17};
    expected.log_position = {17};
    EXPECT_EQ(choose_key(InterestIndex(k.world, &k.index), k.view, regions, &k.first, now), expected);
}

TEST(CullKey, SpanIsRenewedBeforeItRunsOutAndGrownBoxesMakeNoDelta) {
    const Keys k;
    const SeaTime late = now + span_default_us * 4 / 5;
    const CullKey next = choose_key(k.index, k.view, {}, &k.first, late);
    EXPECT_EQ(next.until, late + span_default_us);
    EXPECT_EQ(next.anchor, k.first.anchor);
    SampleBox grown;
    const InterestIndex index(sample_world({grown}, 8));
    EXPECT_TRUE(difference(cull(index, k.first).state, cull(index, next).state).empty());
    // Jumping back in sea time renews too.
    EXPECT_EQ(choose_key(k.index, k.view, {}, &k.first, now - 600'000'000).until,
              now - 600'000'000 + span_default_us);
}

TEST(CullKey, BudgetRaisesTheErrorInForceInsteadOfDroppingPatches) {
    const Keys k;
    for (const uint32_t budget : {512U, 256U, 180U}) {
        ViewState view = k.view;
        view.viewport_width = 3840;
        view.viewport_height = 2160;
        view.patch_budget = budget;
        const CullKey key = choose_key(k.index, view, {}, nullptr, now);
        const CullResult r = cull(k.index, key);
        EXPECT_GT(key.error_in_force_px, 1.5F);
        EXPECT_EQ(r.report.over_limit, 0U);
        EXPECT_LE(r.report.delivered, budget);
        EXPECT_GE(r.report.delivered, budget / 3);
    }
}

TEST(CullKey, WhateverIsChosenCouldBeChosenAndCostsNoMore) {
    const Keys k;
    for (const uint32_t budget : {1U, 16U, 64U, 256U, 1024U})
        for (const float lens : {0.02F, 0.5F, 20.0F}) {
            ViewState view = k.view;
            view.patch_budget = budget;
            view.tan_half_width = view.tan_half_height = lens;
            const CullKey key = choose_key(k.index, view, {}, nullptr, now);
            EXPECT_TRUE(could_be_chosen(key)) << budget << ' ' << lens;
            EXPECT_TRUE(costs_no_more(k.index, key)) << budget << ' ' << lens;
        }
    CullKey dear = k.first;
    dear.patch_limit = 3;
    EXPECT_FALSE(costs_no_more(k.index, dear));
}

TEST(CullKey, ErrorInForceFallsStepByStepOnceThereIsRoom) {
    const Keys k;
    CullKey key = k.first;
    key.error_in_force_px = 3.0F;
    ViewState view = k.view;
    int steps = 0;
    while (key.error_in_force_px > 1.0F && steps < 30) {
        view = moved(view, 9.0);
        const CullKey next = choose_key(k.index, view, {}, &key, now);
        EXPECT_LE(key.error_in_force_px / next.error_in_force_px, error_step * 1.0001F);
        key = next;
        ++steps;
    }
    EXPECT_EQ(key.error_in_force_px, 1.0F);
    EXPECT_GT(steps, 5);
}

TEST(CullKey, HostileDemandsEndSoon) {
    const Keys k;
    ViewState view = k.view;
    view.viewport_width = view.viewport_height = 16384;
    view.tan_half_width = view.tan_half_height = 0.01F;
    view.accepted_error_px = 0.1F;
    view.patch_budget = 1;
    const CullKey narrow = choose_key(k.index, view, {}, nullptr, now);
    EXPECT_LE(cull(k.index, narrow).report.delivered, 1U);
    view.tan_half_width = view.tan_half_height = 20.0F;
    const CullKey wide = choose_key(k.index, view, {}, nullptr, now);
    const CullResult r = cull(k.index, wide);
    EXPECT_EQ(r.report.delivered, 1U);
    EXPECT_GT(r.report.over_limit, 0U) << "dropped and said so";
}

// What may come back as a client's own key: all that are chosen, and none that would cost more than a view does.
TEST(CullKey, ChosenKeysAreToldFromForgedOnes) {
    const Keys k;
    CullKey key = k.first;
    ViewState view = k.view;
    for (int i = 0; i < 60; ++i) {
        EXPECT_TRUE(could_be_chosen(key)) << i;
        EXPECT_TRUE(fits_limit(k.index, key)) << i;
        view = moved(view, static_cast<double>(i % 7));
        view.altitude += i * 1024;
        view.vx = static_cast<float>(i * 3 % 40);
        if (i % 20 == 19) view.patch_budget = 300;
        key = choose_key(k.index, view, {}, &key, now + i * 3'000'000);
    }
    const auto forged = [&](const auto& change) {
        CullKey other = k.first;
        change(other);
        return !could_be_chosen(other);
    };
    EXPECT_TRUE(forged([](CullKey& c) { c.slack = UINT32_MAX; }));
    EXPECT_TRUE(forged([](CullKey& c) { c.slack = 0; }));
    EXPECT_TRUE(forged([](CullKey& c) { c.slack_tangent = 1.0F; }));
    EXPECT_TRUE(forged([](CullKey& c) { c.error_in_force_px = 0.01F; }));
    EXPECT_TRUE(forged([](CullKey& c) { c.patch_limit = 1024; }));
    EXPECT_TRUE(forged([](CullKey& c) { c.until = c.until + 1; }));
    EXPECT_TRUE(forged([](CullKey& c) { c.anchor.tan_half_width = 1000.0F; }));
}

}  // namespace
}  // namespace trochoid
