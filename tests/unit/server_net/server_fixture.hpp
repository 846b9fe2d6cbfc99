#pragma once
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <thread>

#include "server/net/listener.hpp"
#include "server/net/session_server.hpp"
#include "tests/support/net/raw_client.hpp"
#include "tests/unit/server_net/fake_sea.hpp"

namespace trochoid {

/// A server on a free loopback port with its io thread, over a FakeSea.
class ServerFixture : public testing::Test {
protected:
    /// Called by tests after they have set `limits` and `sea`.
    void start() {
        sessions = std::make_unique<SessionServer>(loop, sea, limits, logins_per_second);
        listener = std::make_unique<Listener>(loop, ListenAddresses{}, [this](std::unique_ptr<Transport> t) {
            sessions->accept(std::move(t));
        });
        thread = std::thread([this] { loop.run(); });
    }
    void TearDown() override {
        if (!thread.joinable()) return;
        loop.post([this] { loop.stop(); });
        thread.join();
    }
    uint16_t port() const { return listener->port(); }
    /// Runs on the io thread and waits for the value.
    template <class F>
    auto on_loop(F f) {
        std::promise<decltype(f())> promise;
        loop.post([&] { promise.set_value(f()); });
        return promise.get_future().get();
    }
    ServerStats stats() {
        return on_loop([this] { return sessions->stats(); });
    }
    /// Whether so many sessions have ended with the code, at the latest once a parting one's patience is over.
    bool ended_with(ErrorCode code, uint64_t count) {
        for (int i = 0; i < 400; ++i) {
            if (stats().ended[code] == count) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return false;
    }
    void change_sea() {
        ++sea.revision;
        loop.post([this] { sessions->sea_changed(); });
    }

    Limits limits;
    uint32_t logins_per_second = 0;
    FakeSea sea;
    IoLoop loop;
    std::unique_ptr<SessionServer> sessions;
    std::unique_ptr<Listener> listener;
    std::thread thread;
};

}  // namespace trochoid
