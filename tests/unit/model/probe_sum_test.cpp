#include "protocol/model/probe_sum.hpp"

#include <gtest/gtest.h>

#include <set>

#include "protocol/model/self_check.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

/// The reference sea as a client holds it.
InterestState state_of(const Sea& sea) {
    InterestState state;
    for (const auto& box : sea.boxes()) {
        state.boxes.emplace(box->record.id, std::make_shared<const WaveTrainBox>(box->record));
        for (const auto& top : box->fields)
            for (auto field = top; field; field = field->base())
                for (const auto& block : field->blocks())
                    state.blocks[{field->id(), block->key}] = {field->id(), field->step_log2(), block, 0};
    }
    return state;
}

/// A patch of 2^level lattice units that holds the point, with all boxes and so many trains of each.
PatchDescriptor patch_around(const InterestState& state, LatticePoint p, uint8_t level, size_t most_trains) {
    PatchDescriptor patch;
    patch.key = patch_at(p, level);
    for (const auto& [id, box] : state.boxes)
        patch.boxes.push_back({id, static_cast<uint16_t>(std::min(most_trains, box->trains.size()))});
    return patch;
}

LatticePoint point(uint64_t i) {
    const uint64_t a = splitmix64(i);
    const uint64_t b = splitmix64(a);
    constexpr int64_t span = 4'194'304;
    return {static_cast<int64_t>(a % span) - span / 2, static_cast<int64_t>(b % span) - span / 2};
}

SeaTime moment(uint64_t i) { return {static_cast<int64_t>(splitmix64(i * 77) % 900'000'000)}; }

// Without patches all boxes count: step by step it comes to what the sea evaluates to, displayed noise included.
TEST(ProbeSum, EndsInTheSampleOfTheSea) {
    const Sea sea = reference_sea();
    const InterestState state = state_of(sea);
    std::set<PartKind> kinds;
    for (uint64_t i = 0; i < 400; ++i) {
        const SurfaceSample wanted = SeaInstant(sea, moment(i), displayed_layers).evaluate(point(i));
        const PointSum sum = probe_sum(state, moment(i), point(i));
        ASSERT_EQ(sum.sample, hash_of({&wanted, 1})) << i;
        for (const PartSum& part : sum.parts) kinds.insert(kind_of(part.box, part.part));
    }
    EXPECT_EQ(kinds, (std::set{PartKind::train, PartKind::wake, PartKind::noise}));
}

// Each step's hash is that of the sum that ends there: the twin leaves out what comes after it.
TEST(ProbeSum, EveryStepIsTheSumOfAllBeforeIt) {
    const InterestState whole = state_of(reference_sea());
    for (uint64_t i = 0; i < 40; ++i) {
        const LatticePoint p = point(i);
        InterestState state = whole;
        const PatchDescriptor patch = patch_around(state, p, 20, 256);
        state.patches[patch.key] = patch;
        const PointSum sum = probe_sum(state, moment(i), p);
        for (size_t step = 0; step < sum.parts.size(); ++step) {
            const PartSum& part = sum.parts[step];
            if (part.part >= wake_part) continue;
            InterestState shorter = state;
            PatchDescriptor& cut = shorter.patches[patch.key];
            std::erase_if(cut.boxes, [&](const PatchBox& b) { return b.box > part.box; });
            cut.boxes.back().train_count = static_cast<uint16_t>(part.part + 1);
            const PointSum twin = probe_sum(shorter, moment(i), p);
            ASSERT_GT(twin.parts.size(), step);
            ASSERT_EQ(twin.parts[step], part) << i << " step " << step;
        }
        std::vector<PartSum> order = sum.parts;
        std::sort(order.begin(), order.end(), [](const PartSum& a, const PartSum& b) {
            return std::pair(a.box, a.part) < std::pair(b.box, b.part);
        });
        EXPECT_EQ(order, sum.parts) << "boxes ascending, trains in order, then wake and noise";
    }
}

TEST(ProbeSum, ThePatchThatHoldsThePointSaysWhatCounts) {
    InterestState state = state_of(reference_sea());
    const LatticePoint p = point(3);
    const SeaTime t = moment(3);
    const PointSum all = probe_sum(state, t, p);
    const PatchDescriptor patch = patch_around(state, p, 18, 1);
    state.patches[patch.key] = patch;
    // Another patch, farther off, has no say.
    const PatchDescriptor other = patch_around(state, {p.x + (int64_t{4} << 18), p.z}, 18, 256);
    state.patches[other.key] = other;
    ASSERT_NE(patch_holding(state, p), nullptr);
    EXPECT_EQ(patch_holding(state, p)->key, patch.key);
    const PointSum few = probe_sum(state, t, p);
    EXPECT_LT(few.parts.size(), all.parts.size());
    for (const PartSum& part : few.parts) EXPECT_TRUE(part.part == 0 || part.part >= wake_part);
    EXPECT_NE(few.sample, all.sample);
    // Past the patch's east edge it holds no more.
    EXPECT_EQ(patch_holding(state, {rect_of(patch.key).max.x, p.z}), nullptr);
}

TEST(ProbeSum, PartsThatAreNotListedCountStill) {
    const InterestState state = state_of(reference_sea());
    const PointSum all = probe_sum(state, moment(5), point(5));
    ASSERT_GT(all.parts.size(), 4U);
    const PointSum some = probe_sum(state, moment(5), point(5), 3);
    EXPECT_EQ(some.sample, all.sample);
    ASSERT_EQ(some.parts.size(), 3U);
    EXPECT_TRUE(std::equal(some.parts.begin(), some.parts.end(), all.parts.begin()));
}

// A bit of a train, a node of a land block, the seed of a noise: each is found in the part where it first counts.
TEST(ProbeSum, DifferencesAreFoundWhereTheyBegin) {
    const InterestState good = state_of(reference_sea());
    size_t of_train = 0;
    size_t of_land = 0;
    size_t of_noise = 0;
    for (uint64_t i = 0; i < 60; ++i) {
        const LatticePoint p = point(i);
        const SeaTime t = moment(i);
        const PointSum right = probe_sum(good, t, p);
        EXPECT_FALSE(first_difference(right, right));
        for (const PartSum& part : right.parts) {
            InterestState bad = good;
            const PartKind kind = kind_of(part.box, part.part);
            auto box = std::make_shared<WaveTrainBox>(*good.boxes.at(part.box));
            if (kind == PartKind::train) box->trains[part.part].phase ^= 1U << 20;
            if (kind == PartKind::noise) box->noise.seed ^= 1;
            if (kind == PartKind::wake) box->wake.transverse *= 0.5F;
            bad.boxes[part.box] = box;
            const auto found = first_difference(right, probe_sum(bad, t, p));
            // Where a train's gain is 0 nothing shows.
            if (!found) continue;
            EXPECT_EQ(found->box, part.box);
            EXPECT_EQ(found->part, part.part);
            EXPECT_EQ(found->theirs, part.sum);
            (kind == PartKind::noise ? of_noise : of_train) += 1;
        }
        for (const auto& [key, block] : good.blocks) {
            InterestState bad = good;
            auto changed = std::make_shared<LandBlock>(*block.block);
            for (int32_t& shift : changed->shift) shift += 1000;
            bad.blocks[key].block = changed;
            const auto found = first_difference(right, probe_sum(bad, t, p));
            if (!found) continue;
            // The first train that reads the field, or a field over it.
            const WaveTrainBox& box = *good.boxes.at(found->box);
            ASSERT_LT(found->part, box.trains.size());
            FieldId field = box.trains[found->part].field;
            while (field != key.field) {
                const auto overlay = std::find_if(box.overlays.begin(), box.overlays.end(),
                                                  [&](const FieldOverlay& o) { return o.field == field; });
                ASSERT_NE(overlay, box.overlays.end());
                field = overlay->base;
            }
            ++of_land;
        }
    }
    EXPECT_GT(of_train, 50U);
    EXPECT_GT(of_land, 5U);
    EXPECT_GT(of_noise, 5U);
}

TEST(ProbeSum, APartThatOneSideLacksIsTheDifference) {
    const PointSum both{7, {{{1}, 0, 11}, {{2}, 0, 12}}};
    const PointSum fewer{8, {{{2}, 0, 13}}};
    EXPECT_EQ(first_difference(both, fewer), (PartDifference{{1}, 0, 11, 0}));
    EXPECT_EQ(first_difference(fewer, both), (PartDifference{{1}, 0, 0, 11}));
    const PointSum shorter{9, {{{1}, 0, 11}}};
    EXPECT_EQ(first_difference(both, shorter), (PartDifference{{2}, 0, 12, 0}));
    const PointSum unlisted{9, both.parts};
    EXPECT_EQ(first_difference(both, unlisted), (PartDifference{{}, 0, 7, 9}));
}

}  // namespace
}  // namespace trochoid
