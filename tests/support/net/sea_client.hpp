#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "client/net/connection.hpp"
#include "client/store/client_store.hpp"

namespace trochoid {

/// The real client's connection and store, without threads of its own and without coming back: many of these make a load.
/// Keeps the standard: acknowledges, answers the known-answer challenge. Everything on the loop's thread but the constructor.
class SeaClient {
public:
    struct Events {
        std::function<void()> connected;
        std::function<void(const ServerHello&)> hello;
        /// A whole result has been applied.
        std::function<void(const Delta& last_piece, int64_t received_us)> result;
        /// Any piece, before it is applied.
        std::function<void(const Delta& piece)> piece;
        std::function<void(const Goodbye&, CloseCause)> closed;
    };

    /// `hello`: token, view and regions of it count; the rest is filled in.
    SeaClient(NetLoop& loop, Endpoint server, ClientHello hello, Events events);
    SeaClient(const SeaClient&) = delete;
    SeaClient& operator=(const SeaClient&) = delete;

    /// Dials; once.
    void open();
    void show(const ViewState& view);
    void send(const ClientMessage& message);
    void leave();

    bool live() const { return live_; }
    bool over() const { return over_; }
    const ClientStore& store() const { return store_; }
    uint32_t next_sequence() { return ++sequence_; }

private:
    void receive(ServerMessage message, int64_t received_us);
    void take(const Delta& delta, int64_t received_us);

    NetLoop& loop_;
    Endpoint server_;
    ClientHello hello_;
    Events events_;
    ClientStore store_;
    std::shared_ptr<Connection> connection_;
    std::optional<uint64_t> known_answer_;
    uint32_t sequence_ = 0;
    bool live_ = false;
    bool over_ = false;
};

}  // namespace trochoid
