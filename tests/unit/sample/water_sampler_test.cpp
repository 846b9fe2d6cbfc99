#include "client/sample/water_sampler.hpp"

#include <gtest/gtest.h>

#include <array>

namespace trochoid {
namespace {

constexpr SeaTime now{100'000'000};

std::shared_ptr<StoreSnapshot> one_wave() {
    WaveTrainBox box;
    box.id = {1};
    box.first_train = {1};
    WaveTrain train;
    train.kx = 40018;
    train.kz = 8021;
    train.omega = 1613943558211ULL;
    train.amplitude = 1.25F;
    train.choppiness = 0.8F;
    box.trains = {train};
    auto snapshot = std::make_shared<StoreSnapshot>();
    snapshot->result = 1;
    snapshot->sea = Sea({prepare(box, {})});
    snapshot->key.from = now - 2'000'000;
    snapshot->key.until = now + 120'000'000;
    snapshot->watermark = now + 500'000;
    return snapshot;
}

TEST(Contains, the_disc_is_closed_and_round) {
    const SyncRegion disc{{1000, -2000}, 500};
    EXPECT_TRUE(contains(disc, {1000, -2000}));
    EXPECT_TRUE(contains(disc, {1500, -2000}));
    EXPECT_FALSE(contains(disc, {1501, -2000}));
    EXPECT_TRUE(contains(disc, {1300, -1600}));  // 300, 400
    EXPECT_FALSE(contains(disc, {1301, -1600}));
    EXPECT_FALSE(contains(disc, {1499, -1501}));  // inside the square
    EXPECT_TRUE(contains(SyncRegion{{5, 5}, 0}, {5, 5}));
    EXPECT_FALSE(contains(disc, {world_bound, -world_bound}));
}

TEST(WaterSampler, agrees_with_the_model) {
    const auto snapshot = one_wave();
    const WaterSampler sampler(snapshot, now);
    const SeaInstant model(snapshot->sea, now);
    for (const LatticePoint p : {LatticePoint{0, 0}, {123'456, -98'765}, {-40'000'000, 77}}) {
        EXPECT_EQ(sampler.water(p).water, water_at(model, p));
        EXPECT_EQ(sampler.surface(p), model.evaluate(p));
    }
}

TEST(WaterSampler, many_places_are_answered_as_one_by_one) {
    const auto snapshot = one_wave();
    snapshot->regions = {{{0, 0}, 10'000}};
    auto interest = std::make_shared<InterestState>();
    interest->patches[{18, 0, -1}].key = {18, 0, -1};
    interest->patches[{18, 0, -1}].height_error = 0.125F;
    snapshot->interest = interest;
    const WaterSampler sampler(snapshot, now);
    const SeaInstant model(snapshot->sea, now);
    std::vector<LatticePoint> places;
    for (int64_t i = 0; i < 150; ++i) places.push_back({i * 2'345 - 99'000, 75'000 - i * 1'777});
    const std::vector<WaterAnswer> answers = sampler.water(places);
    const std::vector<SurfaceSample> samples = sampler.surface(places);
    ASSERT_EQ(answers.size(), places.size());
    ASSERT_EQ(samples.size(), places.size());
    std::array<int, 3> trusts{};
    for (size_t i = 0; i < places.size(); ++i) {
        EXPECT_EQ(answers[i].water, water_at(model, places[i]));
        EXPECT_EQ(answers[i], sampler.water(places[i]));
        EXPECT_EQ(samples[i], model.evaluate(places[i]));
        ++trusts[static_cast<size_t>(answers[i].trust)];
    }
    EXPECT_GT(trusts[0], 0);
    EXPECT_GT(trusts[1], 0);
    EXPECT_GT(trusts[2], 0);
    EXPECT_TRUE(sampler.water(std::vector<LatticePoint>{}).empty());
}

TEST(WaterSampler, exact_in_regions_bounded_on_patches_unknown_elsewhere) {
    const auto snapshot = one_wave();
    snapshot->regions = {{{0, 0}, 10'000}};
    auto interest = std::make_shared<InterestState>();
    PatchDescriptor coarse;
    coarse.key = {18, 0, -1};  // x 0 to 262144, z -262144 to 0
    coarse.height_error = 0.25F;
    interest->patches[coarse.key] = coarse;
    snapshot->interest = interest;
    const WaterSampler sampler(snapshot, now);
    EXPECT_EQ(sampler.trust({100, 100}), Trust::exact);
    EXPECT_EQ(sampler.water({100, -100}).height_error, 0.0F);
    const WaterAnswer bounded = sampler.water({200'000, -200'000});
    EXPECT_EQ(bounded.trust, Trust::bounded);
    EXPECT_EQ(bounded.height_error, 0.25F);
    EXPECT_EQ(sampler.trust({-200'000, -200'000}), Trust::unknown);
    EXPECT_EQ(sampler.trust({200'000, 200'000}), Trust::unknown);
}

TEST(WaterSampler, bounds_speak_of_their_span_and_regions_of_the_kept_past_and_all_future) {
    const auto snapshot = one_wave();
    snapshot->regions = {{{0, 0}, 10'000}};
    auto interest = std::make_shared<InterestState>();
    interest->patches[{18, 0, 0}].key = {18, 0, 0};
    snapshot->interest = interest;
    const LatticePoint in_patch{200'000, 200'000};
    EXPECT_EQ(WaterSampler(snapshot, snapshot->key.from).trust(in_patch), Trust::bounded);
    EXPECT_EQ(WaterSampler(snapshot, snapshot->key.from - 1).trust(in_patch), Trust::unknown);
    EXPECT_EQ(WaterSampler(snapshot, snapshot->key.until).trust(in_patch), Trust::unknown);
    EXPECT_EQ(WaterSampler(snapshot, now + 86'400'000'000).trust({0, 0}), Trust::exact);
    EXPECT_EQ(WaterSampler(snapshot, snapshot->key.from - sync_history_us).trust({0, 0}), Trust::exact);
    EXPECT_EQ(WaterSampler(snapshot, snapshot->key.from - sync_history_us - 1).trust({0, 0}), Trust::unknown);
}

TEST(WaterSampler, takes_the_layers_that_are_named) {
    const auto snapshot = one_wave();
    WaveTrainBox noise;
    noise.id = {2};
    noise.first_train = {2};
    noise.noise = {0.2F, 30'000, 3, 12, 20, true, 9};
    snapshot->sea = Sea({snapshot->sea.boxes()[0], prepare(noise, {})});
    snapshot->regions = {{{0, 0}, 10'000}};
    auto interest = std::make_shared<InterestState>();
    interest->patches[{18, 0, 0}].key = {18, 0, 0};
    snapshot->interest = interest;
    const LatticePoint p{4'321, 1'234}, on_patch{200'000, 200'000};
    const WaterSampler felt(snapshot, now);
    const WaterSampler shown(snapshot, now, displayed_layers);
    EXPECT_EQ(felt.surface(p), SeaInstant(one_wave()->sea, now).evaluate(p)) << "displayed noise is not felt";
    EXPECT_EQ(shown.surface(p), SeaInstant(snapshot->sea, now, displayed_layers).evaluate(p));
    EXPECT_NE(shown.surface(p), felt.surface(p));
    EXPECT_EQ(shown.trust(p), Trust::exact);
    EXPECT_EQ(felt.trust(on_patch), Trust::bounded);
    EXPECT_EQ(shown.trust(on_patch), Trust::unknown) << "the stated bound is the authoritative sea's";
}

TEST(WaterSampler, confirmed_up_to_the_watermark) {
    const auto snapshot = one_wave();
    EXPECT_TRUE(WaterSampler(snapshot, snapshot->watermark).water({0, 0}).confirmed);
    EXPECT_FALSE(WaterSampler(snapshot, snapshot->watermark + 1).water({0, 0}).confirmed);
}

TEST(WaterSampler, nothing_known_is_still_water_of_unknown_trust) {
    const WaterSampler sampler(std::make_shared<const StoreSnapshot>(), now);
    const WaterAnswer answer = sampler.water({5, 5});
    EXPECT_EQ(answer.trust, Trust::unknown);
    EXPECT_FALSE(answer.confirmed);
    EXPECT_EQ(answer.water.height, 0.0F);
}

}  // namespace
}  // namespace trochoid
