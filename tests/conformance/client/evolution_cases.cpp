#include <fmt/format.h>

#include <cstring>

#include "tests/conformance/client/refusals.hpp"
#include "tests/conformance/kit_sea.hpp"

// messages of the next version, and what the agreed one does not know.
namespace trochoid::conformance::client {

namespace {

/// The message as a program of a later version writes it: its body has a field beyond those of today. The vtable moves to the end of the
/// buffer; the new field's bytes are none that an older program looks at.
Bytes with_new_field(const ServerMessage& message) {
    Bytes bytes = encode(message);
    auto* envelope = wire_fb::GetMutableServerEnvelope(bytes.data());
    const auto table =
        static_cast<size_t>(static_cast<const uint8_t*>(envelope->mutable_body()) - bytes.data());
    const size_t vtable = static_cast<size_t>(static_cast<int64_t>(table) -
                                              flatbuffers::ReadScalar<flatbuffers::soffset_t>(&bytes[table]));
    const size_t old_bytes = flatbuffers::ReadScalar<flatbuffers::voffset_t>(&bytes[vtable]);
    constexpr size_t new_field = 100;  // its place in the vtable, after 47 others
    const size_t new_bytes = new_field + sizeof(flatbuffers::voffset_t);
    const size_t place = bytes.size();
    constexpr size_t unit = 8;
    bytes.resize((place + new_bytes + unit - 1) / unit * unit);
    std::memcpy(&bytes[place], &bytes[vtable], old_bytes);
    flatbuffers::WriteScalar(&bytes[place], static_cast<flatbuffers::voffset_t>(new_bytes));
    flatbuffers::WriteScalar(&bytes[place + new_field],
                             static_cast<flatbuffers::voffset_t>(sizeof(flatbuffers::soffset_t)));
    flatbuffers::WriteScalar(&bytes[table], static_cast<flatbuffers::soffset_t>(static_cast<int64_t>(table) -
                                                                                static_cast<int64_t>(place)));
    wire_fb::GetMutableServerEnvelope(bytes.data())->mutate_size(static_cast<uint32_t>(bytes.size()));
    return bytes;
}

void add_new_fields(Catalogue& all) {
    all.push_back(client_case("R-171/ServerHello-new-field", "Our hello has a field that nobody knows yet",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = trial.accept();
                                  peer.await_hello();
                                  peer.prepare(peer.usual_hello());
                                  peer.send_payload(with_new_field(peer.ours()));
                                  peer.expect_service();
                              }));
    all.push_back(client_case("R-171/Delta-new-field", "A result has a field that nobody knows yet",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = trial.welcome();
                                  for (const Delta& piece : peer.pieces_to(laden_sea(), true))
                                      peer.send_payload(with_new_field(piece));
                                  peer.hold(1, laden_sea());
                                  peer.await_ack(1);
                              }));
    all.push_back(client_case("R-171/Goodbye-new-field", "A goodbye has a field that nobody knows yet",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = trial.welcome();
                                  Goodbye goodbye;
                                  goodbye.code = ErrorCode::shutting_down;
                                  goodbye.message = "the test is over";
                                  peer.send_payload(with_new_field(goodbye));
                                  peer.expect_end();
                                  if (peer.goodbye() && peer.goodbye()->code != ErrorCode::none)
                                      throw Failed{"the client complains about a goodbye"};
                              }));
    all.push_back(client_case("R-171/ClockReply-new-field",
                              "Clock replies have a field that nobody knows yet", [](ClientTrial& trial) {
                                  ClientPeer& peer = trial.welcome();
                                  peer.answer_by_itself(false);
                                  for (int i = 0; i < 3; ++i) {
                                      const auto request = peer.await<ClockRequest>("clock request");
                                      ClockReply reply;
                                      reply.sequence = request.sequence;
                                      reply.client_sent_us = request.client_sent_us;
                                      reply.server_received_us = reply.server_sent_us = monotonic_us();
                                      reply.clock = peer.ours().clock;
                                      reply.watermark = peer.sea_time_now();
                                      peer.send_payload(with_new_field(reply));
                                  }
                                  peer.answer_by_itself(true);
                                  peer.expect_service();
                              }));
}

}  // namespace

void add_evolution_cases(Catalogue& all) {
    add_new_fields(all);
    all.push_back(client_case("R-175/version-2",
                              "In version 2 nothing comes that it does not know, whatever our hello offers",
                              [](ClientTrial& trial) {
                                  constexpr uint16_t version = 2;
                                  ClientPeer& peer = trial.accept();
                                  const ClientHello& hello = peer.await_hello();
                                  if (version < hello.protocol_min || version > hello.protocol_max)
                                      throw Skipped{"the client does not offer version 2"};
                                  peer.welcome_now([](ServerHello& ours) {
                                      ours.protocol = version;
                                      ours.capabilities = capability_probes | capability_resume;
                                  });
                                  peer.expect_service();
                                  peer.listen(Milliseconds(800));
                                  peer.expect_service();
                              }));
}

}  // namespace trochoid::conformance::client
