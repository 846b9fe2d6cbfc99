#pragma once
#include <memory>

#include "tests/conformance/stream.hpp"

namespace trochoid::conformance {

/// Where clients under test connect to: a port of the loopback interface.
class Listener {
public:
    /// 0: any free port. OperatorError where it is taken.
    explicit Listener(uint16_t port);
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;
    ~Listener();

    const Endpoint& address() const { return address_; }
    /// Null where nobody comes in time.
    std::unique_ptr<Stream> accept(Milliseconds within) const;

private:
    Endpoint address_;
    int socket_ = -1;
};

}  // namespace trochoid::conformance
