#include "tests/conformance/mutants/relay.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>
#include <thread>
#include <utility>

#include "protocol/units/operator_error.hpp"
#include "tests/conformance/mutants/frame_cutter.hpp"

namespace trochoid::conformance::mutants {

namespace {

/// A socket that closes itself.
class Socket {
public:
    explicit Socket(int number) : number_(number) {}
    Socket(Socket&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Socket(const Socket&) = delete;
    Socket& operator=(const Socket&) = delete;
    Socket& operator=(Socket&&) = delete;
    ~Socket() {
        if (number_ >= 0) close(number_);
    }
    int number() const { return number_; }

    void send_at_once() const {
        const int yes = 1;
        setsockopt(number_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
        // An end that does not read for so long is given up: its writer would wait for ever.
        const timeval patience{10, 0};
        setsockopt(number_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    }
    void write(std::span<const uint8_t> bytes) const {
        while (!bytes.empty()) {
            const ssize_t count = send(number_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
            if (count > 0)
                bytes = bytes.subspan(static_cast<size_t>(count));
            else if (errno != EINTR)
                return;
        }
    }
    void finish() const { shutdown(number_, SHUT_WR); }
    /// A reset instead of an end.
    void reset_at_close() const {
        const linger at_once{1, 0};
        setsockopt(number_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    }

private:
    int number_;
};

sockaddr_in loopback(uint16_t port) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(port);
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return place;
}

class Connection final : public Link {
public:
    Connection(Socket client, Socket server, std::unique_ptr<Spoiler> spoiler)
        : client_(std::move(client)), server_(std::move(server)), spoiler_(std::move(spoiler)) {
        client_.send_at_once();
        server_.send_at_once();
        obey(Limits{});
    }

    void bytes_to_server(std::span<const uint8_t> bytes) override { server_.write(bytes); }
    void bytes_to_client(std::span<const uint8_t> bytes) override { client_.write(bytes); }
    void end_server() override { server_.finish(); }
    void end_client() override { client_.finish(); }
    void reset_client() override {
        client_.reset_at_close();
        reset_ = true;
    }

    /// Until both streams have ended, or the client's has and nobody minds.
    void run() {
        std::array<pollfd, 2> both{pollfd{client_.number(), POLLIN, 0}, pollfd{server_.number(), POLLIN, 0}};
        while (both[0].fd >= 0 || both[1].fd >= 0) {
            constexpr int half_a_minute_ms = 30'000;
            const bool half = both[0].fd < 0 || both[1].fd < 0;
            const int count = poll(both.data(), both.size(), half ? half_a_minute_ms : -1);
            if (count == 0 || (count < 0 && errno != EINTR)) return;
            if (both[0].revents != 0 && !pump_client()) both[0].fd = -1;
            if (both[1].fd >= 0 && both[1].revents != 0 && !pump_server()) both[1].fd = -1;
            if (reset_) return;
            both[0].revents = both[1].revents = 0;
        }
    }

private:
    /// Hears the limits of the hello before it goes on.
    class Listening final : public Spoiler {
    public:
        explicit Listening(Connection& connection) : on_(connection), next_(*connection.spoiler_) {}
        void opening(std::span<const uint8_t> magic, Link& link) override { next_.opening(magic, link); }
        void from_client(Bytes payload, Link& link) override { next_.from_client(std::move(payload), link); }
        void from_server(Bytes payload, Link& link) override {
            if (!heard_) {
                const auto message = decode_server(payload);
                const auto* hello = message ? std::get_if<ServerHello>(&*message) : nullptr;
                if (hello != nullptr) on_.obey(hello->limits);
                heard_ = hello != nullptr;
            }
            next_.from_server(std::move(payload), link);
        }
        HeaderFate bad_header(uint32_t length, uint32_t word) override {
            return next_.bad_header(length, word);
        }
        void other_from_client(Bytes bytes, Link& link) override {
            next_.other_from_client(std::move(bytes), link);
        }
        void other_from_server(Bytes bytes, Link& link) override {
            next_.other_from_server(std::move(bytes), link);
        }

    private:
        Connection& on_;
        Spoiler& next_;
        bool heard_ = false;
    };

    void obey(const Limits& limits) {
        client_cutter_.set_longest(limits.frame_before_login, limits.frame_after_login);
        server_cutter_.set_longest(limits.frame_to_client, limits.frame_to_client);
    }

    /// False where nothing more will come from there.
    bool pump_client() {
        const ssize_t count = recv(client_.number(), chunk_.data(), chunk_.size(), 0);
        if (count > 0) {
            client_cutter_.take(std::span(chunk_).first(static_cast<size_t>(count)));
            if (client_cutter_.is_other()) server_cutter_.take_as_other();
            return true;
        }
        if (count < 0) {
            server_.reset_at_close();
            reset_ = true;
            return false;
        }
        client_cutter_.end();
        spoiler_->client_ended(*this);
        return false;
    }
    bool pump_server() {
        const ssize_t count = recv(server_.number(), chunk_.data(), chunk_.size(), 0);
        if (count > 0) {
            server_cutter_.take(std::span(chunk_).first(static_cast<size_t>(count)));
            return true;
        }
        server_cutter_.end();
        if (count < 0)
            spoiler_->server_reset(*this);
        else
            spoiler_->server_ended(*this);
        return false;
    }

    Socket client_;
    Socket server_;
    std::unique_ptr<Spoiler> spoiler_;
    Listening listening_{*this};
    FrameCutter client_cutter_{FrameCutter::From::client, listening_, *this};
    FrameCutter server_cutter_{FrameCutter::From::server, listening_, *this};
    std::array<uint8_t, 65536> chunk_{};
    bool reset_ = false;
};

void carry(Socket client, const Endpoint& to, const MakeSpoiler& make) {
    Socket server(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const sockaddr_in place = loopback(to.port);
    if (connect(server.number(), reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0) {
        client.reset_at_close();
        return;
    }
    const auto connection = std::make_unique<Connection>(std::move(client), std::move(server), make());
    connection->run();
}

}  // namespace

void relay(const Endpoint& to, const MakeSpoiler& make, const std::string& port_file,
           const std::function<void(uint16_t port)>& ready) {
    const Socket gate(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in place = loopback(0);
    socklen_t size = sizeof place;
    auto* generic = reinterpret_cast<sockaddr*>(&place);
    constexpr int backlog = 128;
    if (gate.number() < 0 || bind(gate.number(), generic, size) != 0 || listen(gate.number(), backlog) != 0 ||
        getsockname(gate.number(), generic, &size) != 0)
        throw OperatorError(fmt::format("cannot listen on the loopback interface: {}",
                                        std::generic_category().message(errno)));
    const uint16_t port = ntohs(place.sin_port);
    if (!port_file.empty()) {
        std::ofstream file(port_file);
        file << port << '\n';
        file.close();
        if (!file) throw OperatorError(fmt::format("cannot write {}: check --port-file", port_file));
    }
    ready(port);
    while (true) {
        Socket client(accept4(gate.number(), nullptr, nullptr, SOCK_CLOEXEC));
        if (client.number() < 0) continue;
        std::thread([&to, &make, peer = std::move(client)]() mutable {
            carry(std::move(peer), to, make);
        }).detach();
    }
}

}  // namespace trochoid::conformance::mutants
