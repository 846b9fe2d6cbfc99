#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "protocol/codec/codec.hpp"
#include "tests/unit/codec/random_messages.hpp"

namespace trochoid {
namespace {

constexpr size_t frame_limit = 16384;

Delta header_with_regions(Dice& dice) {
    Delta header = std::get<Delta>(random_server_message(dice, 2));
    header.key.regions.resize(32);
    header.change = {};
    return header;
}

InterestDelta joined(const std::vector<Delta>& pieces) {
    InterestDelta all;
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    for (const Delta& piece : pieces) {
        append(all.boxes, piece.change.boxes);
        append(all.blocks, piece.change.blocks);
        append(all.patches, piece.change.patches);
        append(all.removed_boxes, piece.change.removed_boxes);
        append(all.removed_blocks, piece.change.removed_blocks);
        append(all.removed_patches, piece.change.removed_patches);
    }
    return all;
}

TEST(Split, EveryPieceFitsAndAllTogetherAreTheChange) {
    Dice dice(21);
    size_t most_pieces = 0;
    for (int i = 0; i < 24; ++i) {
        const auto many = [&](int64_t most) { return static_cast<size_t>(dice.between(0, most)); };
        const InterestDelta change = random_change(dice, many(40), many(60), many(1024), many(400));
        Delta header = header_with_regions(dice);
        header.patch_form = i % 2 == 0 ? PatchForm::lists : PatchForm::planes;
        const std::vector<Delta> pieces = split(header, change, frame_limit);
        most_pieces = std::max(most_pieces, pieces.size());
        for (size_t p = 0; p < pieces.size(); ++p) {
            const Delta& piece = pieces[p];
            const Bytes bytes = encode(ServerMessage{piece});
            EXPECT_LE(bytes.size(), frame_limit) << "piece " << p;
            const auto back = decode_server(bytes);
            ASSERT_TRUE(back) << back.error().message;
            EXPECT_TRUE(same(*back, ServerMessage{piece}));
            EXPECT_EQ(piece.result, header.result);
            EXPECT_EQ(piece.base, header.base);
            EXPECT_EQ(piece.base_hash, header.base_hash);
            EXPECT_EQ(piece.key, header.key);
            EXPECT_EQ(piece.piece, p);
            EXPECT_EQ(piece.last, p + 1 == pieces.size());
            EXPECT_EQ(piece.state_hash, piece.last ? header.state_hash : 0);
        }
        InterestDelta all = joined(pieces);
        // Blocks travel with the patches over them: another order, the same blocks.
        const auto by_place = [](const FieldBlock& a, const FieldBlock& b) {
            return std::tie(a.field, a.step_log2, a.block->key, a.block) <
                   std::tie(b.field, b.step_log2, b.block->key, b.block);
        };
        InterestDelta expected = change;
        if (header.patch_form == PatchForm::planes)
            for (InterestDelta* delta : {&all, &expected}) {
                std::ranges::sort(delta->patches, {}, [](const PatchDescriptor& p) { return p.key; });
                std::ranges::sort(delta->removed_patches);
            }
        std::sort(all.blocks.begin(), all.blocks.end(), by_place);
        std::sort(expected.blocks.begin(), expected.blocks.end(), by_place);
        EXPECT_TRUE(same(all, expected));
    }
    EXPECT_GT(most_pieces, 3U);
}

// As planes, equal counts cost next to nothing: the number of boxes ends a piece before its bytes do.
TEST(Split, NoPieceHasMoreBoxesThanAReaderTakes) {
    Dice dice(25);
    InterestDelta change;
    for (int32_t x = 0; x < 1024; ++x) {
        change.patches.push_back({{16, x, 0}, {}, 0.0F, 0.0F});
        for (uint32_t id = 1; id <= 66; ++id) change.patches.back().boxes.push_back({{id}, 7});
    }
    for (const PatchForm form : {PatchForm::lists, PatchForm::planes}) {
        Delta header = header_with_regions(dice);
        header.patch_form = form;
        const std::vector<Delta> pieces = split(header, change, frame_limit);
        for (const Delta& piece : pieces) {
            const auto back = decode_server(encode(ServerMessage{piece}));
            ASSERT_TRUE(back) << back.error().message;
        }
        EXPECT_TRUE(same(joined(pieces), change));
    }
}

TEST(Split, PiecesAreWellFilled) {
    Dice dice(22);
    Delta header = header_with_regions(dice);
    header.key.regions.clear();
    for (const PatchForm form : {PatchForm::lists, PatchForm::planes}) {
        header.patch_form = form;
        const std::vector<Delta> pieces = split(header, random_change(dice, 0, 0, 1024, 0), frame_limit);
        ASSERT_GT(pieces.size(), 1U);
        for (const Delta& piece : pieces)
            EXPECT_TRUE(piece.last || encode(ServerMessage{piece}).size() > frame_limit * 98 / 100)
                << "piece " << piece.piece;
    }
}

TEST(Split, ThePatchesOfAPieceAreTheNextByPriority) {
    Dice dice(27);
    Delta header = header_with_regions(dice);
    header.patch_form = PatchForm::planes;
    const InterestDelta change = random_change(dice, 0, 0, 1024, 0);
    auto next = change.patches.begin();
    for (const Delta& piece : split(header, change, 6000)) {
        std::vector<PatchDescriptor> due(next,
                                         next + static_cast<std::ptrdiff_t>(piece.change.patches.size()));
        next += static_cast<std::ptrdiff_t>(due.size());
        std::ranges::sort(due, {}, [](const PatchDescriptor& p) { return p.key; });
        EXPECT_EQ(piece.change.patches, due);
    }
    EXPECT_EQ(next, change.patches.end());
}

TEST(Split, NothingToSayIsOneLastPiece) {
    Dice dice(23);
    const Delta header = header_with_regions(dice);
    const std::vector<Delta> pieces = split(header, {}, frame_limit);
    ASSERT_EQ(pieces.size(), 1U);
    EXPECT_TRUE(pieces[0].last);
    EXPECT_EQ(pieces[0].state_hash, header.state_hash);
}

TEST(Split, TheLargestBoxTheRoughestBlockAndTheBusiestPatchFitAlone) {
    Dice dice(24);
    Delta header = header_with_regions(dice);
    InterestDelta change;
    WaveTrainBox largest = random_box(dice, 9, 256);
    for (uint32_t i = 0; i < 256; ++i) largest.trains[i].field = {300 + i};
    largest.overlays.clear();
    for (uint32_t i = 0; i < 256; ++i) largest.overlays.push_back({{300 + i}, {1 + i}});
    largest.raised_us = largest.fade_us = 1;
    largest.course.clear();
    for (int64_t i = 0; i < 64; ++i) largest.course.push_back({{i}, 1, {0, 0}, 0, 0});
    largest.origin = {0, 0};
    largest.irregular = {1, 1, 1, 1, 1, 1, 1, 1};
    largest.noise.amplitude = 1.0F;
    ASSERT_TRUE(validate(largest)) << validate(largest).error().message;
    change.boxes.push_back(std::make_shared<WaveTrainBox>(largest));
    LandBlock rough;
    for (size_t i = 0; i < rough.shift.size(); ++i) {
        rough.shift[i] = static_cast<int32_t>(dice.between(-4194303, 4194303));
        rough.gain[i] = dice.any<uint16_t>();
        rough.orbit[i] = dice.any<uint16_t>();
    }
    ASSERT_TRUE(validate(rough));
    change.blocks.push_back({{1}, 16, std::make_shared<LandBlock>(rough), 0});
    PatchDescriptor busy;
    for (uint32_t box = 1; box <= 1024; ++box) busy.boxes.push_back({{box}, 64});
    change.patches.push_back(busy);
    for (const PatchForm form : {PatchForm::lists, PatchForm::planes}) {
        header.patch_form = form;
        for (const Delta& piece : split(header, change, frame_limit))
            EXPECT_LE(encode(ServerMessage{piece}).size(), frame_limit);
    }
}

TEST(Split, ABlockComesWithTheFirstPatchOverIt) {
    Dice dice(25);
    InterestDelta change;
    for (int32_t x : {0, 1, 2}) change.patches.push_back({{20, x, 0}, {}, 0.0F, 0.0F});
    for (int32_t x : {2, 0})
        change.blocks.push_back({{1}, 16, std::make_shared<LandBlock>(random_block(dice, {x, 0})), 0});
    // A block of step 2^16 spans 2^20, so block x lies under patch x and touches its neighbours' edges.
    const Delta header = header_with_regions(dice);
    const std::vector<Delta> pieces =
        split(header, change, encode(ServerMessage{header}).size() + 240 + 3500);
    ASSERT_FALSE(pieces.empty());
    EXPECT_EQ(pieces.front().change.blocks.front().block->key.x, 0);
}

TEST(Split, AppliedPieceByPieceTheStateIsTheSame) {
    Dice dice(26);
    InterestState base;
    apply(base, random_change(dice, 20, 30, 200, 0));
    InterestState target = base;
    apply(target, random_change(dice, 20, 30, 200, 0));
    while (target.patches.size() > 150) target.patches.erase(target.patches.begin());
    while (target.blocks.size() > 20) target.blocks.erase(target.blocks.begin());
    Delta header = header_with_regions(dice);
    header.state_hash = hash_of(target);
    for (const PatchForm form : {PatchForm::lists, PatchForm::planes}) {
        header.patch_form = form;
        InterestState client = base;
        for (const Delta& piece : split(header, difference(base, target), 12000)) {
            const auto came = decode_server(encode(ServerMessage{piece}));
            ASSERT_TRUE(came) << came.error().message;
            const Delta& delta = std::get<Delta>(*came);
            apply(client, delta.change);
            EXPECT_TRUE(!delta.last || delta.state_hash == hash_of(client));
        }
        EXPECT_EQ(hash_of(client), hash_of(target));
    }
}

}  // namespace
}  // namespace trochoid
