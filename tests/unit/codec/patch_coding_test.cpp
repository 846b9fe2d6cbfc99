#include "protocol/codec/patch_coding.hpp"

#include <gtest/gtest.h>

#include "protocol/codec/plane_coding.hpp"
#include "tests/unit/codec/random_messages.hpp"

namespace trochoid {
namespace {

/// What decoding these planes says.
Error verdict(std::span<const uint8_t> planes, std::span<const uint32_t> ids) {
    Scrutiny check;
    InterestDelta change;
    unpack_patches(check, planes, ids, change);
    return check.error();
}

Delta random_planes(Dice& dice, size_t patches, size_t removals) {
    Delta delta;
    delta.change = random_change(dice, 0, 0, patches, 0);
    delta.change.removed_patches = random_change(dice, 0, 0, 0, removals).removed_patches;
    set_planes(delta);
    return delta;
}

/// Patches side by side with the same boxes, as at sea.
InterestDelta even_sea(int32_t side) {
    InterestDelta change;
    for (int32_t x = 0; x < side; ++x)
        for (int32_t z = 0; z < side; ++z)
            change.patches.push_back({{16, x, z}, {{{3}, 8}, {{4}, 12}, {{9}, 16}}, 0.125F, 0.25F});
    return change;
}

/// Planes of one column: whatever numbers one likes.
struct RawPlanes {
    Bytes bytes;
    RawPlanes& shorts(const std::vector<uint16_t>& values) {
        append_plane(bytes, std::span<const uint16_t>(values), 1);
        return *this;
    }
    RawPlanes& ints(const std::vector<int32_t>& values) {
        append_plane(bytes, std::span<const int32_t>(values), 1);
        return *this;
    }
};

TEST(PatchCoding, WhatIsCodedIsReadBack) {
    Dice dice(71);
    for (int round = 0; round < 200; ++round) {
        const auto few = [&] { return static_cast<size_t>(dice.between(0, 40)); };
        const InterestDelta change = random_planes(dice, few(), few()).change;
        if (change.empty()) continue;
        const auto ids = boxes_named(change.patches);
        Scrutiny check;
        InterestDelta back;
        unpack_patches(check, code_patches(change, ids), ids, back);
        ASSERT_FALSE(check.refused()) << check.error().message;
        EXPECT_TRUE(same(back, change));
    }
}

TEST(PatchCoding, AnEvenSeaCostsAByteAPatch) {
    const InterestDelta change = even_sea(20);
    const auto ids = boxes_named(change.patches);
    EXPECT_EQ(ids, (std::vector<uint32_t>{3, 4, 9}));
    EXPECT_LE(code_patches(change, ids).size(), 400U + 20U * 4U + 40U);
}

TEST(PatchCoding, ABoxThatNoPatchNamesIsAnEmptyColumn) {
    const InterestDelta change = even_sea(4);
    const std::vector<uint32_t> ids{1, 3, 4, 9, 4'000'000'000};
    Scrutiny check;
    InterestDelta back;
    unpack_patches(check, code_patches(change, ids), ids, back);
    EXPECT_FALSE(check.refused());
    EXPECT_TRUE(same(back, change));
}

TEST(PatchCoding, CutOrContinuedAnywhereItIsRefused) {
    Dice dice(72);
    const InterestDelta change = random_planes(dice, 9, 5).change;
    const auto ids = boxes_named(change.patches);
    Bytes planes = code_patches(change, ids);
    ASSERT_EQ(verdict(planes, ids).code, ErrorCode::none);
    for (size_t length = 0; length < planes.size(); ++length)
        EXPECT_EQ(verdict(std::span(planes).first(length), ids).code, ErrorCode::value_out_of_range)
            << length;
    planes.push_back(0);
    EXPECT_EQ(verdict(planes, ids).code, ErrorCode::value_out_of_range);
}

TEST(PatchCoding, TheSameBytesUnderOtherBoxesAreRefused) {
    const InterestDelta change = even_sea(3);
    const Bytes planes = code_patches(change, boxes_named(change.patches));
    const auto is_refused = [&](const std::vector<uint32_t>& ids) {
        EXPECT_EQ(verdict(planes, ids).code, ErrorCode::value_out_of_range);
    };
    is_refused({});
    is_refused({3, 4});
    is_refused({3, 4, 9, 10});
    is_refused({3, 9, 4});
    is_refused({3, 3, 4});
}

TEST(PatchCoding, CountsThatNobodyMayMakeRoomFor) {
    const auto is_refused = [](const std::vector<int32_t>& counts, const Bytes& rest) {
        Bytes planes = RawPlanes{}.ints(counts).bytes;
        planes.insert(planes.end(), rest.begin(), rest.end());
        EXPECT_EQ(verdict(planes, {}).code, ErrorCode::value_out_of_range) << counts[0] << ", " << counts[1];
    };
    const Bytes zeros(3000, 0);
    is_refused({0, 0}, {});
    is_refused({-1, 2}, zeros);
    is_refused({2, -1}, zeros);
    is_refused({1025, 0}, zeros);
    is_refused({0, 65537}, Bytes(70000, 1));
    is_refused({INT32_MAX, INT32_MAX}, zeros);
    is_refused({0, 2000}, Bytes(1999, 1));
}

TEST(PatchCoding, ValuesThatDoNotFit) {
    const auto planes = [](uint16_t level, int32_t x, int32_t left_out, uint16_t count) {
        return RawPlanes{}
            .ints({1, 0})
            .shorts({level})
            .ints({x})
            .ints({0})
            .ints({left_out})
            .ints({0})
            .shorts({count})
            .bytes;
    };
    const std::vector<uint32_t> ids{5};
    const auto code = [&](const Bytes& bytes) { return verdict(bytes, ids).code; };
    EXPECT_EQ(code(planes(16, 0, 0, 257)), ErrorCode::none);
    EXPECT_EQ(code(planes(16, 0, 0x7f7fffff, 0)), ErrorCode::none);
    EXPECT_EQ(code(planes(14, 0, 0, 1)), ErrorCode::value_out_of_range);
    EXPECT_EQ(code(planes(256 + 16, 0, 0, 1)), ErrorCode::value_out_of_range);
    EXPECT_EQ(code(planes(16, 1 << 19, 0, 1)), ErrorCode::value_out_of_range);
    EXPECT_EQ(code(planes(16, 0, 0, 258)), ErrorCode::value_out_of_range);
    EXPECT_EQ(code(planes(16, 0, 0x7f800000, 1)), ErrorCode::not_finite);
    EXPECT_EQ(code(planes(16, 0, -1, 1)), ErrorCode::not_finite);
    EXPECT_EQ(code(planes(16, 0, INT32_MIN, 1)), ErrorCode::value_out_of_range);
    EXPECT_EQ(code(planes(16, 0, INT32_MIN + 1, 1)), ErrorCode::value_out_of_range);
}

TEST(PatchCoding, WhatIsMadeOfAMessageStaysBounded) {
    // 1,024 patches with 1,024 boxes each in 5 KB: refused once they are 65,536.
    std::vector<uint32_t> ids(1024);
    for (uint32_t i = 0; i < ids.size(); ++i) ids[i] = i + 1;
    InterestDelta change;
    for (int32_t x = 0; x < 1024; ++x) {
        change.patches.push_back({{16, x, 0}, {}, 0.0F, 0.0F});
        for (const uint32_t id : ids) change.patches.back().boxes.push_back({{id}, 7});
    }
    const Bytes planes = code_patches(change, ids);
    EXPECT_LT(planes.size(), 8192U);
    Scrutiny check;
    InterestDelta back;
    unpack_patches(check, planes, ids, back);
    EXPECT_EQ(check.error().code, ErrorCode::value_out_of_range);
    size_t entries = 0;
    for (const PatchDescriptor& patch : back.patches) entries += patch.boxes.size();
    EXPECT_LE(entries, most_patch_boxes);
}

TEST(PatchCoding, ADeltaKnowsItsForm) {
    Delta delta;
    delta.result = 1;
    delta.change.removed_patches = {{16, 1, 1}};
    for (const PatchForm form : {PatchForm::lists, PatchForm::planes}) {
        delta.patch_form = form;
        const Bytes bytes = encode(ServerMessage{delta});
        const auto back = decode_server(bytes);
        ASSERT_TRUE(back);
        EXPECT_EQ(std::get<Delta>(*back).patch_form, form);
        EXPECT_EQ(encode(*back), bytes);
    }
}

}  // namespace
}  // namespace trochoid
