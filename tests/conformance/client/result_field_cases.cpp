#include <fmt/format.h>

#include <limits>

#include "tests/conformance/client/refusals.hpp"
#include "tests/conformance/kit_sea.hpp"

// the fields of results and terrain tiles.
namespace trochoid::conformance::client {

namespace {

namespace fb = wire_fb;
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

struct Row {
    const char* name;
    const char* title;
    Due due;
    void (*spoil)(fb::Delta& delta);
};

fb::Box& laden(fb::Delta& d) { return *d.mutable_boxes()->GetMutableObject(d.boxes()->size() - 1); }
fb::BoxHead& head(fb::Delta& d) { return *laden(d).mutable_head(); }
template <class T>
T& first(const flatbuffers::Vector<const T*>* list) {
    return const_cast<T&>(*list->Get(0));
}
fb::Train& train(fb::Delta& d) { return first(laden(d).trains()); }
fb::Patch& patch(fb::Delta& d) { return first(d.patches()); }
fb::BlockHead& block(fb::Delta& d) { return first(d.blocks()); }
fb::View& anchor(fb::Delta& d) { return *d.mutable_key()->mutable_anchor(); }

void add_rows(Catalogue& all, std::initializer_list<Row> rows) {
    for (const Row& row : rows)
        all.push_back(refused(fmt::format("R-{}/Delta-{}", row.due.requirement, row.name),
                              fmt::format("A result: {}", row.title),
                              bent<fb::Delta>(ServerMessage{legal_delta()}, row.spoil), row.due));
}

void add_heads(Catalogue& all) {
    using D = fb::Delta;
    add_rows(
        all,
        {{"box-id-0", "a box with id 0", out_of_range, [](D& d) { head(d).mutate_id(0); }},
         {"box-order", "boxes not by ascending id", out_of_range, [](D& d) { head(d).mutate_id(1); }},
         {"box-x", "a box's corner beyond the world", out_of_range,
          [](D& d) { head(d).mutate_x(world_bound + 1); }},
         {"box-u", "a direction of travel that has not length 1", out_of_range,
          [](D& d) { head(d).mutate_ux(1 << 29); }},
         {"box-length", "a box of 2³⁰ + 1", out_of_range,
          [](D& d) { head(d).mutate_length((int64_t{1} << 30) + 1); }},
         {"box-width", "a negative width", out_of_range, [](D& d) { head(d).mutate_width(-1); }},
         {"box-ramp-rear", "a ramp of 1023", out_of_range, [](D& d) { head(d).mutate_ramp_rear(1023); }},
         {"box-ramp-side", "a ramp of 0", out_of_range, [](D& d) { head(d).mutate_ramp_side(0); }},
         {"box-begin", "a beginning before all sea time", out_of_range,
          [](D& d) { head(d).mutate_begin_us(-sea_time_bound - 1); }},
         {"box-build-up", "a negative build-up", out_of_range, [](D& d) { head(d).mutate_build_up_us(-1); }},
         {"box-decay", "a decay of 2³⁹ + 1 µs", out_of_range,
          [](D& d) { head(d).mutate_decay_us((int64_t{1} << 39) + 1); }},
         {"box-roundness", "a roundness above 1", out_of_range,
          [](D& d) { head(d).mutate_roundness(32769); }},
         {"raised", "raised by a negative time", out_of_range,
          [](D& d) { laden(d).mutable_succession()->mutate_raised_us(-1); }},
         {"fade", "a fade of 2³⁹ + 1 µs", out_of_range,
          [](D& d) { laden(d).mutable_succession()->mutate_fade_us((int64_t{1} << 39) + 1); }}});
}

void add_trains(Catalogue& all) {
    using D = fb::Delta;
    add_rows(all, {{"amplitude-nan", "an amplitude that is not a number", infinite_or_nan,
                    [](D& d) { train(d).mutate_amplitude(nan); }},
                   {"amplitude-infinite", "an infinite amplitude", infinite_or_nan,
                    [](D& d) { train(d).mutate_amplitude(infinite); }},
                   {"amplitude-negative", "a negative amplitude", out_of_range,
                    [](D& d) { train(d).mutate_amplitude(-0.5F); }},
                   {"amplitude-high", "an amplitude above 32 m", out_of_range,
                    [](D& d) { train(d).mutate_amplitude(32.01F); }},
                   {"amplitude-low", "an amplitude below 2⁻²⁰ m", out_of_range,
                    [](D& d) { train(d).mutate_amplitude(1e-7F); }},
                   {"choppiness-nan", "a choppiness that is not a number", infinite_or_nan,
                    [](D& d) { train(d).mutate_choppiness(nan); }},
                   {"choppiness-high", "a choppiness above 4", out_of_range,
                    [](D& d) { train(d).mutate_choppiness(4.01F); }},
                   {"wave-vector-0", "a wave vector that is 0", out_of_range,
                    [](D& d) { train(d).mutate_kx(0), train(d).mutate_kz(0); }},
                   {"wave-vector-min", "a wave vector of −2³¹", out_of_range,
                    [](D& d) { train(d).mutate_kx(INT32_MIN); }},
                   {"overlay-field", "an overlay whose base is not below it", out_of_range,
                    [](D& d) { first(laden(d).overlays()).mutate_base(7); }},
                   {"overlay-base-0", "an overlay on field 0", out_of_range,
                    [](D& d) { first(laden(d).overlays()).mutate_base(0); }}});
}

void add_features(Catalogue& all) {
    using D = fb::Delta;
    add_rows(all, {{"leg-elsewhere", "a course that begins elsewhere than its box", out_of_range,
                    [](D& d) { first(laden(d).course()).mutate_x(0); }},
                   {"leg-duration", "a leg of a negative duration", out_of_range,
                    [](D& d) { first(laden(d).course()).mutate_duration_us(-1); }},
                   {"leg-speed", "a leg of 2²¹", out_of_range,
                    [](D& d) { first(laden(d).course()).mutate_vx(1 << 21); }},
                   {"irregular-share", "a share above 1", out_of_range,
                    [](D& d) { laden(d).mutable_irregular()->mutate_share(32769); }},
                   {"irregular-vector", "a share without a wave vector", out_of_range,
                    [](D& d) {
                        laden(d).mutable_irregular()->mutate_vkx(0),
                            laden(d).mutable_irregular()->mutate_vkz(0);
                    }},
                   {"noise-nan", "noise that is not a number", infinite_or_nan,
                    [](D& d) { laden(d).mutable_noise()->mutate_amplitude(nan); }},
                   {"noise-octaves-0", "noise of no octaves", out_of_range,
                    [](D& d) { laden(d).mutable_noise()->mutate_octaves(0); }},
                   {"noise-octaves-13", "noise of 13 octaves", out_of_range,
                    [](D& d) { laden(d).mutable_noise()->mutate_octaves(13); }},
                   {"noise-step", "noise with a step of 2²¹", out_of_range,
                    [](D& d) { laden(d).mutable_noise()->mutate_step_log2(21); }},
                   {"noise-period", "noise with a period of 2¹³ µs", out_of_range,
                    [](D& d) { laden(d).mutable_noise()->mutate_period_log2(13); }},
                   {"wake-nan", "a wake that is not a number", infinite_or_nan,
                    [](D& d) { laden(d).mutable_wake()->mutate_transverse(nan); }},
                   {"wake-infinite", "an infinite wake", infinite_or_nan,
                    [](D& d) { laden(d).mutable_wake()->mutate_diverging(infinite); }},
                   {"wake-high", "a wake above 32 m", out_of_range,
                    [](D& d) { laden(d).mutable_wake()->mutate_transverse(33.0F); }},
                   {"wake-speed-0", "a wake without a speed", out_of_range,
                    [](D& d) { laden(d).mutable_wake()->mutate_group_speed(0); }},
                   {"wake-length", "a wake of waves below 2²⁰", out_of_range,
                    [](D& d) { laden(d).mutable_wake()->mutate_inverse_length(1000); }},
                   {"hull-nan", "a hull that is not a number", infinite_or_nan,
                    [](D& d) { laden(d).mutable_hull()->mutate_length(nan); }},
                   {"hull-long", "a hull of more than 500 m", out_of_range,
                    [](D& d) { laden(d).mutable_hull()->mutate_length(501.0F); }},
                   {"hull-beam", "a beam of 0", out_of_range,
                    [](D& d) { laden(d).mutable_hull()->mutate_beam(0.0F); }}});
}

void add_lists(Catalogue& all) {
    using D = fb::Delta;
    add_rows(
        all,
        {{"patch-level", "a patch of level 14", out_of_range, [](D& d) { patch(d).mutate_level(14); }},
         {"patch-x", "a patch beyond the world", out_of_range, [](D& d) { patch(d).mutate_x(1 << 19); }},
         {"patch-left-out-nan", "a bound that is not a number", infinite_or_nan,
          [](D& d) { patch(d).mutate_left_out(nan); }},
         {"patch-left-out-negative", "a negative bound", out_of_range,
          [](D& d) { patch(d).mutate_left_out(-1.0F); }},
         {"patch-height-error-infinite", "an infinite bound", infinite_or_nan,
          [](D& d) { patch(d).mutate_height_error(infinite); }},
         {"patch-count-high", "a patch claims more boxes than there are", out_of_range,
          [](D& d) { patch(d).mutate_box_count(9999); }},
         {"patch-count-low", "entries of boxes that belong to no patch", out_of_range,
          [](D& d) { patch(d).mutate_box_count(0); }},
         {"patch-index", "an entry points outside of the ids", out_of_range,
          [](D& d) { first(d.patch_boxes()).mutate_box_index(99); }},
         {"patch-trains", "257 trains of a box", out_of_range,
          [](D& d) { first(d.patch_boxes()).mutate_train_count(257); }},
         {"block-field-0", "a land block of field 0", out_of_range, [](D& d) { block(d).mutate_field(0); }},
         {"block-step", "a land block with a step of 2²¹", out_of_range,
          [](D& d) { block(d).mutate_step_log2(21); }},
         {"block-x", "a land block beyond the world", out_of_range,
          [](D& d) { block(d).mutate_x((1 << 15) + 1); }},
         {"block-bytes", "a land block claims bytes that are not there", out_of_range,
          [](D& d) { block(d).mutate_node_bytes(65535); }},
         {"block-nodes", "nodes that the plane coding does not know", out_of_range,
          [](D& d) { std::fill_n(const_cast<uint8_t*>(d.nodes()->Data()), 16, uint8_t{0xff}); }}});
}

void add_keys(Catalogue& all) {
    using D = fb::Delta;
    add_rows(all, {{"anchor-x", "an anchor beyond the world", out_of_range,
                    [](D& d) { anchor(d).mutate_x(world_bound + 1); }},
                   {"anchor-nan", "an anchor's lens that is not a number", infinite_or_nan,
                    [](D& d) { anchor(d).mutate_tan_half_width(nan); }},
                   {"anchor-turned", "an anchor whose quaternion has length 2", not_unit,
                    [](D& d) { anchor(d).mutate_qw(2.0F); }},
                   {"key-slack", "a slack that is not a number", infinite_or_nan,
                    [](D& d) { d.mutable_key()->mutate_slack_tangent(nan); }},
                   {"key-until", "a span beyond all sea time", out_of_range,
                    [](D& d) { d.mutable_key()->mutate_until_us(INT64_MAX); }},
                   {"key-patches", "1,025 patches", out_of_range,
                    [](D& d) { d.mutable_key()->mutate_patch_limit(1025); }}});
    // R-132 is about what a client asks for; that a key repeats it is not said.
    all.push_back(client_case(
        "R-132/Delta-region", "A result: a region of more than 2 km in the key: it may be refused",
        [](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome();
            peer.send_payload(bent<D>(ServerMessage{legal_delta()}, [](D& d) {
                first(d.mutable_key()->regions()).mutate_radius(UINT32_MAX);
            }));
            peer.hold(1, laden_sea());
            peer.expect_goodbye_or_service({{ErrorCode::region_too_large, any_due_requirement},
                                            {ErrorCode::value_out_of_range, any_due_requirement}});
        }));
    const auto value = [&](const char* name, const char* title, void (*spoil)(Delta&), Due due) {
        Delta delta = legal_delta();
        spoil(delta);
        all.push_back(refused(fmt::format("R-{}/Delta-{}", due.requirement, name), title,
                              encode(ServerMessage{delta}), due));
    };
    value(
        "result-0", "A result: number 0", [](Delta& d) { d.result = 0; }, out_of_range);
    value(
        "base-after", "A result: its base is itself", [](Delta& d) { d.base = 1; }, out_of_range);
    value(
        "span-backwards", "A result: its span ends before it begins",
        [](Delta& d) {
            d.key.from = kit_sea_begin;
            d.key.until = {0};
        },
        out_of_range);
    value(
        "watermark", "A result: a watermark beyond all sea time", [](Delta& d) { d.watermark = {INT64_MAX}; },
        out_of_range);
    // The code is the limit's; of requirements both say it.
    Delta crowded = legal_delta();
    crowded.key.regions.resize(33);
    all.push_back(refused("R-131/Delta-regions-33", "A result: 33 regions in the key",
                          encode(ServerMessage{crowded}),
                          {ErrorCode::too_many_regions, any_due_requirement}));
}

/// The bounds themselves are right.
void add_right(Catalogue& all) {
    all.push_back(client_case("R-117/Delta-laden", "A box with everything that a record may have",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = trial.welcome();
                                  peer.send_result(laden_sea(), true);
                                  peer.await_ack(1);
                              }));
    const auto box = [&](const char* name, const char* title, void (*change)(WaveTrainBox&)) {
        all.push_back(client_case(std::string("R-117/Delta-") + name, title, [change](ClientTrial& trial) {
            InterestState state = laden_sea();
            WaveTrainBox changed = *state.boxes.at({5});
            change(changed);
            state.boxes[{5}] = std::make_shared<const WaveTrainBox>(changed);
            ClientPeer& peer = trial.welcome();
            peer.send_result(state, true, 15 * 1024);
            peer.await_ack(1);
        }));
    };
    box("most-trains", "A box of 256 trains", [](WaveTrainBox& b) { b.trains.resize(256, b.trains[0]); });
    box("amplitude-most", "An amplitude of 32 m and a choppiness of 4",
        [](WaveTrainBox& b) { b.trains[0].amplitude = 32.0F, b.trains[0].choppiness = 4.0F; });
    box("amplitude-least", "Amplitudes of 0 and 2⁻²⁰ m", [](WaveTrainBox& b) {
        b.trains.push_back(b.trains[0]);
        b.trains[0].amplitude = 0.0F;
        b.trains[1].amplitude = 0x1p-20F;
    });
    box("end-of-time", "A box that ends at the end of time",
        [](WaveTrainBox& b) { b.end = end_of_time, b.decay_us = int64_t{1} << 39; });
    box("only-noise", "A box without trains, but with noise", [](WaveTrainBox& b) {
        b.trains.clear();
        b.overlays.clear();
        b.wake = {};
    });
}

}  // namespace

void add_result_field_cases(Catalogue& all) {
    add_heads(all);
    add_trains(all);
    add_features(all);
    add_lists(all);
    add_keys(all);
    add_right(all);
}

}  // namespace trochoid::conformance::client
