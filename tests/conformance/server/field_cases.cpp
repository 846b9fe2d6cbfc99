#include <fmt/format.h>

#include "protocol/model/wave_train_box.hpp"
#include "tests/conformance/hostile.hpp"
#include "tests/conformance/server/field_rows.hpp"

// the fields of hellos, views, regions, clocks, samples and goodbyes.
namespace trochoid::conformance::server {

namespace {

namespace fb = wire_fb;
using std::string;

const std::vector<int64_t> beyond_world{world_bound + 1, -world_bound - 1, INT64_MAX, INT64_MIN};
const std::vector<int64_t> edges_of_world{world_bound, -world_bound};

void add_views(Catalogue& all) {
    using V = ViewState;
    Rows view(all, "view", view_of_sky(), [](const V& v) { return encode(ClientMessage{ViewUpdate{1, v}}); });
    for (const FloatRow<V>& row :
         std::vector<FloatRow<V>>{{"qx", &V::qx, no_bound, no_bound, no_bound, no_bound},
                                  {"qy", &V::qy, no_bound, no_bound, no_bound, no_bound},
                                  {"qz", &V::qz, no_bound, no_bound, no_bound, no_bound},
                                  {"qw", &V::qw, no_bound, no_bound, no_bound, no_bound},
                                  {"tan_half_width", &V::tan_half_width, 0.0099F, 0.01F, 20.0F, 20.01F},
                                  {"tan_half_height", &V::tan_half_height, 0.0099F, 0.01F, 20.0F, 20.01F},
                                  {"vx", &V::vx, -10001.0F, -10000.0F, 10000.0F, 10001.0F},
                                  {"vy", &V::vy, -10001.0F, -10000.0F, 10000.0F, 10001.0F},
                                  {"vz", &V::vz, -10001.0F, -10000.0F, 10000.0F, 10001.0F},
                                  {"accepted_error_px", &V::accepted_error_px, 0.099F, 0.1F, 100.0F, 100.1F}})
        view.add(row);
    view.add(NumberRow<V, uint32_t>{"patch_budget", &V::patch_budget, {0, 1025, UINT32_MAX}, {1, 1024}});
    view.add(NumberRow<V, uint16_t>{"viewport_width", &V::viewport_width, {0, 16385, 65535}, {1, 16384}});
    view.add(NumberRow<V, uint16_t>{"viewport_height", &V::viewport_height, {0, 16385, 65535}, {1, 16384}});
    view.add(NumberRow<V, int32_t>{"altitude", &V::altitude, {}, {INT32_MIN, INT32_MAX}});
    for (const int64_t at : beyond_world) {
        view.wrong(117, fmt::format("x-{}", at), "A camera beyond the world's east or west", out_of_range,
                   [&](V& v) { v.position.x = at; });
        view.wrong(117, fmt::format("z-{}", at), "A camera beyond the world's north or south", out_of_range,
                   [&](V& v) { v.position.z = at; });
    }
    for (const int64_t at : edges_of_world)
        view.right(117, fmt::format("corner-{}", at), "A camera at the world's corner", [&](V& v) {
            v.position = {at, at};
        });

    const auto turned = [](float w) { return [w](V& v) { v.qx = v.qy = v.qz = 0.0F, v.qw = w; }; };
    view.wrong(118, "longer", "A quaternion of length 1.002", not_unit, turned(1.002F));
    view.wrong(118, "shorter", "A quaternion of length 0.998", not_unit, turned(0.998F));
    view.wrong(118, "zero", "A quaternion of zeros", not_unit, turned(0.0F));
    view.wrong(118, "huge", "A quaternion whose square overflows", not_unit,
               turned(std::numeric_limits<float>::max()));
    view.wrong(118, "four-ones", "A quaternion of ones", not_unit,
               [](V& v) { v.qx = v.qy = v.qz = v.qw = 1.0F; });
    view.right(118, "nearly-longer", "A quaternion of length 1.0009", turned(1.0009F));
    view.right(118, "nearly-shorter", "A quaternion of length 0.9991", turned(0.9991F));
    view.right(118, "negative", "A quaternion with a negative part", turned(-1.0F));
    all.push_back(refused(
        "R-115/view-view", "A view update without a view",
        built(fb::ClientBody::ViewUpdate, [](Builder& b) { return fb::CreateViewUpdate(b, 1).Union(); }),
        absent));
}

void add_regions(Catalogue& all) {
    const SyncRegion disc{{1, 2}, 3};
    Rows regions(all, "regions", SyncRegion{}, [](const SyncRegion& r) {
        return encode(ClientMessage{SyncRegions{1, {r}}});
    });
    for (const int64_t at : beyond_world) {
        regions.wrong(117, fmt::format("x-{}", at), "A region beyond the world's east or west", out_of_range,
                      [&](SyncRegion& r) { r.centre.x = at; });
        regions.wrong(117, fmt::format("z-{}", at), "A region beyond the world's north or south",
                      out_of_range, [&](SyncRegion& r) { r.centre.z = at; });
    }
    constexpr Answer too_large{ErrorCode::region_too_large, requirement::region_radius};
    constexpr uint32_t most = Limits{}.sync_radius;
    regions.wrong(132, "radius-over", "A region with a radius a unit above 2 km", too_large,
                  [](SyncRegion& r) { r.radius = most + 1; });
    regions.wrong(132, "radius-max", "A region with a radius of 2³² - 1", too_large,
                  [](SyncRegion& r) { r.radius = UINT32_MAX; });
    regions.right(132, "radius-most", "A region with a radius of 2 km",
                  [](SyncRegion& r) { r.radius = most; });
    regions.right(132, "radius-0", "A region with a radius of 0", [](SyncRegion& r) { r.radius = 0; });

    constexpr Answer too_many{ErrorCode::too_many_regions, requirement::region_count};
    const auto many = [&](size_t count) {
        return encode(ClientMessage{SyncRegions{1, std::vector<SyncRegion>(count, disc)}});
    };
    all.push_back(refused("R-131/regions-33", "33 regions", many(33), too_many));
    all.push_back(refused("R-131/regions-1000", "1,000 regions", many(1000), too_many));
    all.push_back(taken("R-131/regions-32", "32 regions", many(32)));
    all.push_back(taken("R-131/regions-0", "No regions", many(0)));
    ClientHello hello = ServerPeer::usual_hello();
    hello.regions.assign(33, disc);
    all.push_back(
        refused_first("R-131/hello-33", "A hello with 33 regions", encode(ClientMessage{hello}), too_many));
    hello.regions.assign(1, {{0, 0}, most + 1});
    all.push_back(refused_first("R-132/hello-radius-over", "A hello with a region of more than 2 km",
                                encode(ClientMessage{hello}), too_large));
    all.push_back(refused(
        "R-115/regions-regions", "A message of regions without the list",
        built(fb::ClientBody::SyncRegions, [](Builder& b) { return fb::CreateSyncRegions(b, 1).Union(); }),
        absent));
}

void add_clock_and_ack(Catalogue& all) {
    Rows clock(all, "clock", ClockRequest{1, 0},
               [](const ClockRequest& r) { return encode(ClientMessage{r}); });
    constexpr int64_t bound = int64_t{1} << 56;
    clock.add(NumberRow<ClockRequest, int64_t>{
        "client_sent_us", &ClockRequest::client_sent_us, {bound + 1, -bound - 1, INT64_MIN, INT64_MAX}, {}});
    all.push_back(refused(
        "R-117/ack-answer-without-flag", "A known answer without the flag that says that there is one",
        built(fb::ClientBody::Ack, [](Builder& b) { return fb::CreateAck(b, 1, 0, 0, false, 77).Union(); }),
        out_of_range));
}

void add_samples(Catalogue& all) {
    const auto request = [](SeaTime time, std::vector<LatticePoint> points) {
        return encode(ClientMessage{SampleRequest{1, time, std::move(points)}});
    };
    for (const int64_t at : {sea_time_bound + 1, -sea_time_bound - 1, INT64_MAX, INT64_MIN})
        all.push_back(refused(fmt::format("R-117/sample-time-{}", at),
                              "Samples at a sea time beyond its bounds", request({at}, {{0, 0}}),
                              out_of_range));
    for (const int64_t at : beyond_world) {
        all.push_back(refused(fmt::format("R-117/sample-x-{}", at),
                              "A sample beyond the world's east or west", request({}, {{0, 0}, {at, 0}}),
                              out_of_range));
        all.push_back(refused(fmt::format("R-117/sample-z-{}", at),
                              "A sample beyond the world's north or south", request({}, {{0, 0}, {0, at}}),
                              out_of_range));
    }
    all.push_back(refused("R-117/sample-241-points", "241 sample points",
                          request({}, std::vector<LatticePoint>(241)), out_of_range));
    all.push_back(refused("R-117/sample-4000-points", "4,000 sample points",
                          request({}, std::vector<LatticePoint>(4000)), out_of_range));
    all.push_back(taken("R-117/sample-no-points", "No sample points", request({}, {})));
    all.push_back(taken("R-117/sample-time-bounds", "Samples at the last sea time there is",
                        request({sea_time_bound}, {{0, 0}})));
    all.push_back(refused("R-115/sample-points", "A sample request without its list",
                          built(fb::ClientBody::SampleRequest,
                                [](Builder& b) { return fb::CreateSampleRequest(b, 1).Union(); }),
                          absent));
}

/// A hello whose parts are there or not.
struct HelloParts {
    bool software = true, world = true, token = true, view = true, regions = true;
};
Bytes hello_of(const HelloParts& parts) {
    return built(fb::ClientBody::ClientHello, [&](Builder& b) {
        const auto text = b.CreateString("x");
        const auto none = b.CreateString("");
        const auto regions = b.CreateVectorOfStructs(std::vector<fb::Region>());
        const fb::View view(0, 0, 0, 0.0F, 0.0F, 0.0F, 1.0F, 1.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 1, 16, 16);
        const ClientHello usual = ServerPeer::usual_hello();
        fb::ClientHelloBuilder hello(b);
        hello.add_protocol_min(usual.protocol_min);
        hello.add_protocol_max(usual.protocol_max);
        hello.add_model(usual.model);
        if (parts.software) hello.add_software(text);
        if (parts.world) hello.add_world(none);
        if (parts.token) hello.add_token(none);
        if (parts.view) hello.add_view(&view);
        if (parts.regions) hello.add_regions(regions);
        return hello.Finish().Union();
    });
}

void add_hellos(Catalogue& all) {
    all.push_back(taken_first("R-115/hello-whole",
                              "A hello with nothing but what it must have, as of version 2", hello_of({})));
    all.push_back(refused_first("R-115/hello-software", "A hello without the software's name",
                                hello_of({.software = false}), absent));
    all.push_back(refused_first("R-115/hello-world", "A hello without the world's name",
                                hello_of({.world = false}), absent));
    all.push_back(refused_first("R-115/hello-token", "A hello without a token, not even an empty one",
                                hello_of({.token = false}), absent));
    all.push_back(
        refused_first("R-115/hello-view", "A hello without a view", hello_of({.view = false}), absent));
    all.push_back(refused_first("R-115/hello-regions", "A hello without a list of regions",
                                hello_of({.regions = false}), absent));
    const auto hello = [&](const char* id, const char* title, Answer answer, auto change) {
        ClientHello changed = ServerPeer::usual_hello();
        change(changed);
        all.push_back(refused_first(id, title, encode(ClientMessage{changed}), answer));
    };
    using H = ClientHello;
    constexpr int64_t bound = int64_t{1} << 56;
    hello("R-117/hello-stamp-high", "A hello with a clock stamp beyond 2⁵⁶", out_of_range,
          [&](H& h) { h.clock_stamp_us = bound + 1; });
    hello("R-117/hello-stamp-low", "A hello with a clock stamp below -2⁵⁶", out_of_range,
          [&](H& h) { h.clock_stamp_us = -bound - 1; });
    hello("R-117/hello-versions-crossed", "A hello whose lowest version is above its highest", out_of_range,
          [](H& h) { h.protocol_min = 9, h.protocol_max = 8; });
    hello("R-117/hello-view-x", "A hello with a camera outside the world", out_of_range,
          [](H& h) { h.view.position.x = world_bound + 1; });
    hello("R-117/hello-view-budget", "A hello with a patch budget of 0", out_of_range,
          [](H& h) { h.view.patch_budget = 0; });
    hello("R-117/hello-region-x", "A hello with a region outside the world", out_of_range, [](H& h) {
        h.regions = {{{world_bound + 1, 0}, 1}};
    });
    hello("R-116/hello-view-nan", "A hello with a camera that is not a number", infinite_or_nan,
          [](H& h) { h.view.vx = no_bound; });
    hello("R-118/hello-view", "A hello with a quaternion of zeros", not_unit,
          [](H& h) { h.view.qx = h.view.qw = 0.0F; });
    hello("R-117/hello-token-1025", "A token of 1,025 bytes", out_of_range,
          [](H& h) { h.token = string(1025, 't'); });
    hello("R-117/hello-software-257", "A software's name of 257 bytes", out_of_range,
          [](H& h) { h.software = string(257, 's'); });
    hello("R-117/hello-world-257", "A world's name of 257 bytes", out_of_range,
          [](H& h) { h.world = string(257, 'w'); });
    hello("R-117/hello-ticket-513", "A ticket of 513 bytes", out_of_range,
          [](H& h) { h.ticket.assign(513, 1); });
    ClientHello longest = ServerPeer::usual_hello();
    longest.software = string(256, 's');
    all.push_back(taken_first("R-117/hello-software-256", "A software's name of 256 bytes",
                              encode(ClientMessage{longest})));
    longest.software = "Тρ⊕χ⌒ 🌊";
    all.push_back(taken_first("R-117/hello-software-utf8", "A software's name in several scripts",
                              encode(ClientMessage{longest})));
}

void add_texts(Catalogue& all) {
    for (const BadText& bad : bad_texts()) {
        const auto hello = [&](const char* field, string ClientHello::*text) {
            ClientHello changed = ServerPeer::usual_hello();
            changed.*text = bad.bytes;
            all.push_back(refused_first(fmt::format("R-117/hello-{}-{}", field, bad.name),
                                        fmt::format("{}: {}", field, bad.title),
                                        encode(ClientMessage{changed}), out_of_range));
        };
        hello("software", &ClientHello::software);
        hello("world", &ClientHello::world);
        hello("token", &ClientHello::token);
        StartShip ship;
        ship.name = bad.bytes;
        all.push_back(refused(fmt::format("R-117/ship-name-{}", bad.name),
                              fmt::format("a ship's name: {}", bad.title),
                              encode(ClientMessage{Command{1, {}, false, ship}}), out_of_range));
    }
    StartShip ship;
    ship.name = string(65, 'n');
    all.push_back(refused("R-117/ship-name-65", "A ship's name of 65 bytes",
                          encode(ClientMessage{Command{1, {}, false, ship}}), out_of_range));
    ship.name = string(64, 'n');
    all.push_back(taken("R-117/ship-name-64", "A ship's name of 64 bytes",
                        encode(ClientMessage{Command{1, {}, false, ship}})));
}

void add_goodbyes(Catalogue& all) {
    all.push_back(refused(
        "R-115/goodbye-message", "A goodbye without a sentence, not even an empty one",
        built(fb::ClientBody::Goodbye, [](Builder& b) { return fb::CreateGoodbye(b).Union(); }), absent));
    const auto goodbye = [](const string& sentence) {
        return built(fb::ClientBody::Goodbye, [&](Builder& b) {
            const auto text = b.CreateString(sentence);
            return fb::CreateGoodbye(b, fb::Code::none, text).Union();
        });
    };
    all.push_back(
        refused("R-117/goodbye-513", "A goodbye of 513 bytes", goodbye(string(513, 'g')), out_of_range));
    all.push_back(refused("R-117/goodbye-control", "A goodbye with control characters",
                          goodbye("clear\x1b[2J"), out_of_range));
    all.push_back(refused("R-117/goodbye-class", "A goodbye with a code of no class",
                          built(fb::ClientBody::Goodbye,
                                [](Builder& b) {
                                    const auto text = b.CreateString("leaving");
                                    return fb::CreateGoodbye(b, static_cast<fb::Code>(999), text).Union();
                                }),
                          out_of_range));
}

}  // namespace

const std::vector<BadText>& bad_texts() {
    static const std::vector<BadText> texts{
        {"escape", "an escape sequence for terminals", "clear\x1b[2J"},
        {"newline", "two lines", "two\nlines"},
        {"nul", "a zero within", string("nul\0within", 10)},
        {"delete", "the character 7f", "\x7f"},
        {"c1", "a control character of Latin-1", "C1 \xc2\x9b"},
        {"cut", "a character cut off", "cut \xe6\xb5"},
        {"lone", "a continuation byte alone", "\x80"},
        {"overlong", "a slash in too long a form", "long \xc0\xaf"},
        {"surrogate", "half of a surrogate pair", "\xed\xa0\x80"},
        {"beyond", "a character beyond 10ffff", "\xf4\x90\x80\x80"},
        {"latin1", "Latin-1 instead of UTF-8", "M\xfcnchen"},
    };
    return texts;
}

void add_field_cases(Catalogue& all) {
    add_views(all);
    add_regions(all);
    add_clock_and_ack(all);
    add_samples(all);
    add_hellos(all);
    add_texts(all);
    add_goodbyes(all);
    add_command_field_cases(all);
}

}  // namespace trochoid::conformance::server
