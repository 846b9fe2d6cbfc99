#include <fmt/format.h>

#include <limits>

#include "tests/conformance/client/refusals.hpp"

// the fields of our hello, of clock replies, answers and goodbyes.
namespace trochoid::conformance::client {

namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();
constexpr int64_t stamp_bound = int64_t{1} << 56;

const std::string control = "line\nfeed";
const std::string not_utf8 = "\xc3\x28";

/// A row: what is wrong with a value, and the answer that is due.
template <class Value>
struct Row {
    const char* name;
    const char* title;
    Due due;
    void (*spoil)(Value& value);
};

template <class Value>
const Value& legal() {
    for (const LegalMessage& it : legal_messages())
        if (const auto* found = std::get_if<Value>(&it.message)) return *found;
    throw Failed{"the kit has no such message"};
}

std::string id_of(const char* stem, const char* name, Due due) {
    return fmt::format("R-{}/{}-{}", due.requirement, stem, name);
}

/// After both hellos.
template <class Value>
void add(Catalogue& all, const char* stem, std::initializer_list<Row<Value>> rows) {
    for (const Row<Value>& row : rows) {
        Value value = legal<Value>();
        row.spoil(value);
        all.push_back(refused(id_of(stem, row.name, row.due), fmt::format("{}: {}", stem, row.title),
                              encode(ServerMessage{value}), row.due));
    }
}

void add_hello_rows(Catalogue& all, std::initializer_list<Row<ServerHello>> rows) {
    for (const Row<ServerHello>& row : rows)
        all.push_back(hello_refused(
            id_of("ServerHello", row.name, row.due), fmt::format("Our hello: {}", row.title),
            [spoil = row.spoil](ServerHello hello) {
                spoil(hello);
                return encode(ServerMessage{hello});
            },
            row.due));
}

void add_hellos(Catalogue& all) {
    using H = ServerHello;
    add_hello_rows(
        all,
        {{"software-257", "257 bytes of software", out_of_range, [](H& h) { h.software.assign(257, 's'); }},
         {"software-control", "a line feed in the software's name", out_of_range,
          [](H& h) { h.software = control; }},
         {"world-not-utf8", "a world's name that is not UTF-8", out_of_range,
          [](H& h) { h.world = not_utf8; }},
         {"role-3", "a role that nobody knows", out_of_range, [](H& h) { h.role = static_cast<Role>(3); }},
         {"epoch-0", "epoch 0", out_of_range, [](H& h) { h.clock.epoch = 0; }},
         {"rate-high", "a rate above 16", out_of_range,
          [](H& h) { h.clock.rate_q16 = largest_rate_q16 + 1; }},
         {"clock-start", "the clock starts beyond all sea time", out_of_range,
          [](H& h) { h.clock.start = {sea_time_bound + 1}; }},
         {"monotonic-start", "a monotonic stamp beyond its bounds", out_of_range,
          [](H& h) { h.clock.monotonic_start_us = stamp_bound + 1; }},
         {"server-now", "our stamp is beyond its bounds", out_of_range,
          [](H& h) { h.server_now_us = -stamp_bound - 1; }},
         {"frame-low", "a limit of 1,023 bytes a frame", out_of_range,
          [](H& h) { h.limits.frame_to_client = 1023; }},
         {"frame-high", "a limit of more than 16 MiB a frame", out_of_range,
          [](H& h) { h.limits.frame_after_login = (1U << 24) + 1; }},
         {"challenge-count", "65,537 points of a challenge", out_of_range,
          [](H& h) { h.challenge_count = 65537; }},
         {"projection-long", "4,097 bytes of projection", out_of_range,
          [](H& h) { h.projection.assign(4097, '+'); }},
         {"ticket-513", "a ticket of 513 bytes", out_of_range, [](H& h) { h.ticket.assign(513, 7); }},
         {"last-code-99", "a last code of no class", out_of_range,
          [](H& h) { h.last_code = static_cast<ErrorCode>(99); }},
         {"lon-nan", "a longitude that is not a number", infinite_or_nan, [](H& h) { h.origin_lon = nan; }},
         {"lat-infinite", "an infinite latitude", infinite_or_nan, [](H& h) { h.origin_lat = infinite; }}});
    all.push_back(hello_refused(
        "R-117/ServerHello-instance-15", "Our hello: an instance of 15 bytes",
        [](const ServerHello& hello) {
            return bent<wire_fb::ServerHello>(ServerMessage{hello}, [](wire_fb::ServerHello& body) {
                auto* length = const_cast<uint8_t*>(body.instance()->Data()) - sizeof(uint32_t);
                flatbuffers::WriteScalar<uint32_t>(length, 15);
            });
        },
        out_of_range));
    all.push_back(hello_taken("R-117/ServerHello-extremes",
                              "Our hello with each text and list at its longest", [](H& h) {
                                  h.software.assign(256, 's');
                                  h.world.assign(256, 'w');
                                  h.projection.assign(4096, '+');
                                  h.ticket.assign(512, 7);
                                  h.ticket_life_ms = UINT32_MAX;
                                  h.session = UINT64_MAX;
                                  h.log_position = {UINT64_MAX};
                                  h.origin_lon = -180.0;
                                  h.origin_lat = 90.0;
                              }));
    all.push_back(hello_taken("R-157/ServerHello-capabilities",
                              "Our hello has capability bits that nobody knows yet",
                              [](H& h) { h.capabilities = ~(capability_probes | capability_resume); }));
    all.push_back(hello_taken("R-175/ServerHello-last-code-599",
                              "Our hello's last code is unknown, of a known class",
                              [](H& h) { h.last_code = static_cast<ErrorCode>(599); }));
}

void add_clock_replies(Catalogue& all) {
    using C = ClockReply;
    add<C>(all, "ClockReply",
           {{"epoch-0", "epoch 0", out_of_range, [](C& c) { c.clock.epoch = 0; }},
            {"rate-high", "a rate above 16", out_of_range,
             [](C& c) { c.clock.rate_q16 = largest_rate_q16 + 1; }},
            {"start", "the clock starts before all sea time", out_of_range,
             [](C& c) { c.clock.start = {-sea_time_bound - 1}; }},
            {"client-sent", "a stamp beyond its bounds", out_of_range,
             [](C& c) { c.client_sent_us = INT64_MAX; }},
            {"server-sent", "a stamp beyond its bounds", out_of_range,
             [](C& c) { c.server_sent_us = stamp_bound + 1; }},
            {"watermark", "a watermark beyond all sea time", out_of_range,
             [](C& c) { c.watermark = {INT64_MAX}; }},
            {"verdict-3", "a verdict that nobody knows", out_of_range,
             [](C& c) { c.verdict = static_cast<trochoid::Verdict>(3); }}});
}

void add_answers(Catalogue& all) {
    using R = CommandReply;
    add<R>(
        all, "CommandReply",
        {{"code-99", "a code of no class", out_of_range, [](R& r) { r.code = static_cast<ErrorCode>(99); }},
         {"code-800", "a code of no class", out_of_range, [](R& r) { r.code = static_cast<ErrorCode>(800); }},
         {"effective", "an effective time beyond all sea time", out_of_range,
          [](R& r) { r.effective = {INT64_MIN}; }}});
    using L = BoxList;
    add<L>(
        all, "BoxList",
        {{"now", "a sea time beyond its bounds", out_of_range, [](L& l) { l.now = {INT64_MAX}; }},
         {"name-257", "257 bytes of a name", out_of_range, [](L& l) { l.boxes[0].name.assign(257, 'n'); }},
         {"kind-4", "a kind that nobody knows", out_of_range,
          [](L& l) { l.boxes[0].kind = static_cast<BoxKind>(4); }},
         {"place", "a place beyond the world", out_of_range, [](L& l) { l.boxes[0].at.x = world_bound + 1; }},
         {"decay", "a negative decay", out_of_range, [](L& l) { l.boxes[0].decay_us = -1; }},
         {"beam", "a beam longer than the hull", out_of_range, [](L& l) { l.boxes[0].hull.beam = 200.0F; }},
         {"height-nan", "a height that is not a number", infinite_or_nan,
          [](L& l) { l.boxes[0].significant_height = nan; }},
         {"speed-infinite", "an infinite speed", infinite_or_nan, [](L& l) { l.boxes[1].vx = infinite; }}});
    using S = SampleReply;
    add<S>(all, "SampleReply",
           {{"time", "a sea time beyond its bounds", out_of_range, [](S& s) { s.time = {INT64_MAX}; }},
            {"samples-241", "241 samples", out_of_range, [](S& s) { s.samples.resize(241); }},
            {"nan", "a sample that is not a number", infinite_or_nan, [](S& s) { s.samples[1].vz = nan; }},
            {"infinite", "an infinite sample", infinite_or_nan, [](S& s) { s.samples[0].ay = -infinite; }}});
    using Y = RaysReply;
    add<Y>(all, "RaysReply",
           {{"start", "a ray that starts beyond the world", out_of_range,
             [](Y& y) { y.rays[0].start.z = world_bound + 1; }},
            {"point", "an action point beyond the world", out_of_range,
             [](Y& y) { y.rays[0].points[0].at.x = INT64_MIN; }},
            {"kind-0", "an action point of kind 0", out_of_range,
             [](Y& y) { y.rays[0].points[1].kind = static_cast<ActionKind>(0); }},
            {"kind-5", "an action point of kind 5", out_of_range,
             [](Y& y) { y.rays[0].points[1].kind = static_cast<ActionKind>(5); }}});
    using P = ProbeReply;
    add<P>(all, "ProbeReply",
           {{"time", "a sea time beyond its bounds", out_of_range, [](P& p) { p.time = {INT64_MAX}; }},
            {"points-17", "17 points", out_of_range, [](P& p) { p.points.resize(17); }}});
    // Either reading is right: it is no such reply as R-162 allows, and no answer to a probe that was sent.
    all.push_back(client_case("R-117/ProbeReply-stale-with-points", "A stale reply with points",
                              [](ClientTrial& trial) {
                                  P reply = legal<P>();
                                  reply.stale = true;
                                  ClientPeer& peer = trial.welcome();
                                  need_version(peer, first_with_probes);
                                  peer.send(reply);
                                  peer.expect_goodbye(out_of_range, {unexpected});
                              }));
    add<Goodbye>(all, "Goodbye",
                 {{"code-99", "a code of no class", out_of_range,
                   [](Goodbye& g) { g.code = static_cast<ErrorCode>(99); }},
                  {"code-65535", "a code of no class", out_of_range,
                   [](Goodbye& g) { g.code = static_cast<ErrorCode>(65535); }}});
}

/// Our encoder makes control characters blanks and cuts what is too long: here the text is spoiled in the buffer.
void add_texts(Catalogue& all) {
    const auto spoilt = [](char byte) {
        return bent<wire_fb::Goodbye>(ServerMessage{legal<Goodbye>()}, [&](wire_fb::Goodbye& body) {
            const_cast<uint8_t*>(body.message()->Data())[2] = static_cast<uint8_t>(byte);
        });
    };
    all.push_back(refused("R-117/Goodbye-message-control", "A line feed in a goodbye's message", spoilt('\n'),
                          out_of_range));
    all.push_back(refused("R-117/Goodbye-message-not-utf8", "A goodbye's message that is not UTF-8",
                          spoilt('\xff'), out_of_range));
    all.push_back(refused("R-117/RaysReply-counts", "More points than the rays account for",
                          bent<wire_fb::RaysReply>(ServerMessage{legal<RaysReply>()},
                                                   [](wire_fb::RaysReply& body) {
                                                       auto* ray =
                                                           const_cast<wire_fb::Ray*>(body.rays()->Get(0));
                                                       ray->mutate_point_count(1);
                                                   }),
                          out_of_range));
}

}  // namespace

void add_field_cases(Catalogue& all) {
    add_hellos(all);
    add_clock_replies(all);
    add_answers(all);
    add_texts(all);
}

}  // namespace trochoid::conformance::client
