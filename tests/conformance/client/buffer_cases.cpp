#include <fmt/format.h>

#include <cstring>

#include "tests/conformance/client/refusals.hpp"
#include "tests/conformance/hostile.hpp"

// buffers as such, before any field is looked at.
namespace trochoid::conformance::client {

namespace {

namespace fb = wire_fb;
constexpr Due unverified{ErrorCode::verification_failed, requirement::verified_buffer};
constexpr Due no_identifier{ErrorCode::unknown_message, requirement::file_identifier};
constexpr Due too_short{ErrorCode::verification_failed, requirement::file_identifier};
constexpr Due unknown{ErrorCode::unknown_message, requirement::known_union_tag};
constexpr Due trailing{ErrorCode::trailing_bytes, requirement::size_field};

const ServerMessage& legal(std::string_view name) {
    for (const LegalMessage& it : legal_messages())
        if (it.name == name) return it.message;
    throw Failed{"the kit has no such message"};
}

Bytes with_word(Bytes bytes, size_t at, uint32_t word) {
    std::memcpy(bytes.data() + at, &word, sizeof word);
    return bytes;
}

Bytes built_by_server(fb::ServerBody tag, const std::function<TableOffset(Builder&)>& body) {
    Builder b;
    b.ForceDefaults(true);
    const TableOffset table = body(b);
    fb::FinishServerEnvelopeBuffer(b, fb::CreateServerEnvelope(b, 0, tag, table));
    fb::GetMutableServerEnvelope(b.GetBufferPointer())->mutate_size(b.GetSize());
    return {b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()};
}

void add_identifiers(Catalogue& all) {
    for (const size_t size : {size_t{1}, size_t{7}})
        all.push_back(refused(fmt::format("R-111/size-{}", size), fmt::format("A payload of {} bytes", size),
                              Bytes(size), too_short));
    all.push_back(refused_first("R-111/first-size-4", "A first payload of 4 bytes", Bytes(4), too_short));
    const Bytes good = encode(legal("ClockReply"));
    for (const char* name : {"TRCC", "TRLE", "trcs"}) {
        Bytes other = good;
        std::memcpy(other.data() + 4, name, 4);
        all.push_back(refused(fmt::format("R-111/identifier-{}", name),
                              fmt::format("A clock reply with the file identifier {}", name), other,
                              no_identifier));
    }
    all.push_back(refused("R-111/clients-message",
                          "A whole message of a client, which may only come from one",
                          encode(ClientMessage{ClockRequest{1, 2}}), no_identifier));
    all.push_back(
        refused_first("R-111/first-zeros", "A first payload of 64 zeros", Bytes(64), no_identifier));
}

void add_structures(Catalogue& all) {
    const Bytes good = encode(legal("ClockReply"));
    const auto is = [&](const char* id, const char* title, Bytes bytes) {
        all.push_back(refused(std::string("R-112/") + id, title, std::move(bytes), unverified));
    };
    is("root-outside", "The root lies beyond the buffer", with_word(good, 0, 0xffff));
    is("root-far-outside", "The root lies 4 GiB beyond the buffer", with_word(good, 0, 0xfffffff0));
    is("root-odd", "The root lies at an odd place", with_word(good, 0, 25));
    uint32_t root = 0;
    std::memcpy(&root, good.data(), sizeof root);
    is("vtable-outside", "The vtable lies beyond the buffer", with_word(good, root, 0x80000000));
    for (const size_t keep : {size_t{8}, size_t{24}, size_t{48}, good.size() - 8})
        is(fmt::format("cut-at-{}", keep).c_str(), "A clock reply that is cut short",
           Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(keep)));
    // The vector's length lies before its first element.
    const auto with_length = [](uint32_t length) {
        const Bytes bytes = encode(legal("SampleReply"));
        const auto* samples = fb::GetServerEnvelope(bytes.data())->body_as_SampleReply()->samples();
        return with_word(bytes, static_cast<size_t>(reinterpret_cast<const uint8_t*>(samples) - bytes.data()),
                         length);
    };
    is("vector-too-long", "A list claims more entries than the buffer has", with_length(1000));
    is("vector-endless", "A list claims 2³² - 1 entries", with_length(UINT32_MAX));
    is("vector-wraps", "A list claims entries whose bytes wrap to few", with_length(0x04444445));
    Bytes text = encode(legal("CommandReply"));
    const auto* message = fb::GetServerEnvelope(text.data())->body_as_CommandReply()->message();
    text[static_cast<size_t>(reinterpret_cast<const uint8_t*>(message->Data()) - text.data()) +
         message->size()] = 'x';
    is("string-without-end", "A string is not ended by a zero", text);
    is("too-many-tables", "A list of 2,100 boxes: more tables than a message may have",
       built_by_server(fb::ServerBody::BoxList, [](Builder& b) {
           const auto name = b.CreateString("");
           std::vector<flatbuffers::Offset<fb::BoxSummary>> lines;
           fb::BoxSummaryBuilder line(b);
           line.add_name(name);
           lines.assign(2100, line.Finish());
           return fb::CreateBoxList(b, 1, 0, b.CreateVector(lines), true).Union();
       }));
}

void add_sizes(Catalogue& all) {
    const Bytes good = encode(legal("ClockReply"));
    for (const size_t more : {size_t{1}, size_t{8}, size_t{4096}}) {
        Bytes longer = good;
        longer.resize(good.size() + more);
        all.push_back(refused(fmt::format("R-113/trailing-{}", more),
                              fmt::format("{} bytes trail a clock reply", more), longer, trailing));
    }
    const auto sized = [&](uint32_t size) {
        Bytes other = good;
        fb::GetMutableServerEnvelope(other.data())->mutate_size(size);
        return other;
    };
    all.push_back(refused("R-113/size-0", "The size field is 0", sized(0), trailing));
    all.push_back(refused("R-113/size-less", "The size field says 8 bytes less",
                          sized(static_cast<uint32_t>(good.size()) - 8), trailing));
    all.push_back(refused("R-113/size-max", "The size field says 2³² - 1", sized(UINT32_MAX), trailing));
    all.push_back(hello_refused(
        "R-113/hello-trailing-8", "8 bytes trail our hello",
        [](const ServerHello& hello) {
            Bytes bytes = encode(ServerMessage{hello});
            bytes.resize(bytes.size() + 8);
            return bytes;
        },
        trailing));
}

void add_tags(Catalogue& all) {
    const auto empty_clock = [](Builder& b) { return fb::ClockReplyBuilder(b).Finish().Union(); };
    for (const int tag : {0, static_cast<int>(fb::ServerBody::MAX) + 1, 64, 255}) {
        const Bytes bytes = built_by_server(static_cast<fb::ServerBody>(tag), empty_clock);
        all.push_back(refused(fmt::format("R-114/body-{}", tag), fmt::format("The body's tag is {}", tag),
                              bytes, unknown));
    }
    all.push_back(refused_first("R-114/first-body-200", "The first body's tag is 200",
                                built_by_server(static_cast<fb::ServerBody>(200), empty_clock), unknown));
    for (int tag = 1; tag <= static_cast<int>(fb::ServerBody::MAX); ++tag) {
        const auto body = static_cast<fb::ServerBody>(tag);
        all.push_back(
            refused(fmt::format("R-115/body-{}", fb::EnumNameServerBody(body)),
                    fmt::format("The tag says {}, but there is no body", fb::EnumNameServerBody(body)),
                    built_by_server(body, [](Builder&) { return TableOffset(0); }), absent));
    }
}

/// A field taken from a message, which is sent after the hellos.
template <class Table, class Of>
void without(Catalogue& all, const char* message, const char* field, uint16_t place, Of of) {
    const Bytes bytes = bent<Table>(legal(message), [&](Table& body) { drop_field(of(body), place); });
    all.push_back(refused(fmt::format("R-115/{}-{}", message, field),
                          fmt::format("A {} without its {}", message, field), bytes, absent));
}

void add_missing_fields(Catalogue& all) {
    const auto itself = [](auto& body) -> auto& { return body; };
    without<fb::ClockReply>(all, "ClockReply", "clock", fb::ClockReply::VT_CLOCK, itself);
    without<fb::CommandReply>(all, "CommandReply", "message", fb::CommandReply::VT_MESSAGE, itself);
    without<fb::BoxList>(all, "BoxList", "boxes", fb::BoxList::VT_BOXES, itself);
    without<fb::BoxList>(
        all, "BoxList", "name", fb::BoxSummary::VT_NAME,
        [](fb::BoxList & l) -> auto& { return *l.mutable_boxes()->GetMutableObject(0); });
    without<fb::SampleReply>(all, "SampleReply", "samples", fb::SampleReply::VT_SAMPLES, itself);
    without<fb::RaysReply>(all, "RaysReply", "rays", fb::RaysReply::VT_RAYS, itself);
    without<fb::RaysReply>(all, "RaysReply", "points", fb::RaysReply::VT_POINTS, itself);
    without<fb::Goodbye>(all, "Goodbye", "message", fb::Goodbye::VT_MESSAGE, itself);
    without<fb::ProbeReply>(all, "ProbeReply", "samples", fb::ProbeReply::VT_SAMPLES, itself);
    without<fb::ProbeReply>(all, "ProbeReply", "part_counts", fb::ProbeReply::VT_PART_COUNTS, itself);
    without<fb::ProbeReply>(all, "ProbeReply", "parts", fb::ProbeReply::VT_PARTS, itself);
    without<fb::ProbeReply>(all, "ProbeReply", "sums", fb::ProbeReply::VT_SUMS, itself);
    without<fb::TerrainTiles>(all, "TerrainTiles", "tiles", fb::TerrainTiles::VT_TILES, itself);
    without<fb::TerrainTiles>(
        all, "TerrainTiles", "heights", fb::TerrainTile::VT_HEIGHTS,
        [](fb::TerrainTiles & t) -> auto& { return *t.mutable_tiles()->GetMutableObject(0); });
    without<fb::Delta>(all, "Delta", "key", fb::Delta::VT_KEY, itself);
    const auto key = [](fb::Delta & d) -> auto& { return *d.mutable_key(); };
    without<fb::Delta>(all, "Delta", "anchor", fb::CullKey::VT_ANCHOR, key);
    without<fb::Delta>(all, "Delta", "regions", fb::CullKey::VT_REGIONS, key);
    // Boxes of one layout share a vtable; the last one is laden and has its own.
    const auto box = [](fb::Delta & d) -> auto& {
        return *d.mutable_boxes()->GetMutableObject(d.boxes()->size() - 1);
    };
    without<fb::Delta>(all, "Delta", "head", fb::Box::VT_HEAD, box);
    without<fb::Delta>(all, "Delta", "trains", fb::Box::VT_TRAINS, box);
    without<fb::Delta>(all, "Delta", "fields", fb::Box::VT_FIELDS, box);
    without<fb::Delta>(all, "Delta", "field_of_train", fb::Box::VT_FIELD_OF_TRAIN, box);
}

void add_missing_of_hello(Catalogue& all) {
    const auto add = [&](const char* field, uint16_t place) {
        all.push_back(hello_refused(
            fmt::format("R-115/ServerHello-{}", field), fmt::format("Our hello has no {}", field),
            [place](const ServerHello& hello) {
                return bent<fb::ServerHello>(ServerMessage{hello},
                                             [&](fb::ServerHello& body) { drop_field(body, place); });
            },
            absent));
    };
    add("software", fb::ServerHello::VT_SOFTWARE);
    add("world", fb::ServerHello::VT_WORLD);
    add("instance", fb::ServerHello::VT_INSTANCE);
    add("clock", fb::ServerHello::VT_CLOCK);
    add("limits", fb::ServerHello::VT_LIMITS);
    add("projection", fb::ServerHello::VT_PROJECTION);
    add("terrain", fb::ServerHello::VT_TERRAIN);
}

}  // namespace

void add_buffer_cases(Catalogue& all) {
    add_identifiers(all);
    add_structures(all);
    add_sizes(all);
    add_tags(all);
    add_missing_fields(all);
    add_missing_of_hello(all);
}

}  // namespace trochoid::conformance::client
