#include "tests/conformance/listener.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "protocol/units/operator_error.hpp"
#include "tests/conformance/framed_stream.hpp"

namespace trochoid::conformance {

namespace {

/// Whether the socket can do what is asked before the time is over.
bool ready(int socket, short what, Milliseconds within) {
    pollfd wanted{socket, what, 0};
    const Deadline deadline(within);
    while (true) {
        const int count = poll(&wanted, 1, static_cast<int>(deadline.left().count()));
        if (count > 0) return true;
        if (count == 0 || errno != EINTR) return false;
    }
}

/// The stream of a client that has come.
class AcceptedStream final : public Stream {
public:
    explicit AcceptedStream(int socket) : socket_(socket) {}
    ~AcceptedStream() override { close(socket_); }

    bool write(std::span<const uint8_t> bytes) override {
        constexpr Milliseconds patience{5000};
        const Deadline deadline(patience);
        while (!bytes.empty()) {
            if (state_ == State::reset || !ready(socket_, POLLOUT, deadline.left())) return false;
            const ssize_t count = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
            if (count > 0)
                bytes = bytes.subspan(static_cast<size_t>(count));
            else if (errno != EAGAIN && errno != EINTR)
                return false;
        }
        return true;
    }

    size_t read(std::span<uint8_t> into, Milliseconds within) override {
        if (state_ != State::open || !ready(socket_, POLLIN, within)) return 0;
        const ssize_t count = recv(socket_, into.data(), into.size(), MSG_DONTWAIT);
        if (count > 0) return static_cast<size_t>(count);
        if (count == 0)
            state_ = State::ended;
        else if (errno != EAGAIN && errno != EINTR)
            state_ = State::reset;
        return 0;
    }

    State state() const override { return state_; }
    void finish() override { shutdown(socket_, SHUT_WR); }
    void abort() override {
        const linger at_once{1, 0};
        setsockopt(socket_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
        shutdown(socket_, SHUT_RDWR);
        state_ = State::reset;
    }

private:
    int socket_;
    State state_ = State::open;
};

}  // namespace

Listener::Listener(uint16_t port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const int yes = 1;
    setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    place.sin_port = htons(port);
    socklen_t size = sizeof place;
    auto* generic = reinterpret_cast<sockaddr*>(&place);
    constexpr int backlog = 16;
    if (socket_ < 0 || bind(socket_, generic, size) != 0 || ::listen(socket_, backlog) != 0 ||
        getsockname(socket_, generic, &size) != 0) {
        const int why = errno;
        if (socket_ >= 0) close(socket_);
        throw OperatorError(fmt::format("cannot listen at 127.0.0.1:{}: {}: check --listen", port,
                                        std::generic_category().message(why)));
    }
    address_.port = ntohs(place.sin_port);
}

Listener::~Listener() { close(socket_); }

std::unique_ptr<Stream> Listener::accept(Milliseconds within) const {
    if (!ready(socket_, POLLIN, within)) return nullptr;
    const int client = accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client < 0) return nullptr;
    const int yes = 1;
    setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    return std::make_unique<AcceptedStream>(client);
}

}  // namespace trochoid::conformance
