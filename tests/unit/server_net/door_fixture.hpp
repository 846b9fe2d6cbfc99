#pragma once
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <string>
#include <thread>

#include "server/net/front_door.hpp"
#include "server/net/listener.hpp"
#include "tests/support/net/byte_pipe.hpp"
#include "tests/support/net/form_client.hpp"
#include "tests/support/net/test_certificate.hpp"
#include "tests/unit/server_net/fake_sea.hpp"

namespace trochoid {

/// A connection that says it comes from elsewhere.
class FarTransport final : public Transport {
public:
    FarTransport(std::unique_ptr<Transport> inner, std::string peer)
        : inner_(std::move(inner)), peer_(std::move(peer)) {}
    const std::string& peer() const override { return peer_; }
    void when_readable(std::function<void()> ready) override { inner_->when_readable(std::move(ready)); }
    void when_writable(std::function<void()> ready) override { inner_->when_writable(std::move(ready)); }
    Moved read(std::span<uint8_t> into) override { return inner_->read(into); }
    Moved write(std::span<const uint8_t> bytes) override { return inner_->write(bytes); }
    void finish(ErrorCode why) override { inner_->finish(why); }
    void close() override { inner_->close(); }

private:
    std::unique_ptr<Transport> inner_;
    std::string peer_;
};

/// What the server reads in one go, before others get their turn.
struct ReadCounts {
    std::atomic<uint64_t> most_reads = 0;  ///< reads of the socket
    std::atomic<uint64_t> most_bytes = 0;
    std::atomic<uint64_t> reads = 0;  ///< in all
    std::atomic<uint64_t> bytes = 0;  ///< in all
};

/// Counts them.
class CountedTransport final : public Transport {
public:
    CountedTransport(std::unique_ptr<Transport> inner, ReadCounts& counts)
        : inner_(std::move(inner)), counts_(counts) {}
    const std::string& peer() const override { return inner_->peer(); }
    void when_readable(std::function<void()> ready) override {
        inner_->when_readable([turn = turn_, ready = std::move(ready)] {
            *turn = {};
            ready();
        });
    }
    void when_writable(std::function<void()> ready) override { inner_->when_writable(std::move(ready)); }
    Moved read(std::span<uint8_t> into) override {
        const Moved moved = inner_->read(into);
        ++counts_.reads;
        counts_.bytes += moved.bytes;
        ++turn_->reads;
        turn_->bytes += moved.bytes;
        if (turn_->reads > counts_.most_reads) counts_.most_reads = turn_->reads;
        if (turn_->bytes > counts_.most_bytes) counts_.most_bytes = turn_->bytes;
        return moved;
    }
    Moved write(std::span<const uint8_t> bytes) override { return inner_->write(bytes); }
    void finish(ErrorCode why) override { inner_->finish(why); }
    void close() override { inner_->close(); }

private:
    std::unique_ptr<Transport> inner_;
    struct Turn {
        uint64_t reads = 0;
        uint64_t bytes = 0;
    };
    ReadCounts& counts_;
    std::shared_ptr<Turn> turn_ = std::make_shared<Turn>();
};

/// A file that lasts as long as this.
class ScratchFile {
public:
    explicit ScratchFile(const std::string& text = "") {
        static int number = 0;
        path =
            std::filesystem::temp_directory_path() /
            ("trochoid-door-" + std::to_string(std::chrono::steady_clock::now().time_since_epoch().count()) +
             "-" + std::to_string(++number));
        write(text);
    }
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;
    ~ScratchFile() {
        std::error_code ignored;
        std::filesystem::remove(path, ignored);
    }
    void write(const std::string& text) const { std::ofstream(path) << text; }
    std::filesystem::path path;
};

/// The real door, sessions and loop on a free loopback port, over a FakeSea.
class DoorFixture : public testing::Test {
protected:
    /// Called by tests after they have set what they want otherwise.
    void start() {
        if (with_tls) {
            const CertificateAndKey pair = authority.issue();
            certificate.write(pair.certificate);
            key.write(pair.key);
            identity = std::make_unique<TlsIdentity>(certificate.path, key.path);
        }
        sessions = std::make_unique<SessionServer>(loop, sea, limits);
        front = std::make_unique<FrontDoor>(loop, *sessions, limits, policy, identity.get(), world);
        if (ready) front->set_ready();
        listener = std::make_unique<Listener>(loop, ListenAddresses{}, [this](std::unique_ptr<Transport> t) {
            if (!far_peer.empty()) t = std::make_unique<FarTransport>(std::move(t), far_peer);
            if (counts) t = std::make_unique<CountedTransport>(std::move(t), *counts);
            front->accept(std::move(t));
        });
        thread = std::thread([this] { loop.run(); });
    }
    void TearDown() override {
        if (!thread.joinable()) return;
        loop.post([this] { loop.stop(); });
        thread.join();
    }
    uint16_t port() const { return listener->port(); }
    template <class F>
    auto on_loop(F f) {
        std::promise<decltype(f())> promise;
        loop.post([&] { promise.set_value(f()); });
        return promise.get_future().get();
    }
    ServerStats stats() {
        return on_loop([this] { return sessions->stats(); });
    }
    DoorStats door() {
        return on_loop([this] { return front->stats(); });
    }
    template <class Condition>
    static bool eventually(Condition condition) {
        for (int i = 0; i < 500; ++i) {
            if (condition()) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return false;
    }
    /// Whether so many connections have ended with the code, soon.
    bool ended_with(ErrorCode code, uint64_t count = 1) {
        return eventually([&] { return stats().ended[code] == count; });
    }
    /// The whole answer to a request for a target, in the clear.
    std::string get(const std::string& target, const std::string& method = "GET") {
        const auto pipe = connect_tcp(port());
        pipe->write(method + " " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
        return pipe->read_all();
    }
    std::string say(const std::string& text) {
        const auto pipe = connect_tcp(port());
        pipe->write(text);
        return pipe->read_all();
    }
    /// The code of the goodbye that a client is given; none where there is no goodbye.
    static ErrorCode goodbye_to(FormClient& client) {
        const auto goodbye = client.wait_for<Goodbye>();
        return goodbye ? goodbye->code : ErrorCode::none;
    }
    static std::string body_of(const std::string& answer) {
        const size_t end = answer.find("\r\n\r\n");
        return end == std::string::npos ? "" : answer.substr(end + 4);
    }
    static unsigned status_of(const std::string& answer) {
        return answer.starts_with("HTTP/1.1 ") ? static_cast<unsigned>(std::stoul(answer.substr(9, 3))) : 0;
    }

    bool with_tls = true;
    bool ready = true;
    std::string far_peer;
    std::string world = "fake";
    ReadCounts* counts = nullptr;  // what connections made from now on are counted in
    DoorPolicy policy;
    Limits limits;
    FakeSea sea;
    TestAuthority authority;
    ScratchFile certificate;
    ScratchFile key;
    IoLoop loop;
    std::unique_ptr<TlsIdentity> identity;
    std::unique_ptr<SessionServer> sessions;
    std::unique_ptr<FrontDoor> front;
    std::unique_ptr<Listener> listener;
    std::thread thread;
};

}  // namespace trochoid
