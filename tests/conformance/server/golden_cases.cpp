#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tests/conformance/golden_vectors.hpp"
#include "tests/conformance/hostile.hpp"
#include "tests/conformance/server/refusals.hpp"

// messages as others encode them, from older and from later programs.
namespace trochoid::conformance::server {

namespace {

/// Codes that say that a message could not be read.
bool unread(ErrorCode code) {
    constexpr std::array codes{ErrorCode::verification_failed, ErrorCode::trailing_bytes,
                               ErrorCode::unknown_message,     ErrorCode::value_out_of_range,
                               ErrorCode::not_finite,          ErrorCode::not_a_unit_quaternion,
                               ErrorCode::missing_field};
    return std::find(codes.begin(), codes.end(), code) != codes.end();
}

void add_vectors(Catalogue& all) {
    for (const GoldenMessage& golden : golden_messages()) {
        if (golden.direction != "client") continue;
        const bool hello = golden.name.starts_with("hello");
        all.push_back(server_case("R-119/" + golden.name, "The golden message '" + golden.name + "' is read",
                                  [golden, hello](ServerTrial& trial) {
                                      ServerPeer& peer = trial.connect();
                                      if (hello)
                                          peer.send_magic();
                                      else
                                          peer.log_in();
                                      peer.send_payload(golden.bytes);
                                      peer.settle(Milliseconds(100));
                                      // A golden acknowledgement is of a result that this session never had: it was read then.
                                      const bool read = peer.goodbye() && peer.goodbye()->requirement >= 134;
                                      if (peer.goodbye() && !read && unread(peer.goodbye()->code))
                                          throw Failed{
                                              fmt::format("it was refused with code {} ({})",
                                                          static_cast<unsigned>(peer.goodbye()->code),
                                                          peer.goodbye()->message)};
                                  }));
    }
}

/// A clock request with a field that no version has, behind those that it has.
Bytes request_with_more_fields() {
    Builder b;
    b.ForceDefaults(true);
    const auto start = b.StartTable();
    b.AddElement<uint32_t>(4, 1, 0);
    b.AddElement<int64_t>(6, 77, 0);
    b.AddElement<uint64_t>(8, 0x1122334455667788, 0);
    b.AddElement<float>(10, std::numeric_limits<float>::quiet_NaN(), 0.0F);
    const TableOffset body(b.EndTable(start));
    wire_fb::FinishClientEnvelopeBuffer(
        b, wire_fb::CreateClientEnvelope(b, 0, wire_fb::ClientBody::ClockRequest, body));
    wire_fb::GetMutableClientEnvelope(b.GetBufferPointer())->mutate_size(b.GetSize());
    return {b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()};
}

/// The same with its envelope's fields in another order, and more of them.
Bytes envelope_with_more_fields() {
    Builder b;
    b.ForceDefaults(true);
    const auto body = wire_fb::CreateClockRequest(b, 1, 77).Union();
    const auto start = b.StartTable();
    b.AddElement<uint64_t>(12, 5, 0);
    b.AddOffset(8, body);
    b.AddElement<uint8_t>(6, static_cast<uint8_t>(wire_fb::ClientBody::ClockRequest), 0);
    b.AddElement<uint32_t>(4, 0, 1);
    const flatbuffers::Offset<wire_fb::ClientEnvelope> envelope(b.EndTable(start));
    wire_fb::FinishClientEnvelopeBuffer(b, envelope);
    wire_fb::GetMutableClientEnvelope(b.GetBufferPointer())->mutate_size(b.GetSize());
    return {b.GetBufferPointer(), b.GetBufferPointer() + b.GetSize()};
}

void add_evolution(Catalogue& all) {
    const auto answered = [&](const char* id, const char* title, Bytes bytes) {
        all.push_back(server_case(id, title, [bytes = std::move(bytes)](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            peer.send_payload(bytes);
            if (peer.await<ClockReply>("clock reply").client_sent_us != 77)
                throw Failed{"the reply echoes another stamp"};
        }));
    };
    answered("R-174/more-fields", "Fields of a later version behind those known are passed over",
             request_with_more_fields());
    answered("R-174/envelope", "An envelope with its fields in another order, and one more",
             envelope_with_more_fields());
    const auto goodbye = [](uint16_t code) {
        return built(wire_fb::ClientBody::Goodbye, [&](Builder& b) {
            const auto text = b.CreateString("leaving");
            return wire_fb::CreateGoodbye(b, static_cast<wire_fb::Code>(code), text).Union();
        });
    };
    for (const uint16_t code : {uint16_t{199}, uint16_t{450}, uint16_t{799}})
        all.push_back(server_case(fmt::format("R-175/code-{}", code),
                                  "A goodbye with a code of a later version counts as one of its class",
                                  [=](ServerTrial& trial) {
                                      ServerPeer& peer = trial.log_in();
                                      peer.settle(Milliseconds(50));
                                      peer.send_payload(goodbye(code));
                                      peer.expect_silent_end();
                                  }));
    all.push_back(server_case("R-174/capabilities", "Capabilities that no version has are passed over",
                              [](ServerTrial& trial) {
                                  ClientHello hello = ServerPeer::usual_hello();
                                  hello.capabilities = UINT64_MAX;
                                  trial.log_in(hello).expect_service();
                              }));
    all.push_back(server_case("R-175/version-2", "A client of version 2 gets along", [](ServerTrial& trial) {
        ClientHello hello = ServerPeer::usual_hello();
        hello.protocol_min = hello.protocol_max = 2;
        hello.view = view_of_water(trial.target());
        ServerPeer& peer = trial.log_in(hello);
        bool planes = false;
        peer.watch([&](const ServerMessage& message, int64_t) {
            const auto* delta = std::get_if<Delta>(&message);
            planes = planes || (delta != nullptr && delta->patch_form == PatchForm::planes);
        });
        peer.await_result(0);
        peer.ask_boxes();
        peer.expect_service();
        if (planes) throw Failed{"R-175: patches come as planes, which version 2 does not know"};
    }));
}

}  // namespace

void add_golden_cases(Catalogue& all) {
    add_vectors(all);
    add_evolution(all);
}

}  // namespace trochoid::conformance::server
