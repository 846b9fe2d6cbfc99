#pragma once
#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

#include "client/net/connection.hpp"
#include "protocol/units/version.hpp"

namespace trochoid {

/// A connection whose events a test can wait for.
struct Dialler {
    std::mutex mutex;
    std::condition_variable news;
    bool connected = false;
    std::vector<ServerMessage> messages;
    int closed_count = 0;
    Goodbye goodbye;
    CloseCause cause = CloseCause::closed_here;
    NetLoop loop;
    std::shared_ptr<Connection> connection;

    explicit Dialler(const Endpoint& server) { connection = Connection::open(loop, server, events()); }
    Dialler(const Endpoint& server, std::shared_ptr<ClientStream> stream) {
        connection = Connection::open(loop, server, std::move(stream), events());
    }
    Dialler(const Dialler&) = delete;
    Dialler& operator=(const Dialler&) = delete;
    ~Dialler() { loop.stop(); }

    Connection::Events events() {
        const auto note = [this](auto change) {
            const std::lock_guard lock(mutex);
            change();
            news.notify_all();
        };
        return {
            [=, this] { note([this] { connected = true; }); },
            [=, this](ServerMessage m, int64_t) { note([this, &m] { messages.push_back(std::move(m)); }); },
            [=, this](const Goodbye& g, CloseCause c) {
                note([this, &g, c] {
                    ++closed_count;
                    goodbye = g;
                    cause = c;
                });
            }};
    }
    template <class Holds>
    bool wait(Holds holds, std::chrono::seconds patience = std::chrono::seconds(8)) {
        std::unique_lock lock(mutex);
        return news.wait_for(lock, patience, holds);
    }
    bool ends() {
        return wait([this] { return closed_count > 0; });
    }
    bool gets(size_t count) {
        return wait([this, count] { return messages.size() >= count; });
    }
    void send(ClientMessage message) {
        loop.post([this, message = std::move(message)] { connection->send(message); });
    }
    void leave() {
        loop.post([this] {
            Goodbye bye;
            bye.message = "done";
            connection->close(bye);
        });
    }
    bool says(const std::string& words) const { return goodbye.message.find(words) != std::string::npos; }
};

inline ClientHello usual_client_hello() {
    ClientHello h;
    h.protocol_min = protocol_version_min;
    h.protocol_max = protocol_version_max;
    h.model = model_version;
    h.software = "test";
    return h;
}

}  // namespace trochoid
