#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <limits>
#include <thread>

#include "client_generated.h"
#include "protocol/wire/requirements.hpp"
#include "tests/conformance/mutants/client_mutants.hpp"

namespace trochoid::conformance::mutants {

namespace {

namespace fb = wire_fb;

/// Not what the client's own numbers reach in a test.
constexpr uint32_t far_ahead = 1'000'000;

// ---- the stream ----

/// Says other first 8 bytes.
class Opening final : public Spoiler {
public:
    explicit Opening(Bytes first) : first_(std::move(first)) {}
    void opening(std::span<const uint8_t>, Link& link) override { link.bytes_to_server(first_); }

private:
    const Bytes first_;
};

Bytes header(uint32_t length, uint32_t word) {
    Bytes bytes(frame_header_bytes);
    std::memcpy(bytes.data(), &length, sizeof length);
    std::memcpy(bytes.data() + sizeof length, &word, sizeof word);
    return bytes;
}

MakeSpoiler says_bytes(const Bytes& bytes) {
    return once_settled([bytes](const Talk&, Link& link) { link.bytes_to_server(bytes); });
}
MakeSpoiler says_payload(const Bytes& payload) {
    return once_settled([payload](const Talk&, Link& link) { link.to_server(payload); });
}

void add_stream(std::vector<Mutant>& all) {
    const auto add = [&](const char* name, uint16_t number, const char* what, MakeSpoiler make) {
        all.push_back({name, number, Side::client, what, std::move(make)});
    };
    add("client-no-magic", requirement::magic, "A client that begins with its hello",
        [] { return std::make_unique<Opening>(Bytes{}); });
    add("client-other-magic", requirement::magic, "A client that begins with the name of another protocol",
        [] {
            return std::make_unique<Opening>(Bytes{'T', 'R', 'O', 'C', 'H', 'O', 'I', 'E'});
        });
    add("client-header-word", requirement::frame_header, "A client with a header whose second word is 1",
        says_bytes(header(64, 1)));
    add("client-long-frame", requirement::frame_length, "A client with a frame beyond its limit",
        says_bytes(header(Limits{}.frame_after_login + 1, 0)));
}

// ---- buffers ----

Bytes a_request() { return encode(ClientMessage{ClockRequest{far_ahead, 1}}); }

Bytes with_tag(Bytes bytes, uint8_t tag) {
    auto* envelope = flatbuffers::GetMutableRoot<flatbuffers::Table>(bytes.data());
    envelope->SetField<uint8_t>(fb::ClientEnvelope::VT_BODY_TYPE, tag, 0);
    return bytes;
}

/// Regions without the list of them.
Bytes without_regions() {
    Bytes bytes = encode(ClientMessage{SyncRegions{far_ahead, {}}});
    const auto* table =
        reinterpret_cast<const uint8_t*>(fb::GetClientEnvelope(bytes.data())->body_as_SyncRegions());
    auto* vtable = const_cast<uint8_t*>(table) - flatbuffers::ReadScalar<flatbuffers::soffset_t>(table);
    flatbuffers::WriteScalar<flatbuffers::voffset_t>(vtable + fb::SyncRegions::VT_REGIONS, 0);
    return bytes;
}

void add_buffers(std::vector<Mutant>& all) {
    const auto add = [&](const char* name, uint16_t number, const char* what, const Bytes& payload) {
        all.push_back({name, number, Side::client, what, says_payload(payload)});
    };
    Bytes cut = a_request();
    cut.resize(cut.size() - 8);
    Bytes trailing = a_request();
    trailing.resize(trailing.size() + 8);
    add("client-servers-message", requirement::file_identifier, "A client that sends a server's message",
        encode(ServerMessage{ClockReply{}}));
    add("client-cut-buffer", requirement::verified_buffer, "A client with a message that is cut short", cut);
    add("client-trailing", requirement::size_field, "A client with bytes behind a message", trailing);
    add("client-unknown-tag", requirement::known_union_tag, "A client with a message of a kind that is none",
        with_tag(a_request(), 200));
    add("client-missing-field", requirement::fields_present, "A client with regions that lack their list",
        without_regions());
}

// ---- views and regions ----

MakeSpoiler says_view(void (*spoil)(ViewState& view)) {
    return once_settled([spoil](const Talk& talk, Link& link) {
        ViewUpdate update{far_ahead, talk.client_hello->view};
        spoil(update.view);
        link.say_to_server(update);
    });
}

void add_views(std::vector<Mutant>& all) {
    const auto add = [&](const char* name, uint16_t number, const char* what, MakeSpoiler make) {
        all.push_back({name, number, Side::client, what, std::move(make)});
    };
    add("client-infinite-view", requirement::finite_numbers, "A client whose view is not a number",
        says_view([](ViewState& v) { v.tan_half_width = std::numeric_limits<float>::quiet_NaN(); }));
    add("client-no-patches", requirement::ranges, "A client with a budget of no patches",
        says_view([](ViewState& v) { v.patch_budget = 0; }));
    add("client-turned-view", requirement::unit_quaternion, "A client whose view is turned by no unit",
        says_view([](ViewState& v) { v.qw = 2.0F; }));
    add("client-view-flood", requirement::message_rates, "A client with 40 views at once",
        once_settled([](const Talk& talk, Link& link) {
            for (uint32_t i = 0; i < 40; ++i)
                link.say_to_server(ViewUpdate{far_ahead + i, talk.client_hello->view});
        }));
    add("client-flood", requirement::message_rates, "A client with 1,200 messages at once",
        once_settled([](const Talk&, Link& link) {
            for (uint32_t i = 0; i < 1200; ++i) link.say_to_server(ClockRequest{far_ahead + i, 1});
        }));
    add("client-many-regions", requirement::region_count, "A client with 33 sync regions",
        says_payload(encode(ClientMessage{SyncRegions{far_ahead, std::vector<SyncRegion>(33)}})));
    add("client-wide-region", requirement::region_radius, "A client with a sync region of 3 km",
        says_payload(encode(ClientMessage{SyncRegions{far_ahead, {{{0, 0}, 3072U * 1024U}}}})));
}

// ---- turns ----

/// A field of each hello is another.
MakeSpoiler with_hello(void (*change)(ClientHello& hello)) {
    return spoils_client<ClientHello>([change] {
        return [change](ClientHello& hello, const Talk&, Link&) {
            change(hello);
            return Fate::changed;
        };
    });
}

/// The hello names model 0; between client and server it is translated, so that all the rest goes well.
class WithoutModel final : public MessageSpoiler {
    Fate client_says(ClientMessage& message, Link&) override {
        auto* hello = std::get_if<ClientHello>(&message);
        if (hello == nullptr) return Fate::kept;
        its_ = hello->model;
        hello->model = 0;
        return Fate::changed;
    }
    Fate server_says(ServerMessage& message, Link&) override {
        auto* hello = std::get_if<ServerHello>(&message);
        if (hello == nullptr || hello->model != 0) return Fate::kept;
        hello->model = its_;
        return Fate::changed;
    }

    uint16_t its_ = 0;
};

/// The client itself would not wait so long for an answer: it gets one from us.
Fate keep_waiting(ClientHello& hello, const Talk&, Link& link) {
    ServerHello answer;
    answer.protocol = hello.protocol_max;
    answer.model = hello.model;
    answer.client_stamp_us = hello.clock_stamp_us;
    link.say_to_client(answer);
    std::this_thread::sleep_for(std::chrono::seconds(6));
    return Fate::kept;
}

void add_hellos(std::vector<Mutant>& all) {
    const auto add = [&](const char* name, uint16_t number, const char* what, MakeSpoiler make) {
        all.push_back({name, number, Side::client, what, std::move(make)});
    };
    add("client-speaks-first", requirement::hello_first, "A client with a request before its hello",
        spoils_client<ClientHello>([] {
            return [](ClientHello&, const Talk&, Link& link) {
                link.say_to_server(ClockRequest{1, 1});
                return Fate::kept;
            };
        }));
    add("client-speaks-on", requirement::hello_first, "A client that does not wait for the server's hello",
        spoils_client<ClientHello>([] {
            return [](ClientHello& hello, const Talk&, Link& link) {
                link.say_to_server(hello);
                link.say_to_server(ViewUpdate{1, hello.view});
                return Fate::dropped;
            };
        }));
    add("client-two-hellos", requirement::hello_first, "A client whose hello comes twice",
        once_settled([](const Talk& talk, Link& link) { link.say_to_server(*talk.client_hello); }));
    add("client-last-word", requirement::hello_first, "A client with a request after a goodbye",
        spoils_client<Goodbye>([] {
            return [](Goodbye& goodbye, const Talk&, Link& link) {
                if (goodbye.requirement != requirement::hello_first) return Fate::kept;
                link.say_to_server(goodbye);
                link.say_to_server(ClockRequest{far_ahead, 1});
                return Fate::dropped;
            };
        }));
    add("client-late", requirement::hello_deadline, "A client whose hello comes after 6 s",
        spoils_client<ClientHello>([] { return keep_waiting; }));
    add("client-future-versions", requirement::version_range, "A client that offers versions 4 to 9 alone",
        with_hello([](ClientHello& hello) { hello.protocol_min = 4, hello.protocol_max = 9; }));
    add("client-other-world", requirement::world_name, "A client that asks for another world",
        with_hello([](ClientHello& hello) { hello.world = "elsewhere"; }));
    add("client-no-model", requirement::model_version, "A client that computes no model",
        [] { return std::make_unique<WithoutModel>(); });
    add("client-bad-token", 152, "A client whose token is none",
        with_hello([](ClientHello& hello) { hello.token = "trochoid1.none.at-all"; }));
}

void add_commands(std::vector<Mutant>& all) {
    const auto add = [&](const char* name, uint16_t number, const char* what, const ClientMessage& message) {
        all.push_back({name, number, Side::client, what, says_payload(encode(message))});
    };
    Command rate;
    rate.sequence = far_ahead;
    rate.action = SetRate{};
    add("client-moves-time", requirement::director_role, "A viewer that sets the rate of time", rate);
    Command wind = rate;
    wind.action = StartWind{};
    add("client-starts-wind", requirement::director_role, "A viewer that starts a wind", wind);
    all.push_back({"client-probes-of-old", 175, Side::client, "A client with probes in version 2",
                   once_settled([](const Talk& talk, Link& link) {
                       if (talk.server_hello && talk.server_hello->protocol == 2)
                           link.say_to_server(Probe{far_ahead, 1, {0}, {{0, 0}}});
                   })});
}

}  // namespace

void add_lying_clients(std::vector<Mutant>& all) {
    add_stream(all);
    add_buffers(all);
    add_views(all);
    add_hellos(all);
    add_commands(all);
}

}  // namespace trochoid::conformance::mutants
