#include <fmt/format.h>

#include <cstring>

#include "protocol/wire/requirements.hpp"
#include "tests/conformance/hostile.hpp"
#include "tests/conformance/server/refusals.hpp"

// buffers as such, before any field is looked at.
namespace trochoid::conformance::server {

namespace {

namespace fb = wire_fb;
constexpr Answer unverified{ErrorCode::verification_failed, requirement::verified_buffer};
constexpr Answer unknown{ErrorCode::unknown_message, requirement::known_union_tag};
constexpr Answer trailing{ErrorCode::trailing_bytes, requirement::size_field};
constexpr Answer missing{ErrorCode::missing_field, requirement::fields_present};

ClientMessage usual_view() { return ViewUpdate{1, view_of_sky()}; }

Bytes with_word(Bytes bytes, size_t at, uint32_t word) {
    std::memcpy(bytes.data() + at, &word, sizeof word);
    return bytes;
}

void add_identifiers(Catalogue& all) {
    for (const size_t size : {size_t{1}, size_t{4}, size_t{7}})
        all.push_back(refused(fmt::format("R-111/size-{}", size), fmt::format("A payload of {} bytes", size),
                              Bytes(size), {ErrorCode::verification_failed, requirement::file_identifier}));
    all.push_back(refused_first("R-111/first-size-7", "A first payload of 7 bytes", Bytes(7),
                                {ErrorCode::verification_failed, requirement::file_identifier}));
    constexpr Answer identifier{ErrorCode::unknown_message, requirement::file_identifier};
    const Bytes good = encode(usual_view());
    for (const char* name : {"TRCS", "TRLE", "trcc", "TRCD", "\xff\xff\xff\xff"}) {
        Bytes other = good;
        std::memcpy(other.data() + 4, name, 4);
        const std::string id = name[0] == 'T' || name[0] == 't' ? name : "ones";
        all.push_back(
            refused("R-111/identifier-" + id, "A view with the file identifier " + id, other, identifier));
    }
    all.push_back(refused("R-111/servers-message",
                          "A whole message of a server, which may only come from one",
                          encode(ServerMessage{CommandReply{}}), identifier));
    all.push_back(refused_first("R-111/first-servers-message",
                                "A server's hello in the place of the client's",
                                encode(ServerMessage{ServerHello{}}), identifier));
    all.push_back(refused("R-111/zeros", "A payload of 64 zeros", Bytes(64), identifier));
}

void add_structures(Catalogue& all) {
    const Bytes good = encode(usual_view());
    const auto is = [&](const char* id, const char* title, Bytes bytes) {
        all.push_back(refused(std::string("R-112/") + id, title, std::move(bytes), unverified));
    };
    is("root-outside", "The root lies beyond the buffer", with_word(good, 0, 0xffff));
    is("root-far-outside", "The root lies 4 GiB beyond the buffer", with_word(good, 0, 0xfffffff0));
    is("root-odd", "The root lies at an odd place", with_word(good, 0, 25));
    is("root-0", "The root lies where its own offset is", with_word(good, 0, 0));
    uint32_t root = 0;
    std::memcpy(&root, good.data(), sizeof root);
    is("vtable-outside", "The vtable lies beyond the buffer", with_word(good, root, 0x80000000));
    for (size_t keep = 8; keep < good.size() && keep <= 96; keep += 8)
        all.push_back(refused(fmt::format("R-112/cut-at-{}", keep),
                              fmt::format("A view cut after {} of {} bytes", keep, good.size()),
                              Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(keep)),
                              unverified));
    Bytes only_identifier(8);
    std::memcpy(only_identifier.data() + 4, "TRCC", 4);
    is("only-identifier", "Nothing but the identifier", only_identifier);
    // The vector's length lies before its first element.
    const auto with_length = [](uint32_t length) {
        const Bytes regions = encode(ClientMessage{SyncRegions{1, std::vector<SyncRegion>(2)}});
        Bytes out = regions;
        const auto* body = fb::GetClientEnvelope(out.data())->body_as_SyncRegions();
        const size_t at = static_cast<size_t>(reinterpret_cast<const uint8_t*>(body->regions()) - out.data());
        return with_word(out, at, length);
    };
    is("vector-too-long", "A list claims more entries than the buffer has", with_length(100));
    is("vector-endless", "A list claims 2³² - 1 entries", with_length(UINT32_MAX));
    is("vector-wraps", "A list claims entries whose bytes wrap to few", with_length(0x0aaaaaab));
    Bytes text = encode(ClientMessage{Goodbye{ErrorCode::none, "leaving", false, 0, 0, 0}});
    const auto* message = fb::GetClientEnvelope(text.data())->body_as_Goodbye()->message();
    text[static_cast<size_t>(reinterpret_cast<const uint8_t*>(message->Data()) - text.data()) +
         message->size()] = 'x';
    is("string-without-end", "A string is not ended by a zero", text);
}

/// The 4 bytes that put an 8-byte element off depend on what is written later: one of both lies wrong.
template <class Make>
Bytes misaligned(const Make& make) {
    for (size_t lead = 0; lead < 2; ++lead) {
        Bytes bytes = make(lead);
        const auto& [data, size] = std::pair(bytes.data(), bytes.size());
        flatbuffers::Verifier verifier(data, size);
        if (!fb::VerifyClientEnvelopeBuffer(verifier)) continue;
        const auto* envelope = fb::GetClientEnvelope(data);
        const uint8_t* elements = envelope->body_type() == fb::ClientBody::SyncRegions
                                      ? envelope->body_as_SyncRegions()->regions()->Data()
                                  : envelope->body_type() == fb::ClientBody::SampleRequest
                                      ? envelope->body_as_SampleRequest()->points()->Data()
                                      : envelope->body_as_Command()->action_as_ChangeLand()->line()->Data();
        if ((elements - data) % 8 != 0) return bytes;
    }
    return {};
}

void add_misaligned(Catalogue& all) {
    constexpr size_t region_words = sizeof(fb::Region) / sizeof(uint32_t);
    constexpr size_t point_words = sizeof(fb::Point) / sizeof(uint32_t);
    const auto add = [&](const char* id, const char* title, const Bytes& bytes) {
        if (!bytes.empty())
            all.push_back(refused(std::string("R-112/misaligned-") + id, title, bytes, unverified));
    };
    add("regions", "The elements of the regions lie 4 bytes off", misaligned([&](size_t lead) {
            return built(fb::ClientBody::SyncRegions, [&](Builder& b) {
                const auto at = misaligned_vector(b, 3, region_words, lead);
                fb::SyncRegionsBuilder table(b);
                table.add_sequence(1);
                table.add_regions(flatbuffers::Offset<flatbuffers::Vector<const fb::Region*>>(at));
                return table.Finish().Union();
            });
        }));
    add("points", "The elements of the sample points lie 4 bytes off", misaligned([&](size_t lead) {
            return built(fb::ClientBody::SampleRequest, [&](Builder& b) {
                const auto at = misaligned_vector(b, 3, point_words, lead);
                fb::SampleRequestBuilder table(b);
                table.add_sequence(1);
                table.add_points(flatbuffers::Offset<flatbuffers::Vector<const fb::Point*>>(at));
                return table.Finish().Union();
            });
        }));
    add("line", "The elements of a line of land lie 4 bytes off", misaligned([&](size_t lead) {
            return built_command(fb::Action::ChangeLand, [&](Builder& b) {
                const auto at = misaligned_vector(b, 3, point_words, lead);
                return fb::CreateChangeLand(b, flatbuffers::Offset<flatbuffers::Vector<const fb::Point*>>(at),
                                            20.0F, 3.0F)
                    .Union();
            });
        }));
}

void add_sizes(Catalogue& all) {
    const Bytes good = encode(usual_view());
    for (const size_t more : {size_t{1}, size_t{4}, size_t{8}, size_t{4096}}) {
        Bytes longer = good;
        longer.resize(good.size() + more);
        all.push_back(refused(fmt::format("R-113/trailing-{}", more),
                              fmt::format("{} bytes trail a view", more), longer, trailing));
    }
    const auto sized = [&](uint32_t size) {
        Bytes other = good;
        fb::GetMutableClientEnvelope(other.data())->mutate_size(size);
        return other;
    };
    const auto length = static_cast<uint32_t>(good.size());
    all.push_back(refused("R-113/size-0", "The size field is 0", sized(0), trailing));
    all.push_back(
        refused("R-113/size-less", "The size field says 8 bytes less", sized(length - 8), trailing));
    all.push_back(
        refused("R-113/size-more", "The size field says 8 bytes more", sized(length + 8), trailing));
    all.push_back(refused("R-113/size-max", "The size field says 2³² - 1", sized(UINT32_MAX), trailing));
    Bytes hello = encode(ClientMessage{ServerPeer::usual_hello()});
    hello.resize(hello.size() + 8);
    all.push_back(refused_first("R-113/first-trailing-8", "8 bytes trail the hello", hello, trailing));
    const Bytes without_size = [] {
        Builder b;
        const auto body = fb::CreateClockRequest(b, 1, 2).Union();
        fb::ClientEnvelopeBuilder envelope(b);
        envelope.add_body_type(fb::ClientBody::ClockRequest);
        envelope.add_body(body);
        fb::FinishClientEnvelopeBuffer(b, envelope.Finish());
        return Bytes(b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize());
    }();
    all.push_back(refused("R-113/size-absent", "The envelope has no size field", without_size, trailing));
}

void add_tags(Catalogue& all) {
    const auto clock = [](Builder& b) { return fb::CreateClockRequest(b, 1, 2).Union(); };
    const auto after_last = static_cast<int>(fb::ClientBody::MAX) + 1;
    for (const int tag : {0, after_last, 64, 255}) {
        const Bytes bytes = built(static_cast<fb::ClientBody>(tag), clock);
        all.push_back(refused(fmt::format("R-114/body-{}", tag), fmt::format("The body's tag is {}", tag),
                              bytes, unknown));
        if (tag != 0)
            all.push_back(refused_first(fmt::format("R-114/first-body-{}", tag),
                                        fmt::format("The first body's tag is {}", tag), bytes, unknown));
    }
    const auto action_after_last = static_cast<int>(fb::Action::MAX) + 1;
    for (const int tag : {0, action_after_last, 64, 255})
        all.push_back(refused(fmt::format("R-114/action-{}", tag),
                              fmt::format("A command's action has the tag {}", tag),
                              built_command(static_cast<fb::Action>(tag),
                                            [](Builder& b) { return fb::CreateListBoxes(b).Union(); }),
                              unknown));
}

void add_missing_tables(Catalogue& all) {
    for (int tag = 1; tag <= static_cast<int>(fb::ClientBody::MAX); ++tag) {
        const auto body = static_cast<fb::ClientBody>(tag);
        all.push_back(
            refused(fmt::format("R-115/body-{}", fb::EnumNameClientBody(body)),
                    fmt::format("The tag says {}, but there is no body", fb::EnumNameClientBody(body)),
                    built(body, [](Builder&) { return TableOffset(0); }), missing));
    }
    for (int tag = 1; tag <= static_cast<int>(fb::Action::MAX); ++tag) {
        const auto action = static_cast<fb::Action>(tag);
        all.push_back(
            refused(fmt::format("R-115/action-{}", fb::EnumNameAction(action)),
                    fmt::format("The tag says {}, but there is no action", fb::EnumNameAction(action)),
                    built_command(action, [](Builder&) { return TableOffset(0); }), missing));
    }
}

}  // namespace

void add_buffer_cases(Catalogue& all) {
    add_identifiers(all);
    add_structures(all);
    add_misaligned(all);
    add_sizes(all);
    add_tags(all);
    add_missing_tables(all);
}

}  // namespace trochoid::conformance::server
