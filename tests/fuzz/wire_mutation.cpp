#include "tests/fuzz/wire_mutation.hpp"

#include <algorithm>
#include <bit>

#include "client_bfbs_generated.h"
#include "client_generated.h"
#include "event_bfbs_generated.h"
#include "event_generated.h"
#include "protocol/wire/frame.hpp"
#include "server_bfbs_generated.h"
#include "server_generated.h"
#include "tests/fuzz/wire_surgery.hpp"

namespace trochoid {

namespace {

using reflection::BaseType;

template <class T>
const T& pick(Dice& dice, const std::vector<T>& from) {
    return from[static_cast<size_t>(dice.between(0, static_cast<int64_t>(from.size()) - 1))];
}

template <class Decode>
Bytes decoded_and_encoded(const Bytes& bytes, Decode decode) {
    const auto result = decode(bytes);
    return result ? encode(*result) : Bytes{};
}

/// Numbers at which something may change.
uint64_t notable(const WireSlot& slot, uint64_t now, Dice& dice) {
    if (slot.type == BaseType::Float) {
        static constexpr uint32_t floats[] = {0,           0x80000000U, 0x3f800000U, 0xbf800000U,
                                              0x7f800000U, 0xff800000U, 0x7fc00000U, 0x00000001U,
                                              0x7f7fffffU, 0x35800000U, 0x43b40000U, 0x42000000U};
        if (dice.coin()) return floats[dice.between(0, 11)];
        const auto old = static_cast<uint32_t>(std::bit_cast<uint64_t>(std::bit_cast<double>(now)) >> 32);
        return dice.coin() ? old + static_cast<uint32_t>(dice.between(-2, 2)) : dice.any<uint32_t>();
    }
    switch (dice.between(0, 5)) {
        case 0: return uint64_t{1} << dice.between(0, 63);
        case 1: return (uint64_t{1} << dice.between(0, 63)) - 1;
        case 2: return ~(uint64_t{1} << dice.between(0, 63)) + 1;
        case 3: return now + static_cast<uint64_t>(dice.between(-2, 2));
        case 4: return static_cast<uint64_t>(dice.between(0, 40));
        default: return dice.bits();
    }
}

void change_list(Bytes& bytes, const WireSlot& slot, Dice& dice) {
    if (slot.of_tables) {
        // Shorter in place.
        if (slot.count > 0)
            flatbuffers::WriteScalar(bytes.data() + slot.at,
                                     static_cast<uint32_t>(dice.between(0, slot.count)));
        return;
    }
    const int64_t many = dice.between(0, 9) == 0 ? 300 : int64_t{slot.count} + 2;
    resize_list(bytes, slot, static_cast<uint32_t>(dice.between(0, many)), dice.between(0, 15) == 0 ? 4 : 0);
}

void change_text(Bytes& bytes, const WireSlot& slot, Dice& dice) {
    Bytes text(static_cast<size_t>(dice.between(0, dice.coin() ? 8 : 600)));
    for (uint8_t& b : text)
        b = dice.between(0, 9) == 0 ? dice.any<uint8_t>() : static_cast<uint8_t>(dice.between(32, 126));
    replace_list(bytes, slot, static_cast<uint32_t>(text.size()), text);
}

/// A field that names a table, list or text names another one of its kind, which both share then.
void share(Bytes& bytes, const WireSlot& slot, const std::vector<WireSlot>& slots, Dice& dice) {
    const WireSlot& other = pick(dice, slots);
    if (other.reference == 0 || other.kind != slot.kind || other.name != slot.name ||
        other.at <= slot.reference)
        return;
    flatbuffers::WriteScalar(bytes.data() + slot.reference, static_cast<uint32_t>(other.at - slot.reference));
}

void change(Bytes& bytes, const WireSlot& slot, const std::vector<WireSlot>& slots, Dice& dice) {
    if (slot.holder != 0 && dice.between(0, 15) == 0) return drop_field(bytes, slot);
    if (slot.reference != 0 && dice.between(0, 7) == 0) return share(bytes, slot, slots, dice);
    switch (slot.kind) {
        case WireSlot::Kind::scalar: {
            const WireSlot& other = pick(dice, slots);
            const bool copied = dice.between(0, 3) == 0 && other.kind == slot.kind &&
                                other.type == slot.type && slot.type != BaseType::Float &&
                                slot.type != BaseType::Double;
            const uint64_t now = bits_of(slot, bytes);
            return set_scalar(bytes, slot, copied ? bits_of(other, bytes) : notable(slot, now, dice));
        }
        case WireSlot::Kind::union_tag:
            bytes[slot.at] = static_cast<uint8_t>(dice.between(0, slot.count));
            break;
        case WireSlot::Kind::list: change_list(bytes, slot, dice); break;
        case WireSlot::Kind::text: change_text(bytes, slot, dice); break;
        case WireSlot::Kind::table: break;
    }
    set_size_field(bytes);
}

Bytes random_client(Dice& dice) {
    const auto kind = dice.between(0, static_cast<int64_t>(client_kinds) - 1);
    return encode(random_client_message(dice, static_cast<size_t>(kind)));
}
Bytes random_server(Dice& dice) {
    const auto kind = dice.between(0, static_cast<int64_t>(server_kinds) - 1);
    return encode(random_server_message(dice, static_cast<size_t>(kind)));
}
Bytes random_log_event(Dice& dice) {
    return encode(
        random_event(dice, static_cast<size_t>(dice.between(0, static_cast<int64_t>(event_kinds) - 1))));
}

}  // namespace

const WireForm& client_form() {
    static const WireForm form{*reflection::GetSchema(wire_fb::ClientEnvelopeBinarySchema::data()),
                               [](const Bytes& b) {
                                   flatbuffers::Verifier verifier(b.data(), b.size());
                                   return b.size() >= 8 && wire_fb::VerifyClientEnvelopeBuffer(verifier);
                               },
                               random_client,
                               [](const Bytes& b) {
                                   return decoded_and_encoded(
                                       b, [](const Bytes& c) { return decode_client(c); });
                               }};
    return form;
}

const WireForm& server_form() {
    static const WireForm form{*reflection::GetSchema(wire_fb::ServerEnvelopeBinarySchema::data()),
                               [](const Bytes& b) {
                                   flatbuffers::Verifier verifier(b.data(), b.size());
                                   return b.size() >= 8 && wire_fb::VerifyServerEnvelopeBuffer(verifier);
                               },
                               random_server,
                               [](const Bytes& b) {
                                   return decoded_and_encoded(
                                       b, [](const Bytes& c) { return decode_server(c); });
                               }};
    return form;
}

const WireForm& event_form() {
    static const WireForm form{*reflection::GetSchema(wire_fb::EventEnvelopeBinarySchema::data()),
                               [](const Bytes& b) {
                                   flatbuffers::Verifier verifier(b.data(), b.size());
                                   return b.size() >= 8 && wire_fb::VerifyEventEnvelopeBuffer(verifier);
                               },
                               random_log_event,
                               [](const Bytes& b) {
                                   return decoded_and_encoded(b,
                                                              [](const Bytes& c) { return decode_event(c); });
                               }};
    return form;
}

Bytes mutate_message(const WireForm& form, const Bytes& input, Dice& dice, size_t most) {
    if (dice.between(0, 31) == 0) {
        Bytes fresh = form.random(dice);
        return fresh.size() <= most ? fresh : Bytes{};
    }
    if (!form.verifies(input)) return {};
    Bytes bytes = input;
    if (dice.between(0, 7) == 0) {
        // What earlier mutations have left lying about goes.
        const Bytes tidy = form.through(input);
        if (!tidy.empty()) bytes = tidy;
    }
    for (int64_t changes = dice.between(1, 3); changes > 0; --changes) {
        const std::vector<WireSlot> slots = walk(form.schema, bytes, 4000);
        if (slots.empty()) return {};  // an envelope without anything
        change(bytes, pick(dice, slots), slots, dice);
        if (bytes.size() > most || !form.verifies(bytes)) return {};
    }
    return bytes;
}

void repair_message(const WireForm& form, std::span<uint8_t> input) {
    Bytes bytes(input.begin(), input.end());
    if (!form.verifies(bytes)) return;
    set_size_field(bytes);
    std::copy(bytes.begin(), bytes.end(), input.begin());
}

std::vector<Bytes> payloads_of(std::span<const uint8_t> frames) {
    FrameReader reader(FrameReader::Opening::frames, 1U << 20);
    std::vector<Bytes> payloads;
    while (!frames.empty()) {
        auto next = reader.next(frames);
        if (!next || !*next) break;
        payloads.push_back(std::move(**next));
    }
    return payloads;
}

Bytes mutate_frames(const WireForm& form, const Bytes& input, Dice& dice, size_t most) {
    if (input.empty()) return {};
    std::vector<Bytes> all = payloads_of(std::span(input).subspan(1));
    const auto any_place = [&](size_t beyond) {
        return static_cast<std::ptrdiff_t>(dice.between(0, static_cast<int64_t>(all.size() + beyond) - 1));
    };
    const int64_t what = dice.between(0, 9);
    if (all.empty() || what == 0) {
        all.insert(all.begin() + any_place(1), form.random(dice));
    } else if (what == 1) {
        const Bytes copy = all[static_cast<size_t>(any_place(0))];
        all.insert(all.begin() + any_place(1), copy);
    } else if (what == 2) {
        all.erase(all.begin() + any_place(0));
    } else if (what == 3) {
        std::swap(all[static_cast<size_t>(any_place(0))], all[static_cast<size_t>(any_place(0))]);
    } else {
        Bytes& one = all[static_cast<size_t>(any_place(0))];
        Bytes changed = mutate_message(form, one, dice, most);
        if (!changed.empty()) one = std::move(changed);
    }
    Bytes out{dice.between(0, 15) == 0 ? dice.any<uint8_t>() : input[0]};
    for (const Bytes& payload : all) {
        if (payload.empty()) continue;
        const Bytes framed = frame(payload);
        out.insert(out.end(), framed.begin(), framed.end());
    }
    return out.size() <= most ? out : Bytes{};
}

}  // namespace trochoid
