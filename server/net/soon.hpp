#pragma once
#include <functional>
#include <memory>
#include <utility>

#include "server/net/io_loop.hpp"

namespace trochoid {

/// Calls back on the loop, never from inside the asking call. Destruction and `forget` drop what is pending.
class Soon {
public:
    explicit Soon(IoLoop& loop) : loop_(loop) {}

    void call(std::function<void()> task) {
        loop_.post([alive = std::weak_ptr<const bool>(alive_), task = std::move(task)] {
            if (!alive.expired()) task();
        });
    }
    void forget() { alive_ = std::make_shared<const bool>(true); }
    IoLoop& loop() const { return loop_; }

private:
    IoLoop& loop_;
    std::shared_ptr<const bool> alive_ = std::make_shared<const bool>(true);
};

}  // namespace trochoid
