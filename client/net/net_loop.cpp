#include "client/net/net_loop.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "client/net/net_loop_asio.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

int64_t client_monotonic_us() {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

NetLoop::NetLoop() : impl_(std::make_unique<Impl>()) {
    impl_->thread = std::thread([this] { impl_->io.run(); });
}

NetLoop::~NetLoop() { stop(); }

void NetLoop::stop() {
    impl_->io.stop();
    if (impl_->thread.joinable()) impl_->thread.join();
}

void NetLoop::post(std::function<void()> task) { boost::asio::post(impl_->io, std::move(task)); }

void NetLoop::after(std::chrono::milliseconds delay, std::function<void()> task) {
    post([this, delay, task = std::move(task)]() mutable {
        auto timer = std::make_shared<boost::asio::steady_timer>(impl_->io, delay);
        timer->async_wait([timer, task = std::move(task)](const boost::system::error_code& error) {
            if (!error) task();
        });
    });
}

void NetLoop::assert_here() const {
    TROCHOID_ASSERT(impl_->thread.get_id() == std::this_thread::get_id(), "called off the network thread");
}

}  // namespace trochoid
