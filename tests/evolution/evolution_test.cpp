#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <set>
#include <sstream>

#include "protocol/codec/codec.hpp"
#include "tests/fuzz/wire_walk.hpp"
#include "tests/unit/codec/random_messages.hpp"
#include "v2/client_bfbs_generated.h"
#include "v2/client_generated.h"
#include "v2/event_bfbs_generated.h"
#include "v2/event_generated.h"
#include "v2/server_bfbs_generated.h"
#include "v2/server_generated.h"

// Messages of protocol version 2, by its frozen schema and flatc's code for it, against today's encoder and decoder.
namespace trochoid {
namespace {

const reflection::Schema& schema_of(const uint8_t* binary) { return *reflection::GetSchema(binary); }

/// One of the three root types, as version 2 knew it.
struct OldDirection {
    std::string name;
    const reflection::Schema& schema;
    std::function<bool(const Bytes&)> verifies;
    std::function<Bytes(const Bytes&)>
        through_its_objects;  ///< read and written by flatc's code of version 2
    std::function<Result<Bytes>(const Bytes&)> through_ours;  ///< decoded and encoded by today's codec
    std::function<std::string(const Bytes&)>
        kind;  ///< the body's type; "NONE" where it, or its action, came later
    std::function<Bytes(Dice&, size_t)> today;  ///< a message of today's encoder
    size_t kinds;                               ///< of today
};

template <class Decode>
Result<Bytes> decoded_and_encoded(const Bytes& bytes, Decode decode) {
    auto result = decode(bytes);
    if (!result) return result.error();
    return encode(*result);
}

void set_size(Bytes& bytes) {
    // `size` is field 0 of every envelope.
    const auto at = flatbuffers::ReadScalar<uint32_t>(bytes.data());
    auto* root = reinterpret_cast<flatbuffers::Table*>(bytes.data() + at);
    root->SetField<uint32_t>(4, static_cast<uint32_t>(bytes.size()), 0);
}

template <class Envelope>
Bytes through_objects(const Bytes& bytes, const char* identifier) {
    const std::unique_ptr<typename Envelope::NativeTableType> object(
        flatbuffers::GetRoot<Envelope>(bytes.data())->UnPack());
    flatbuffers::FlatBufferBuilder builder;
    builder.ForceDefaults(true);
    builder.Finish(Envelope::Pack(builder, object.get()), identifier);
    return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

template <class Envelope, class Tag>
std::string kind_of(const Bytes& bytes, Tag last, const char* (*name)(Tag)) {
    const Tag tag = flatbuffers::GetRoot<Envelope>(bytes.data())->body_type();
    return tag > last ? "NONE" : name(tag);
}

std::vector<OldDirection> old_directions() {
    using flatbuffers::Verifier;
    return {{"client", schema_of(wire_v2::ClientEnvelopeBinarySchema::data()),
             [](const Bytes& b) {
                 Verifier verifier(b.data(), b.size());
                 return wire_v2::VerifyClientEnvelopeBuffer(verifier);
             },
             [](const Bytes& b) { return through_objects<wire_v2::ClientEnvelope>(b, "TRCC"); },
             [](const Bytes& b) {
                 return decoded_and_encoded(b, [](const Bytes& c) { return decode_client(c); });
             },
             [](const Bytes& b) -> std::string {
                 const auto* command = wire_v2::GetClientEnvelope(b.data())->body_as_Command();
                 if (command != nullptr && command->action_type() > wire_v2::Action::MAX) return "NONE";
                 return kind_of<wire_v2::ClientEnvelope>(b, wire_v2::ClientBody::MAX,
                                                         wire_v2::EnumNameClientBody);
             },
             [](Dice& dice, size_t kind) { return encode(random_client_message(dice, kind)); }, client_kinds},
            {"server", schema_of(wire_v2::ServerEnvelopeBinarySchema::data()),
             [](const Bytes& b) {
                 Verifier verifier(b.data(), b.size());
                 return wire_v2::VerifyServerEnvelopeBuffer(verifier);
             },
             [](const Bytes& b) { return through_objects<wire_v2::ServerEnvelope>(b, "TRCS"); },
             [](const Bytes& b) {
                 return decoded_and_encoded(b, [](const Bytes& c) { return decode_server(c); });
             },
             [](const Bytes& b) {
                 return kind_of<wire_v2::ServerEnvelope>(b, wire_v2::ServerBody::MAX,
                                                         wire_v2::EnumNameServerBody);
             },
             [](Dice& dice, size_t kind) {
                 ServerMessage message = random_server_message(dice, kind);
                 // As a server writes them in version 2.
                 if (auto* delta = std::get_if<Delta>(&message)) delta->patch_form = PatchForm::lists;
                 return encode(message);
             },
             server_kinds},
            {"event", schema_of(wire_v2::EventEnvelopeBinarySchema::data()),
             [](const Bytes& b) {
                 Verifier verifier(b.data(), b.size());
                 return wire_v2::VerifyEventEnvelopeBuffer(verifier);
             },
             [](const Bytes& b) { return through_objects<wire_v2::EventEnvelope>(b, "TRLE"); },
             [](const Bytes& b) {
                 return decoded_and_encoded(b, [](const Bytes& c) { return decode_event(c); });
             },
             [](const Bytes& b) {
                 return kind_of<wire_v2::EventEnvelope>(b, wire_v2::EventBody::MAX,
                                                        wire_v2::EnumNameEventBody);
             },
             [](Dice& dice, size_t kind) { return encode(random_event(dice, kind)); }, event_kinds}};
}

/// The message as an encoder of the schema's version would have made it: every table's vtable ends with the last field that
/// the version knows. The new vtables stand at the end, before the buffer is filled up to 8 bytes.
Bytes as_written_by(const reflection::Schema& schema, Bytes bytes) {
    std::vector<std::pair<size_t, uint32_t>> tables{
        {flatbuffers::ReadScalar<uint32_t>(bytes.data()), schema.root_table()->fields()->size()}};
    for (const WireSlot& slot : walk(schema, bytes, SIZE_MAX))
        if (slot.kind == WireSlot::Kind::table && slot.count > 0) tables.emplace_back(slot.at, slot.count);
    for (const auto& [at, fields] : tables) {
        const size_t vtable =
            at - static_cast<size_t>(int64_t{flatbuffers::ReadScalar<int32_t>(bytes.data() + at)});
        const auto size = flatbuffers::ReadScalar<uint16_t>(bytes.data() + vtable);
        const auto known = static_cast<uint16_t>(4 + 2 * fields);
        if (size <= known) continue;
        const size_t fresh = bytes.size();
        bytes.resize((fresh + known + 7) / 8 * 8);
        std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(vtable), known,
                    bytes.begin() + static_cast<std::ptrdiff_t>(fresh));
        flatbuffers::WriteScalar<uint16_t>(bytes.data() + fresh, known);
        flatbuffers::WriteScalar<int32_t>(bytes.data() + at,
                                          static_cast<int32_t>(at) - static_cast<int32_t>(fresh));
    }
    set_size(bytes);
    return bytes;
}

/// seen_by without what flatc's objects cannot tell (an empty list from none, an empty text from none) and without the
/// buffer's size, which is the layout's.
std::string values_seen(const reflection::Schema& schema, const Bytes& bytes, bool objects = false) {
    std::istringstream in(seen_by(schema, bytes));
    std::string out;
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("size = ")) continue;
        if (objects && (line.ends_with(" absent") || line.ends_with(" has 0") || line.ends_with(" ''")))
            continue;
        out += line;
        out += '\n';
    }
    return out;
}

/// Decoded by today's codec, encoded again, it still says the same to version 2.
void expect_ours_reads(const OldDirection& old, const Bytes& bytes, const std::string& what) {
    ASSERT_TRUE(old.verifies(bytes)) << what;
    const auto again = old.through_ours(bytes);
    ASSERT_TRUE(again) << what << ": " << again.error().message;
    ASSERT_TRUE(old.verifies(*again)) << what;
    ASSERT_EQ(values_seen(old.schema, *again), values_seen(old.schema, bytes)) << what;
}

TEST(Evolution, FrozenMessagesOfVersion2SayTheSameToday) {
    std::ifstream in(std::string(TROCHOID_SOURCE_DIR) + "/protocol/schema/history/v2/messages.txt");
    size_t read = 0;
    std::string direction;
    std::string name;
    std::string hex;
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with('#')) continue;
        std::istringstream(line) >> direction >> name >> hex;
        Bytes bytes;
        for (size_t i = 0; i + 1 < hex.size(); i += 2)
            bytes.push_back(static_cast<uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
        for (const OldDirection& old : old_directions())
            if (old.name == direction) {
                expect_ours_reads(old, bytes, line.substr(0, line.rfind(' ')));
                ++read;
            }
    }
    EXPECT_EQ(read, 18U);
}

TEST(Evolution, RandomMessagesOfVersion2SayTheSameToday) {
    Dice dice(2201);
    for (const OldDirection& old : old_directions()) {
        std::set<std::string> kinds;
        for (size_t kind = 0; kind < old.kinds; ++kind)
            for (int round = 0; round < 150; ++round) {
                const Bytes today = old.today(dice, kind);
                if (old.kind(today) == "NONE") continue;
                const Bytes bytes = as_written_by(old.schema, today);
                ASSERT_EQ(values_seen(old.schema, bytes), values_seen(old.schema, today));
                expect_ours_reads(old, bytes, old.name + " " + old.kind(bytes));
                kinds.insert(old.kind(bytes));
            }
        const size_t known = old.name == "event" ? 5 : 9;
        EXPECT_EQ(kinds.size(), known) << old.name;
    }
}

TEST(Evolution, TodaysMessagesAreReadByVersion2) {
    Dice dice(2202);
    for (const OldDirection& old : old_directions())
        for (size_t kind = 0; kind < old.kinds; ++kind)
            for (int round = 0; round < 150; ++round) {
                const Bytes bytes = old.today(dice, kind);
                // Its verifier takes tags that it does not know; its programs say unknown_message.
                ASSERT_TRUE(old.verifies(bytes)) << old.name << " " << kind;
                if (old.kind(bytes) == "NONE") continue;
                const Bytes theirs = old.through_its_objects(bytes);
                ASSERT_EQ(values_seen(old.schema, theirs, true), values_seen(old.schema, bytes, true))
                    << old.name << " " << old.kind(bytes);
            }
}

}  // namespace
}  // namespace trochoid
