#include "tests/fuzz/hostile/hostile_vectors.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "client_bfbs_generated.h"
#include "client_generated.h"
#include "event_bfbs_generated.h"
#include "event_generated.h"
#include "server_bfbs_generated.h"
#include "server_generated.h"
#include "tests/fuzz/hostile/field_rules.hpp"
#include "tests/fuzz/wire_surgery.hpp"
#include "tests/unit/codec/random_messages.hpp"

namespace trochoid {

namespace {

using Direction = HostileVector::Direction;
using reflection::BaseType;

const reflection::Schema& schema_of(Direction direction) {
    switch (direction) {
        case Direction::client: return *reflection::GetSchema(wire_fb::ClientEnvelopeBinarySchema::data());
        case Direction::server: return *reflection::GetSchema(wire_fb::ServerEnvelopeBinarySchema::data());
        default: return *reflection::GetSchema(wire_fb::EventEnvelopeBinarySchema::data());
    }
}

bool is_float(const WireSlot& slot) { return slot.type == BaseType::Float || slot.type == BaseType::Double; }

/// The bits of a float in the slot's width.
uint64_t float_bits(const WireSlot& slot, double value) {
    return slot.type == BaseType::Double ? std::bit_cast<uint64_t>(value)
                                         : std::bit_cast<uint32_t>(static_cast<float>(value));
}

/// The next number that the slot can hold beyond a bound, away from the range.
double beyond(const WireSlot& slot, double bound, double towards) {
    if (slot.type == BaseType::Double) return std::nextafter(bound, towards);
    return static_cast<double>(std::nextafter(static_cast<float>(bound), static_cast<float>(towards)));
}

bool is_signed(BaseType type) {
    return type == BaseType::Byte || type == BaseType::Short || type == BaseType::Int ||
           type == BaseType::Long;
}

struct HostileNumber {
    uint64_t bits;
    ErrorCode code;
};

std::vector<HostileNumber> hostile_floats(const WireSlot& slot, const FieldRule& rule) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const double largest = slot.type == BaseType::Double
                               ? std::numeric_limits<double>::max()
                               : static_cast<double>(std::numeric_limits<float>::max());
    std::vector<HostileNumber> out;
    for (const double v : {infinity, -infinity}) out.push_back({float_bits(slot, v), ErrorCode::not_finite});
    // Quiet, signalling and negative ones, with and without a payload.
    constexpr uint64_t wide[] = {0x7ff8'0000'0000'0000U, 0x7ff0'0000'0000'0001U, 0xfff8'0000'0000'0000U,
                                 UINT64_MAX, 0x7ff8'1234'5678'9abcU};
    constexpr uint64_t narrow[] = {0x7fc0'0000U, 0x7f80'0001U, 0xffc0'0000U, UINT32_MAX, 0x7fc1'2345U};
    for (const uint64_t nan : slot.type == BaseType::Double ? wide : narrow)
        out.push_back({nan, ErrorCode::not_finite});
    if (rule.kind != FieldRule::Kind::range) return out;
    if (rule.least > -largest)
        for (const double v : {beyond(slot, rule.least, -infinity), rule.least - 1.0, -largest})
            out.push_back({float_bits(slot, v), rule.below});
    if (rule.most < largest)
        for (const double v : {beyond(slot, rule.most, infinity), rule.most * 2.0 + 1.0, largest})
            out.push_back({float_bits(slot, v), rule.above});
    return out;
}

std::vector<HostileNumber> hostile_integers(const WireSlot& slot, const FieldRule& rule) {
    std::vector<HostileNumber> out;
    if (rule.kind == FieldRule::Kind::codes) {
        for (const uint64_t bits : {1U, 7U, 99U, 100U, 800U, 899U, 1101U, 32768U, 65535U})
            out.push_back({bits, ErrorCode::value_out_of_range});
        return out;
    }
    if (rule.kind != FieldRule::Kind::range) return out;
    const size_t width = 8 * scalar_bytes(slot.type);
    const auto least = static_cast<int64_t>(rule.least);
    const auto most = static_cast<int64_t>(rule.most);
    const bool negative = is_signed(slot.type);
    const uint64_t all = width == 64 ? UINT64_MAX : (uint64_t{1} << width) - 1;
    const uint64_t largest = negative ? all >> 1 : all;
    const auto smallest = negative ? -static_cast<int64_t>(largest) - 1 : int64_t{0};
    if (least > smallest)
        for (const int64_t v : {least - 1, smallest, least / 2 + smallest / 2 - (negative ? 1 : 0)})
            if (v < least) out.push_back({static_cast<uint64_t>(v), rule.below});
    const auto above = static_cast<uint64_t>(most);
    if (above < largest)
        for (const uint64_t v : {above + 1, largest, largest - 1, above / 2 + largest / 2 + 1})
            if (v > above) out.push_back({v, rule.above});
    return out;
}

/// Not UTF-8, or not fit for a log.
constexpr std::string_view bad_texts[] = {"\x01",         "tab\t",        "line\n",   "\x7f",
                                          "\x1b[2J",      "\xc2\x9b C1",  "\xff",     "\xc0\xaf",
                                          "\xe0\x80\xaf", "\xed\xa0\x80", "\xe6\xb5", "\xf4\x90\x80\x80",
                                          "\x80",         "\xf0\x9f\x8c", "a\xc3(b",  "\xf8\x88\x80\x80\x80"};

class Maker {
public:
    Maker(std::vector<HostileVector>& out, Direction direction, std::string message, Bytes legal)
        : out_(out), direction_(direction), message_(std::move(message)), legal_(std::move(legal)) {}

    /// `known`: fields × values of this message type that have vectors already.
    void make_all(const FieldRules& rules, std::set<std::string>& known) {
        for (const WireSlot& slot : walk(schema_of(direction_), legal_)) {
            const FieldRule* rule = slot.kind == WireSlot::Kind::union_tag ? nullptr : &rules.of(slot);
            // A field is tried in the first, second and last place of a list, not in each.
            if (!known.insert(message_ + slot.path).second) continue;
            switch (slot.kind) {
                case WireSlot::Kind::union_tag: tags(slot); break;
                case WireSlot::Kind::scalar: scalars(slot, *rule); break;
                case WireSlot::Kind::list: lists(slot, *rule); break;
                case WireSlot::Kind::text: texts(slot, *rule); break;
                case WireSlot::Kind::table: presence(slot, rule); break;
            }
        }
        if (known.insert(message_ + " end").second) ends();
    }

private:
    void give(const WireSlot& slot, std::string_view wrong, std::string_view kind, ErrorCode code,
              Bytes bytes) {
        out_.push_back({direction_, fmt::format("{} {} {}", message_, slot.path, wrong), std::string(kind),
                        code, std::move(bytes)});
    }

    void tags(const WireSlot& slot) {
        for (const uint32_t tag : {0U, slot.count, slot.count + 1, 63U, 127U, 128U, 200U, 255U}) {
            Bytes bytes = legal_;
            bytes[slot.at] = static_cast<uint8_t>(tag);
            give(slot, fmt::format("tag {}", tag), "unknown tag", ErrorCode::unknown_message,
                 std::move(bytes));
        }
        Bytes bytes = legal_;
        drop_field(bytes, slot);
        give(slot, "without its tag", "unknown tag", ErrorCode::unknown_message, std::move(bytes));
    }

    void scalars(const WireSlot& slot, const FieldRule& rule) {
        if (rule.kind == FieldRule::Kind::size) {
            const auto right = static_cast<uint32_t>(legal_.size());
            for (const uint32_t size :
                 {0U, 1U, right - 8, right - 1, right + 1, right + 8, right * 2, UINT32_MAX})
                number(slot, {size, ErrorCode::trailing_bytes}, "size field");
            Bytes bytes = legal_;
            drop_field(bytes, slot);
            return give(slot, "absent", "size field", ErrorCode::trailing_bytes, std::move(bytes));
        }
        for (const HostileNumber& n :
             is_float(slot) ? hostile_floats(slot, rule) : hostile_integers(slot, rule))
            number(slot, n, n.code == ErrorCode::not_finite ? "not finite" : "out of range");
        const bool zero_is_legal =
            rule.kind != FieldRule::Kind::range || (rule.least <= 0.0 && rule.most >= 0.0);
        if (slot.holder == 0 || zero_is_legal) return;
        Bytes bytes = legal_;
        drop_field(bytes, slot);
        give(slot, "absent, so 0", "out of range", rule.below, std::move(bytes));
    }

    void number(const WireSlot& slot, const HostileNumber& n, std::string_view kind) {
        Bytes bytes = legal_;
        set_scalar(bytes, slot, n.bits);
        if (bytes == legal_) return;
        give(slot, fmt::format("= {:#x}", n.bits), kind, n.code, std::move(bytes));
    }

    void lists(const WireSlot& slot, const FieldRule& rule) {
        presence(slot, &rule);
        for (const uint32_t count : {rule.most_entries + 1, rule.most_entries + 16}) {
            Bytes bytes = legal_;
            if (slot.count > 0 && resize_list(bytes, slot, count))
                give(slot, fmt::format("with {} entries", count), "too long", rule.above, std::move(bytes));
        }
        if (slot.entry_align < 8) return;
        for (const uint32_t count : {slot.count, 1U, 2U}) {
            Bytes bytes = legal_;
            if (count > 0 && count <= rule.most_entries && resize_list(bytes, slot, count, 4))
                give(slot, fmt::format("{} entries at 4 mod 8", count), "misaligned",
                     ErrorCode::verification_failed, std::move(bytes));
        }
    }

    void texts(const WireSlot& slot, const FieldRule& rule) {
        presence(slot, &rule);
        const auto text = [&](const std::string& content, std::string_view kind) {
            Bytes bytes = legal_;
            const auto* raw = reinterpret_cast<const uint8_t*>(content.data());
            replace_list(bytes, slot, static_cast<uint32_t>(content.size()), {raw, content.size()});
            give(slot, fmt::format("of {} bytes", content.size()), kind, ErrorCode::value_out_of_range,
                 std::move(bytes));
        };
        for (const size_t more : {1U, 2U, 100U}) text(std::string(rule.most_entries + more, 'x'), "too long");
        for (const std::string_view bad : bad_texts) {
            text(std::string(bad), "bad text");
            text("name " + std::string(bad), "bad text");
        }
        text(std::string("nul\0in it", 9), "bad text");
    }

    void presence(const WireSlot& slot, const FieldRule* rule) {
        if (slot.holder == 0 || !rule->required) return;
        Bytes bytes = legal_;
        drop_field(bytes, slot);
        give(slot, "absent", "missing", ErrorCode::missing_field, std::move(bytes));
    }

    void ends() {
        WireSlot whole;
        whole.path = "buffer";
        for (const size_t more : {1U, 2U, 3U, 4U, 7U, 8U, 16U, 64U, 1000U}) {
            Bytes bytes = legal_;
            for (size_t i = 0; i < more; ++i) bytes.push_back(static_cast<uint8_t>(i));
            give(whole, fmt::format("and {} bytes more", more), "trailing", ErrorCode::trailing_bytes,
                 std::move(bytes));
        }
    }

    std::vector<HostileVector>& out_;
    Direction direction_;
    std::string message_;
    Bytes legal_;
};

/// Legal messages of every type in which as many fields as possible are there.
template <class Encode>
void add_kind(std::vector<HostileVector>& out, const FieldRules& rules, Direction direction, size_t kind,
              Encode encoded) {
    Dice dice(7000 + 100 * static_cast<uint64_t>(direction) + kind);
    std::set<std::string> known;
    // Random messages of one type differ in what they have; what an earlier one had is not tried again.
    for (int round = 0; round < 24; ++round) {
        const auto& [name, bytes] = encoded(dice, kind);
        Maker(out, direction, name, bytes).make_all(rules, known);
    }
}

}  // namespace

std::string name_of(Direction direction) {
    return direction == Direction::client ? "client" : direction == Direction::server ? "server" : "event";
}

bool verifies(const HostileVector& v) {
    flatbuffers::Verifier verifier(v.bytes.data(), v.bytes.size());
    switch (v.direction) {
        case Direction::client: return wire_fb::VerifyClientEnvelopeBuffer(verifier);
        case Direction::server: return wire_fb::VerifyServerEnvelopeBuffer(verifier);
        default: return wire_fb::VerifyEventEnvelopeBuffer(verifier);
    }
}

Error refusal(const HostileVector& v) {
    const auto error_of = [](const auto& result) { return result ? Error{} : result.error(); };
    switch (v.direction) {
        case Direction::client: return error_of(decode_client(v.bytes));
        case Direction::server: return error_of(decode_server(v.bytes));
        default: return error_of(decode_event(v.bytes));
    }
}

std::vector<HostileVector> hostile_vectors() {
    const FieldRules rules(TROCHOID_SOURCE_DIR "/tests/fuzz/hostile/field_rules.txt");
    std::vector<HostileVector> out;
    for (size_t kind = 0; kind < client_kinds; ++kind)
        add_kind(out, rules, Direction::client, kind, [](Dice& dice, size_t k) {
            const Bytes bytes = encode(random_client_message(dice, k));
            const auto* envelope = wire_fb::GetClientEnvelope(bytes.data());
            std::string name = wire_fb::EnumNameClientBody(envelope->body_type());
            if (const auto* command = envelope->body_as_Command())
                name = std::string("Command:") + wire_fb::EnumNameAction(command->action_type());
            return std::pair(name, bytes);
        });
    for (size_t kind = 0; kind < server_kinds; ++kind)
        add_kind(out, rules, Direction::server, kind, [](Dice& dice, size_t k) {
            ServerMessage message = random_server_message(dice, k);
            // Boxes of few trains: the rest is more of the same.
            if (auto* delta = std::get_if<Delta>(&message))
                delta->change = random_change(dice, 0, 2, 4, 2),
                delta->change.boxes = {std::make_shared<WaveTrainBox>(random_box(dice, 7, 3)),
                                       std::make_shared<WaveTrainBox>(random_ship(dice, 9))};
            const Bytes bytes = encode(message);
            return std::pair(std::string(wire_fb::EnumNameServerBody(
                                 wire_fb::GetServerEnvelope(bytes.data())->body_type())),
                             bytes);
        });
    for (size_t kind = 0; kind < event_kinds; ++kind)
        add_kind(out, rules, Direction::event, kind, [](Dice& dice, size_t k) {
            LogEvent event = random_event(dice, k);
            if (auto* started = std::get_if<BoxStarted>(&event.what)) started->box = random_box(dice, 5, 3);
            if (auto* land = std::get_if<LandChanged>(&event.what))
                land->boxes = {{{3}, random_box(dice, 11, 2)}}, land->also = {land->change};
            const Bytes bytes = encode(event);
            return std::pair(
                std::string(wire_fb::EnumNameEventBody(wire_fb::GetEventEnvelope(bytes.data())->body_type())),
                bytes);
        });
    add_contradictions(out);
    return out;
}

}  // namespace trochoid
