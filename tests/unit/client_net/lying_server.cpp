#include "tests/unit/client_net/lying_server.hpp"

#include <future>
#include <thread>

#include "server/net/listener.hpp"
#include "server/net/session_server.hpp"
#include "tests/unit/server_net/fake_sea.hpp"

namespace trochoid {

struct LyingServer::Impl {
    FakeSea sea;
    IoLoop loop;
    SessionServer sessions{loop, sea, Limits{}};
    Listener listener{loop, ListenAddresses{},
                      [this](std::unique_ptr<Transport> t) { sessions.accept(std::move(t)); }};
    std::thread thread;
    ServerStats stats() {
        std::promise<ServerStats> promise;
        loop.post([&] { promise.set_value(sessions.stats()); });
        return promise.get_future().get();
    }
};

LyingServer::LyingServer() : impl_(std::make_unique<Impl>()) {
    impl_->sea.lies = true;
    impl_->thread = std::thread([this] { impl_->loop.run(); });
}

LyingServer::~LyingServer() {
    impl_->loop.post([this] { impl_->loop.stop(); });
    impl_->thread.join();
}

uint16_t LyingServer::port() const { return impl_->listener.port(); }
uint64_t LyingServer::right_hash() const { return hash_of(impl_->sea.state_for(ViewState{})); }
uint64_t LyingServer::desyncs_of_trains() { return impl_->stats().desyncs[PartKind::train]; }
uint64_t LyingServer::resyncs() { return impl_->stats().resyncs; }

}  // namespace trochoid
