#include "client/store/client_store.hpp"

#include <gtest/gtest.h>

namespace trochoid {
namespace {

std::shared_ptr<const WaveTrainBox> box(uint32_t id, uint32_t field = 0, float amplitude = 1.0F) {
    WaveTrainBox b;
    b.id = {id};
    b.first_train = {id * 10};
    b.end = {1'000'000'000};
    WaveTrain train;
    train.kx = 40018;
    train.kz = 8021;
    train.omega = 1613943558211ULL;
    train.amplitude = amplitude;
    train.choppiness = 0.5F;
    train.field = {field};
    b.trains = {train};
    return std::make_shared<const WaveTrainBox>(b);
}

FieldBlock block(uint32_t field, int32_t x, int32_t z, uint8_t step = 16, uint16_t gain = 1U << 14) {
    auto b = std::make_shared<LandBlock>();
    b->key = {x, z};
    b->gain.fill(gain);
    FieldBlock f;
    f.field = {field};
    f.step_log2 = step;
    f.block = std::move(b);
    return f;
}

PatchDescriptor patch(int32_t x, int32_t z) {
    PatchDescriptor p;
    p.key = {16, x, z};
    p.boxes = {{{1}, 1}};
    return p;
}

/// The server's side: what it has told, and messages that follow on it.
struct Teller {
    InterestState told;
    uint32_t result = 0;
    uint32_t base = 0;
    CullKey key;

    ServerHello hello(uint8_t world = 1) const {
        ServerHello h;
        h.session = 1;
        h.instance.bytes[0] = world;
        return h;
    }
    /// Pieces of the next result; `more` makes one piece for each change given.
    std::vector<Delta> tell(const std::vector<InterestDelta>& more) {
        std::vector<Delta> pieces;
        const uint64_t base_hash = hash_of(told);
        for (const InterestDelta& change : more) {
            apply(told, change);
            Delta d;
            d.result = result + 1;
            d.piece = static_cast<uint16_t>(pieces.size());
            d.base = base;
            d.base_hash = base_hash;
            d.key = key;
            d.change = change;
            pieces.push_back(d);
        }
        pieces.back().last = true;
        pieces.back().state_hash = hash_of(told);
        base = ++result;
        return pieces;
    }
    Delta tell_one(const InterestDelta& change) { return tell({change}).front(); }
    void start_again() {
        told = {};
        base = 0;
    }
};

struct StoreTest : testing::Test {
    Teller server;
    ClientStore store;
    void SetUp() override { store.begin(server.hello()); }
    /// Applies a piece that the standard allows.
    std::optional<Ack> take(const Delta& piece) {
        auto ack = store.apply(piece);
        EXPECT_TRUE(ack) << (ack ? "" : ack.error().message);
        return ack ? *ack : std::nullopt;
    }
    ErrorCode refused(const Delta& piece) {
        const auto ack = store.apply(piece);
        return ack ? ErrorCode::none : ack.error().code;
    }
};

TEST_F(StoreTest, a_snapshot_becomes_a_sea_and_is_acknowledged) {
    server.key.regions = {{{5, 6}, 1024}};
    server.key.log_position = {4};
    const Delta d = server.tell_one({{box(1)}, {}, {}, {}, {patch(0, 0)}, {}});
    const auto ack = take(d);
    ASSERT_TRUE(ack);
    EXPECT_EQ(ack->result, 1U);
    EXPECT_EQ(ack->state_hash, hash_of(server.told));
    const auto s = store.snapshot();
    EXPECT_EQ(s->result, 1U);
    EXPECT_EQ(s->regions, server.key.regions);
    EXPECT_EQ(s->log_position.value, 4U);
    EXPECT_EQ(s->interest->patches.size(), 1U);
    ASSERT_EQ(s->sea.boxes().size(), 1U);
    EXPECT_NE(SeaInstant(s->sea, {1000}).evaluate({77, 99}).ay, 0.0F);
}

TEST_F(StoreTest, pieces_show_only_when_whole) {
    const auto pieces =
        server.tell({{{box(1)}, {}, {}, {}, {}, {}}, {{box(2)}, {}, {}, {}, {patch(1, 1)}, {}}});
    const auto before = store.snapshot();
    EXPECT_FALSE(take(pieces[0]));
    EXPECT_EQ(store.snapshot(), before);
    EXPECT_TRUE(take(pieces[1]));
    EXPECT_EQ(store.snapshot()->interest->boxes.size(), 2U);
}

TEST_F(StoreTest, deltas_build_on_deltas_and_removal_removes) {
    take(server.tell_one({{box(1), box(2)}, {}, {}, {}, {patch(0, 0), patch(1, 0)}, {}}));
    take(server.tell_one({{box(3)}, {{1}}, {}, {}, {}, {{16, 0, 0}}}));
    const auto s = store.snapshot();
    EXPECT_EQ(hash_of(*s->interest), hash_of(server.told));
    EXPECT_EQ(s->sea.boxes().size(), 2U);
    EXPECT_FALSE(s->interest->boxes.contains({1}));
}

TEST_F(StoreTest, what_did_not_change_keeps_its_object) {
    take(server.tell_one({{box(1, 5), box(2)}, {}, {block(5, 0, 0)}, {}, {}, {}}));
    const auto first = store.snapshot();
    take(server.tell_one({{box(2, 0, 2.0F)}, {}, {}, {}, {}, {}}));
    const auto second = store.snapshot();
    EXPECT_EQ(first->sea.boxes()[0], second->sea.boxes()[0]);
    EXPECT_NE(first->sea.boxes()[1], second->sea.boxes()[1]);
    take(server.tell_one({}));  // a marker: nothing but an ack asked for
    EXPECT_EQ(store.snapshot()->interest, second->interest);
    EXPECT_EQ(store.snapshot()->result, 3U);
}

TEST_F(StoreTest, a_land_block_that_comes_or_goes_reaches_its_box) {
    take(server.tell_one({{box(1, 5)}, {}, {}, {}, {}, {}}));
    const auto height = [this] { return SeaInstant(store.snapshot()->sea, {1000}).evaluate({77, 99}).ay; };
    const float open = height();
    take(server.tell_one({{}, {}, {block(5, 0, 0)}, {}, {}, {}}));
    EXPECT_FLOAT_EQ(height(), open * 0.5F);
    take(server.tell_one({{}, {}, {block(5, 0, 0, 16, 1U << 13)}, {}, {}, {}}));
    EXPECT_FLOAT_EQ(height(), open * 0.25F);
    take(server.tell_one({{}, {}, {}, {{{5}, {0, 0}}}, {}, {}}));
    EXPECT_EQ(height(), open);
}

TEST_F(StoreTest, pieces_out_of_order_are_the_servers_breach) {
    const auto pieces = server.tell(
        {{{box(1)}, {}, {}, {}, {}, {}}, {{box(2)}, {}, {}, {}, {}, {}}, {{box(3)}, {}, {}, {}, {}, {}}});
    EXPECT_EQ(refused(pieces[1]), ErrorCode::sequence_not_monotone);
    take(pieces[0]);
    EXPECT_EQ(refused(pieces[0]), ErrorCode::sequence_not_monotone);
    EXPECT_EQ(refused(pieces[2]), ErrorCode::sequence_not_monotone);
}

TEST_F(StoreTest, results_number_without_gaps) {
    take(server.tell_one({{box(1)}, {}, {}, {}, {}, {}}));
    const Delta second = server.tell_one({{box(2)}, {}, {}, {}, {}, {}});
    const Delta third = server.tell_one({{box(3)}, {}, {}, {}, {}, {}});
    EXPECT_EQ(refused(third), ErrorCode::sequence_not_monotone);
    take(second);
    EXPECT_EQ(refused(second), ErrorCode::sequence_not_monotone);
}

TEST_F(StoreTest, a_result_is_not_cut_short_unasked) {
    const auto pieces = server.tell({{{box(1)}, {}, {}, {}, {}, {}}, {{box(2)}, {}, {}, {}, {}, {}}});
    take(pieces[0]);
    server.start_again();
    EXPECT_EQ(refused(server.tell_one({{box(1)}, {}, {}, {}, {}, {}})), ErrorCode::sequence_not_monotone);
}

TEST_F(StoreTest, another_base_asks_for_a_resync_once_the_result_is_whole) {
    take(server.tell_one({{box(1)}, {}, {}, {}, {}, {}}));
    const auto shown = store.snapshot();
    auto pieces = server.tell({{{box(2)}, {}, {}, {}, {}, {}}, {{box(3)}, {}, {}, {}, {}, {}}});
    for (Delta& piece : pieces) piece.base_hash ^= 1;
    EXPECT_FALSE(take(pieces[0])) << "an ack of a result that is still being written";
    const auto ack = take(pieces[1]);
    ASSERT_TRUE(ack);
    EXPECT_EQ(ack->result, 2U);
    EXPECT_EQ(ack->state_hash, 0U);
    EXPECT_EQ(store.counters().resyncs, 1U);
    EXPECT_EQ(store.snapshot(), shown) << "the last good picture stays";
    // Under way before the server heard: passes by. Then the snapshot.
    EXPECT_FALSE(take(server.tell_one({{box(4)}, {}, {}, {}, {}, {}})));
    server.start_again();
    const auto good = take(server.tell_one({{box(9)}, {}, {}, {}, {}, {}}));
    ASSERT_TRUE(good);
    EXPECT_EQ(good->state_hash, hash_of(server.told));
    EXPECT_EQ(store.snapshot()->interest->boxes.size(), 1U);
    EXPECT_EQ(store.counters().resyncs, 1U);
    EXPECT_EQ(store.counters().passed_by, 3U);
}

TEST_F(StoreTest, another_hash_asks_for_a_resync) {
    take(server.tell_one({{box(1)}, {}, {}, {}, {}, {}}));
    const auto shown = store.snapshot();
    Delta d = server.tell_one({{box(2)}, {}, {}, {}, {}, {}});
    d.state_hash ^= 1;
    const auto ack = take(d);
    ASSERT_TRUE(ack);
    EXPECT_EQ(ack->state_hash, 0U);
    EXPECT_EQ(store.snapshot(), shown);
    // The server may leave a result unfinished to start again.
    const auto cut = server.tell({{{box(3)}, {}, {}, {}, {}, {}}, {{box(4)}, {}, {}, {}, {}, {}}});
    EXPECT_FALSE(take(cut[0]));
    server.start_again();
    EXPECT_TRUE(take(server.tell_one({{box(5)}, {}, {}, {}, {}, {}})));
    EXPECT_EQ(hash_of(*store.snapshot()->interest), hash_of(server.told));
}

TEST_F(StoreTest, blocks_of_one_field_share_step_and_neighbourhood) {
    EXPECT_EQ(refused(server.tell_one({{}, {}, {block(5, 0, 0, 16), block(5, 1, 0, 15)}, {}, {}, {}})),
              ErrorCode::value_out_of_range);
    ClientStore other;
    other.begin(server.hello());
    Teller far;
    const auto d = other.apply(far.tell_one(
        {{}, {}, {block(5, -1'000'000, -1'000'000), block(5, 1'000'000, 1'000'000)}, {}, {}, {}}));
    ASSERT_FALSE(d);
    EXPECT_EQ(d.error().code, ErrorCode::too_much_land);
}

/// Two blocks of each field at the corners of a window of 2048 x 2048 slots: 64 MiB of look-up for 4.6 KiB of land.
InterestDelta hostile_windows(uint32_t fields) {
    InterestDelta change;
    for (uint32_t i = 1; i <= fields; ++i) {
        change.blocks.push_back(block(i, 0, 0));
        change.blocks.push_back(block(i, 2047, 2047));
    }
    return change;
}

TEST_F(StoreTest, windows_over_all_fields_have_a_budget) {
    // Each of the 256 windows alone is one that a field may have; together they would take 16 GiB.
    EXPECT_EQ(refused(server.tell_one(hostile_windows(256))), ErrorCode::too_much_land);
    EXPECT_EQ(store.snapshot()->result, 0U);
    // What fits exactly is taken, also piece by piece and beside what was there before.
    ClientStore narrow({2 * 2048 * 2048, 40});
    Teller other;
    narrow.begin(other.hello());
    const auto taken = [&](const InterestDelta& change) {
        return narrow.apply(other.tell_one(change)).has_value();
    };
    EXPECT_TRUE(taken(hostile_windows(1)));
    InterestDelta second = hostile_windows(2);
    second.blocks.erase(second.blocks.begin(), second.blocks.begin() + 2);
    EXPECT_TRUE(taken(second));
    InterestDelta third;
    third.blocks = {block(3, 0, 0)};
    third.removed_blocks = {{{2}, {2047, 2047}}};
    EXPECT_TRUE(taken(third)) << "one window has shrunk to a slot, one more came";
    EXPECT_FALSE(taken({{}, {}, {block(2, 2047, 2047)}, {}, {}, {}})) << "a slot too many";
}

TEST_F(StoreTest, land_blocks_are_counted_before_a_result_is_whole) {
    ClientStore narrow({size_t{1} << 24, 3});
    Teller other;
    narrow.begin(other.hello());
    std::vector<InterestDelta> pieces(8);
    for (int32_t i = 0; i < 8; ++i) pieces[static_cast<size_t>(i)].blocks = {block(1, i, 0)};
    const auto told = other.tell(pieces);
    // What goes may still stand beside what comes, so twice as much as may stay passes for the time being.
    for (size_t i = 0; i < 6; ++i) EXPECT_TRUE(narrow.apply(told[i])) << i;
    const auto seventh = narrow.apply(told[6]);
    ASSERT_FALSE(seventh);
    EXPECT_EQ(seventh.error().code, ErrorCode::too_much_land) << "the server has broken nothing";
    EXPECT_NE(seventh.error().message.find("this client holds 3"), std::string::npos);
}

// What eight wide regions take of 41 winds over a coast: more than a quarter of a million blocks, which an honest server sends.
TEST_F(StoreTest, an_honest_servers_land_has_room) {
    InterestDelta change;
    const FieldBlock one = block(1, 0, 0);
    for (uint32_t field = 1; field <= (1U << 18) + 1000; ++field) {
        change.blocks.push_back(one);
        change.blocks.back().field = {field};
    }
    take(server.tell_one(change));
    EXPECT_EQ(store.snapshot()->interest->blocks.size(), (size_t{1} << 18) + 1000);
}

// A window near its largest, read by many boxes over a base: they share it.
TEST_F(StoreTest, boxes_share_the_window_of_a_field) {
    InterestDelta change = hostile_windows(2);
    for (uint32_t i = 1; i <= 200; ++i) {
        WaveTrainBox b = *box(i, 2);
        b.overlays = {{{2}, {1}}};
        change.boxes.push_back(std::make_shared<const WaveTrainBox>(b));
    }
    take(server.tell_one(change));
    const auto& boxes = store.snapshot()->sea.boxes();
    ASSERT_EQ(boxes.size(), 200U);
    // Of 200 windows of 64 MiB each only one is there, or this machine would feel it.
    for (const auto& prepared : boxes) {
        ASSERT_EQ(prepared->fields.size(), 1U);
        EXPECT_EQ(prepared->fields[0]->find({0, 0}), boxes[0]->fields[0]->find({0, 0}));
    }
}

TEST_F(StoreTest, a_field_may_change_its_step_whole) {
    take(server.tell_one({{box(1, 5)}, {}, {block(5, 0, 0, 16)}, {}, {}, {}}));
    take(server.tell_one({{}, {}, {block(5, 3, 3, 15)}, {{{5}, {0, 0}}}, {}, {}}));
    EXPECT_EQ(hash_of(*store.snapshot()->interest), hash_of(server.told));
}

/// A box whose train reads field 6 over 5 over 3.
std::shared_ptr<const WaveTrainBox> overlaid_box(uint32_t id) {
    WaveTrainBox b = *box(id, 6);
    b.overlays = {{{5}, {3}}, {{6}, {5}}};
    return std::make_shared<const WaveTrainBox>(b);
}

FieldBlock uneven_block(uint32_t field, int32_t x, uint16_t gain) {
    const FieldBlock even = block(field, x, 0, 16, gain);
    auto b = std::make_shared<LandBlock>(*even.block);
    for (size_t i = 0; i < b->shift.size(); ++i) {
        b->shift[i] = static_cast<int32_t>(i * field * 40);
        b->orbit[i] = static_cast<uint16_t>(unit_node_orbit + i * gain / 500);
    }
    return {even.field, even.step_log2, b, 0};
}

/// The box's sea as a server prepares it, from whole fields.
Sea servers_sea(const WaveTrainBox& record, const std::vector<FieldBlock>& blocks) {
    std::map<FieldId, std::shared_ptr<LandField>> fields;
    for (const FieldBlock& b : blocks) {
        auto& field = fields[b.field];
        if (!field) field = std::make_shared<LandField>(b.field, b.step_log2);
        field->set(b.block);
    }
    std::vector<std::shared_ptr<const LandField>> all;
    for (const auto& [id, field] : fields) all.push_back(field);
    return Sea({prepare(record, all)});
}

uint64_t hash_at(const SeaInstant& sea, LatticePoint p) {
    const SurfaceSample sample = sea.evaluate(p);
    return hash_of(std::span(&sample, 1));
}

/// Bits of both seas over blocks -1 to 4 (each 1,048,576 lattice units wide).
void expect_same_sea(const Sea& ours, const Sea& servers) {
    for (int64_t t : {1'000LL, 123'456'789LL}) {
        const SeaInstant a(ours, {t});
        const SeaInstant b(servers, {t});
        for (int64_t i = 0; i < 600; ++i) {
            const LatticePoint p{-1'000'000 + i * 9'973, (i * 7'919) % 1'000'000};
            ASSERT_EQ(hash_at(a, p), hash_at(b, p)) << "x " << p.x;
        }
    }
}

TEST_F(StoreTest, a_sea_with_overlays_is_the_servers_to_the_bit) {
    const auto record = overlaid_box(1);
    std::vector<FieldBlock> blocks{uneven_block(3, 0, 20000), uneven_block(3, 1, 24000),
                                   uneven_block(3, 2, 28000), uneven_block(5, 1, 10000),
                                   uneven_block(5, 2, 12000), uneven_block(6, 2, 40000)};
    // Water that is open again has to be told: a trivial block over one that is not.
    blocks.push_back(block(6, 0, 0, 16, unit_node_gain));
    take(server.tell_one({{record}, {}, blocks, {}, {}, {}}));
    expect_same_sea(store.snapshot()->sea, servers_sea(*record, blocks));
}

TEST_F(StoreTest, a_field_without_blocks_of_its_own_reads_its_base) {
    const auto record = overlaid_box(1);
    const std::vector<FieldBlock> base{uneven_block(3, 0, 20000)};
    take(server.tell_one({{record}, {}, base, {}, {}, {}}));
    expect_same_sea(store.snapshot()->sea, servers_sea(*record, base));
    WaveTrainBox plain = *record;
    plain.overlays.clear();
    const LatticePoint on_land{300'000, 400'000};
    EXPECT_NE(SeaInstant(servers_sea(plain, base), {1000}).evaluate(on_land).ay,
              SeaInstant(store.snapshot()->sea, {1000}).evaluate(on_land).ay);
}

TEST_F(StoreTest, blocks_that_come_and_go_below_an_overlay_count) {
    const auto record = overlaid_box(1);
    const auto bystander = box(2, 8);
    take(server.tell_one({{record, bystander}, {}, {uneven_block(3, 0, 20000)}, {}, {}, {}}));
    const auto first = store.snapshot();
    take(server.tell_one({{}, {}, {uneven_block(3, 0, 30000), uneven_block(6, 1, 9000)}, {}, {}, {}}));
    const auto second = store.snapshot();
    EXPECT_EQ(second->sea.boxes()[1], first->sea.boxes()[1]);
    const auto alone = [](const StoreSnapshot& s) { return Sea({s.sea.boxes()[0]}); };
    expect_same_sea(alone(*second),
                    servers_sea(*record, {uneven_block(3, 0, 30000), uneven_block(6, 1, 9000)}));
    take(server.tell_one({{}, {}, {uneven_block(5, 1, 7000)}, {{{6}, {1, 0}}}, {}, {}}));
    expect_same_sea(alone(*store.snapshot()),
                    servers_sea(*record, {uneven_block(3, 0, 30000), uneven_block(5, 1, 7000)}));
    take(server.tell_one({{}, {}, {}, {{{3}, {0, 0}}, {{5}, {1, 0}}}, {}, {}}));
    expect_same_sea(alone(*store.snapshot()), servers_sea(*record, {}));
}

TEST_F(StoreTest, a_field_and_its_base_share_one_step) {
    EXPECT_EQ(refused(server.tell_one(
                  {{overlaid_box(1)}, {}, {block(3, 0, 0, 16), block(5, 0, 0, 15)}, {}, {}, {}})),
              ErrorCode::value_out_of_range);
}

TEST_F(StoreTest, more_than_the_stated_limits_is_a_breach) {
    ServerHello tight = server.hello();
    tight.limits.boxes = 1;
    store.begin(tight);
    EXPECT_EQ(refused(server.tell_one({{box(1), box(2)}, {}, {}, {}, {}, {}})), ErrorCode::too_many_boxes);
}

TEST_F(StoreTest, a_new_session_keeps_the_world_and_drops_another) {
    take(server.tell_one({{box(1)}, {}, {}, {}, {}, {}}));
    const auto shown = store.snapshot();
    store.begin(server.hello());
    EXPECT_EQ(store.snapshot()->interest, shown->interest);
    EXPECT_EQ(store.snapshot()->result, 0U);
    Teller fresh;
    EXPECT_TRUE(take(fresh.tell_one({{box(7)}, {}, {}, {}, {}, {}})));
    EXPECT_EQ(store.snapshot()->interest->boxes.size(), 1U);
    store.begin(server.hello(2));
    EXPECT_TRUE(store.snapshot()->interest->boxes.empty());
    EXPECT_TRUE(store.snapshot()->sea.boxes().empty());
}

TEST_F(StoreTest, a_session_cut_in_mid_result_leaves_nothing_behind) {
    const auto pieces = server.tell({{{box(1)}, {}, {}, {}, {}, {}}, {{box(2)}, {}, {}, {}, {}, {}}});
    take(pieces[0]);
    store.begin(server.hello());
    Teller fresh;
    EXPECT_TRUE(take(fresh.tell_one({{box(3)}, {}, {}, {}, {}, {}})));
    EXPECT_EQ(hash_of(*store.snapshot()->interest), hash_of(fresh.told));
    ASSERT_EQ(store.snapshot()->sea.boxes().size(), 1U);
}

TEST_F(StoreTest, confirmed_as_far_as_the_log_is_known) {
    server.key.log_position = {4};
    take(server.tell_one({{box(1)}, {}, {}, {}, {}, {}}));
    store.confirm({5000}, {4});
    EXPECT_EQ(store.snapshot()->watermark.us, 5000);
    store.confirm({9000}, {5});
    EXPECT_EQ(store.snapshot()->watermark.us, 5000) << "event 5 is not in what we hold";
    store.confirm({4000}, {4});
    EXPECT_EQ(store.snapshot()->watermark.us, 5000) << "it only rises";
    server.key.log_position = {5};
    Delta d = server.tell_one({});
    d.watermark = {8000};
    take(d);
    EXPECT_EQ(store.snapshot()->watermark.us, 8000);
}

TEST_F(StoreTest, events_before_the_watermark_are_counted) {
    server.key.log_position = {1};
    Delta first = server.tell_one({{box(1)}, {}, {}, {}, {}, {}});
    first.watermark = {500'000'000};
    take(first);
    EXPECT_EQ(store.counters().late_events, 0U);
    server.key.log_position = {2};
    WaveTrainBox in_time = *box(2);
    in_time.begin = {600'000'000};
    take(server.tell_one({{std::make_shared<const WaveTrainBox>(in_time)}, {}, {}, {}, {}, {}}));
    EXPECT_EQ(store.counters().late_events, 0U);
    server.key.log_position = {3};
    WaveTrainBox ended = *box(1);
    ended.end = {400'000'000};
    WaveTrainBox late = *box(3);
    late.begin = {499'999'999};
    take(server.tell_one(
        {{std::make_shared<const WaveTrainBox>(ended), std::make_shared<const WaveTrainBox>(late)},
         {},
         {},
         {},
         {},
         {}}));
    EXPECT_EQ(store.counters().late_events, 2U);
}

TEST_F(StoreTest, a_steered_box_is_late_from_its_new_leg_on) {
    WaveTrainBox storm = *box(1);
    storm.length = storm.width = 1 << 20;
    storm.course = {{{0}, 900'000'000, {0, 0}, 17180, 0}};
    const auto told = [](const WaveTrainBox& b) { return std::make_shared<const WaveTrainBox>(b); };
    server.key.log_position = {1};
    Delta first = server.tell_one({{told(storm)}, {}, {}, {}, {}, {}});
    first.watermark = {500'000'000};
    take(first);
    storm.course.push_back({{600'000'000}, 900'000'000, {614'400, 0}, 0, 17180});
    server.key.log_position = {2};
    take(server.tell_one({{told(storm)}, {}, {}, {}, {}, {}}));
    EXPECT_EQ(store.counters().late_events, 0U);
    storm.course.back().from = {499'999'999};
    server.key.log_position = {3};
    take(server.tell_one({{told(storm)}, {}, {}, {}, {}, {}}));
    EXPECT_EQ(store.counters().late_events, 1U);
}

/// The state's hash does not tell of it.
TEST_F(StoreTest, a_hull_that_changes_is_taken) {
    WaveTrainBox ship = *box(1);
    ship.length = ship.width = 1 << 20;
    const auto told = [](const WaveTrainBox& b) { return std::make_shared<const WaveTrainBox>(b); };
    take(server.tell_one({{told(ship)}, {}, {}, {}, {}, {}}));
    ship.hull = {80.0F, 12.0F};
    take(server.tell_one({{told(ship)}, {}, {}, {}, {}, {}}));
    EXPECT_EQ(store.snapshot()->interest->boxes.at({1})->hull, ship.hull);
    EXPECT_EQ(store.counters().resyncs, 0U);
}

TEST_F(StoreTest, tiles_have_to_belong_to_the_terrain) {
    EXPECT_FALSE(store.apply(TerrainTiles{{TerrainTile{}}}));
    TerrainGrid grid;
    grid.origin_x = -(1 << 20);
    grid.origin_z = 1 << 18;
    grid.spacing_log2 = 15;
    grid.columns = 200;
    grid.rows = 70;
    grid.heights.assign(200 * 70, 100);
    ServerHello hello = server.hello(3);
    hello.terrain = {grid.origin_x, grid.origin_z, 15, 200, 70, grid.height_step_log2, grid.open_sea_depth};
    store.begin(hello);
    TerrainTiles all;
    for (uint32_t level = 0; level < tile_levels(grid); ++level)
        for (const TerrainTileKey& key : tiles_at_level(grid, level))
            all.tiles.push_back(make_tile(grid, key));
    ASSERT_TRUE(store.apply(all));
    EXPECT_EQ(store.snapshot()->tiles->size(), all.tiles.size());
    EXPECT_EQ(store.snapshot()->tiles->begin()->first.level, tile_levels(grid) - 1) << "coarse before fine";
    TerrainTile beside = make_tile(grid, {0, 4, 0});
    EXPECT_FALSE(store.apply(TerrainTiles{{beside}}));
    TerrainTile moved = make_tile(grid, {0, 1, 1});
    moved.origin_x += 1 << 15;
    EXPECT_FALSE(store.apply(TerrainTiles{{moved}}));
    const auto shown = store.snapshot();
    EXPECT_EQ(shown->tiles->size(), all.tiles.size());
}

TEST(ClientStore, nothing_before_the_hello) {
    ClientStore store;
    EXPECT_FALSE(store.apply(Delta{}));
    EXPECT_FALSE(store.apply(TerrainTiles{}));
}

}  // namespace
}  // namespace trochoid
