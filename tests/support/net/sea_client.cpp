#include "tests/support/net/sea_client.hpp"

#include <utility>

#include "protocol/codec/codec.hpp"
#include "protocol/model/self_check.hpp"
#include "protocol/units/version.hpp"

namespace trochoid {

SeaClient::SeaClient(NetLoop& loop, Endpoint server, ClientHello hello, Events events)
    : loop_(loop), server_(std::move(server)), hello_(std::move(hello)), events_(std::move(events)) {
    hello_.protocol_min = protocol_version_min;
    hello_.protocol_max = protocol_version_max;
    hello_.model = model_version;
    hello_.schema_hash = schema_hash();
    if (hello_.software.empty()) hello_.software = "load";
}

void SeaClient::open() {
    connection_ = Connection::open(
        loop_, server_,
        {[this] {
             hello_.clock_stamp_us = client_monotonic_us();
             connection_->send(hello_);
             if (events_.connected) events_.connected();
         },
         [this](ServerMessage message, int64_t received_us) { receive(std::move(message), received_us); },
         [this](const Goodbye& goodbye, CloseCause cause) {
             live_ = false;
             over_ = true;
             connection_.reset();
             if (events_.closed) events_.closed(goodbye, cause);
         }});
}

void SeaClient::show(const ViewState& view) { send(ViewUpdate{++sequence_, view}); }

void SeaClient::send(const ClientMessage& message) {
    if (connection_) connection_->send(message);
}

void SeaClient::leave() {
    if (connection_) connection_->close({});
}

void SeaClient::receive(ServerMessage message, int64_t received_us) {
    if (const auto* hello = std::get_if<ServerHello>(&message)) {
        live_ = true;
        store_.begin(*hello);
        known_answer_ = reference_hash(hello->challenge_seed, hello->challenge_count);
        if (events_.hello) events_.hello(*hello);
    } else if (const auto* delta = std::get_if<Delta>(&message)) {
        take(*delta, received_us);
    } else if (const auto* tiles = std::get_if<TerrainTiles>(&message)) {
        if (const auto taken = store_.apply(*tiles); !taken) connection_->refuse(taken.error());
    }
}

void SeaClient::take(const Delta& delta, int64_t received_us) {
    if (events_.piece) events_.piece(delta);
    auto ack = store_.apply(delta);
    if (!ack) return connection_->refuse(ack.error());
    if (!*ack) return;
    (*ack)->known_answer = std::exchange(known_answer_, std::nullopt);
    connection_->send(**ack);
    if (delta.last && events_.result) events_.result(delta, received_us);
}

}  // namespace trochoid
