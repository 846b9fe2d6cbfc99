#include <map>

#include "protocol/wire/frame.hpp"
#include "protocol/wire/session_rules.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/wire_mutation.hpp"

namespace trochoid {

namespace {

/// A stream cut into payloads the obvious way.
struct Expected {
    std::vector<Bytes> payloads;
    ErrorCode error = ErrorCode::none;
    bool between_frames = true;
};

Expected cut(std::span<const uint8_t> stream, bool magic, uint32_t longest) {
    Expected out;
    if (magic) {
        for (size_t i = 0; i < stream_magic.size(); ++i) {
            if (i == stream.size()) return out.between_frames = false, out;
            if (stream[i] != stream_magic[i]) return out.error = ErrorCode::wrong_magic, out;
        }
        stream = stream.subspan(stream_magic.size());
    }
    while (!stream.empty()) {
        out.between_frames = false;
        if (stream.size() < frame_header_bytes) return out;
        uint32_t length = 0;
        uint32_t zero = 0;
        for (size_t i = 0; i < 4; ++i) {
            length |= uint32_t{stream[i]} << (8 * i);
            zero |= uint32_t{stream[4 + i]} << (8 * i);
        }
        if (zero != 0 || length == 0) return out.error = ErrorCode::malformed_frame, out;
        if (length > longest) return out.error = ErrorCode::frame_too_long, out;
        stream = stream.subspan(frame_header_bytes);
        if (stream.size() < length) return out;
        out.payloads.push_back(owned(stream.first(length)));
        stream = stream.subspan(length);
        out.between_frames = true;
    }
    return out;
}

/// Whatever pieces a stream comes in, the reader finds what the obvious way finds, and owns no more than came.
void check_frames(std::span<const uint8_t> input) {
    InputReader control(input);
    const uint8_t flags = control.byte();
    Dice pieces(control.byte());
    const bool magic = (flags & 1U) != 0;
    const uint32_t longest = uint32_t{1} << (4 + (flags >> 4));
    const Bytes stream = owned(control.rest());
    const Expected expected = cut(stream, magic, longest);
    FrameReader reader(magic ? FrameReader::Opening::magic : FrameReader::Opening::frames, longest);
    size_t read = 0;
    std::span<const uint8_t> rest(stream);
    while (!rest.empty()) {
        const auto most = static_cast<int64_t>(rest.size());
        const auto size =
            static_cast<size_t>(pieces.between(1, std::min(most, pieces.coin() ? int64_t{9} : most)));
        std::span<const uint8_t> piece = rest.first(size);
        rest = rest.subspan(size);
        while (!piece.empty()) {
            const size_t before = piece.size();
            auto next = reader.next(piece);
            TROCHOID_ASSERT(reader.allocated() <= stream.size() - rest.size() + FrameReader::read_ahead,
                            "{} bytes owned after {} came", reader.allocated(), stream.size() - rest.size());
            if (!next) {
                check_refusal(next.error());
                TROCHOID_ASSERT(next.error().code == expected.error, "code {} where {} was due",
                                static_cast<int>(next.error().code), static_cast<int>(expected.error));
                TROCHOID_ASSERT(read == expected.payloads.size(), "an error after {} payloads of {}", read,
                                expected.payloads.size());
                const auto again = reader.next(piece);
                TROCHOID_ASSERT(!again && again.error() == next.error(), "an error that does not stay");
                return;
            }
            TROCHOID_ASSERT(*next || piece.empty(), "{} bytes of {} left without a payload", piece.size(),
                            before);
            if (!*next) continue;
            TROCHOID_ASSERT(read < expected.payloads.size() && **next == expected.payloads[read],
                            "payload {} is another", read);
            TROCHOID_ASSERT(reinterpret_cast<uintptr_t>((*next)->data()) % 8 == 0, "a payload is misaligned");
            ++read;
        }
    }
    TROCHOID_ASSERT(expected.error == ErrorCode::none, "code {} did not come",
                    static_cast<int>(expected.error));
    TROCHOID_ASSERT(read == expected.payloads.size(), "{} payloads of {}", read, expected.payloads.size());
    TROCHOID_ASSERT(reader.between_frames() == expected.between_frames, "between frames or not");
}

Bytes mutate_stream(const Bytes& input, Dice& dice, size_t most) {
    if (input.size() < 2) return {};
    Bytes out(input.begin(), input.begin() + 2);
    if ((out[0] & 1U) != 0) out.insert(out.end(), stream_magic.begin(), stream_magic.end());
    for (int64_t frames = dice.between(0, 5); frames > 0; --frames) {
        const Bytes framed =
            frame(Bytes(static_cast<size_t>(dice.between(1, 1 << dice.between(0, 9))), dice.any<uint8_t>()));
        out.insert(out.end(), framed.begin(), framed.end());
    }
    if (dice.coin() && out.size() > 2)
        out[static_cast<size_t>(dice.between(2, static_cast<int64_t>(out.size()) - 1))] ^= 1;
    if (dice.coin()) out.resize(static_cast<size_t>(dice.between(2, static_cast<int64_t>(out.size()))));
    return out.size() <= most ? out : Bytes{};
}

bool is_sequenced(const ClientMessage& message) {
    return !std::holds_alternative<ClientHello>(message) && !std::holds_alternative<Ack>(message) &&
           !std::holds_alternative<Goodbye>(message);
}

/// The rules of a session against a plain account of them.
void check_session(std::span<const uint8_t> input) {
    InputReader control(input);
    const auto role = static_cast<Role>(control.byte() % 3);
    SessionPhase phase = SessionPhase::awaiting_hello;
    SequenceRule sequences;
    int hellos = 0;
    bool goodbye = false;
    std::map<size_t, uint32_t> last;
    for (const Bytes& payload : payloads_of(control.rest())) {
        const auto message = decode_client(payload);
        if (!message) return check_refusal(message.error());
        const bool is_hello = std::holds_alternative<ClientHello>(*message);
        const bool is_goodbye = std::holds_alternative<Goodbye>(*message);
        const bool fits = !goodbye && (hellos == 0 ? is_hello || is_goodbye : !is_hello);
        const auto ok = expected(phase, *message);
        TROCHOID_ASSERT(ok.has_value() == fits, "message {} of phase {}", message->index(),
                        static_cast<int>(phase));
        if (!ok) return check_refusal(ok.error());
        phase = phase_after(phase, *message);
        hellos += is_hello ? 1 : 0;
        goodbye = is_goodbye;
        if (is_hello)
            if (const auto version = common_version(std::get<ClientHello>(*message)); !version)
                check_refusal(version.error());

        const uint32_t number =
            std::holds_alternative<Ack>(*message) ? std::get<Ack>(*message).result : sequence_of(*message);
        const bool in_order =
            is_sequenced(*message) ? number > last[message->index()] : number >= last[message->index()];
        const auto sequence = sequences.accept(*message);
        TROCHOID_ASSERT(sequence.has_value() == in_order, "{} after {} of type {}", number,
                        last[message->index()], message->index());
        if (!sequence) return check_refusal(sequence.error());
        last[message->index()] = number;

        const auto* command = std::get_if<Command>(&*message);
        const bool moves_time = command != nullptr && (std::holds_alternative<SetRate>(command->action) ||
                                                       std::holds_alternative<SkipTime>(command->action));
        const bool may = command == nullptr || std::holds_alternative<ListBoxes>(command->action) ||
                         role == Role::admin || (role == Role::director && !moves_time);
        const auto allowed = permitted(role, *message);
        TROCHOID_ASSERT(allowed.has_value() == may, "role {} and command {}", static_cast<int>(role),
                        command->action.index());
        if (!allowed) check_refusal(allowed.error());
    }
}

}  // namespace

const FuzzTarget frames_target{"frames", check_frames, 4096, mutate_stream};

const FuzzTarget session_target{
    "session", check_session, 20'000,
    [](const Bytes& in, Dice& dice, size_t most) { return mutate_frames(client_form(), in, dice, most); }};

}  // namespace trochoid
