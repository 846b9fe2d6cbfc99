#include "tests/support/net/hostile_peers.hpp"

#include <fmt/format.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <future>
#include <thread>
#include <utility>

#include "protocol/codec/codec.hpp"
#include "protocol/units/hash.hpp"
#include "protocol/units/version.hpp"
#include "protocol/wire/frame.hpp"
#include "tests/support/net/server_process.hpp"

namespace trochoid {

namespace {

namespace asio = boost::asio;
using Tcp = asio::ip::tcp;
using Failed = boost::system::error_code;
using std::chrono::milliseconds;

constexpr milliseconds slow_pause{300};
constexpr int peers_an_address = 8;

Bytes noise(size_t count, uint64_t seed) {
    Bytes bytes(count);
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(seed = splitmix64(seed));
    return bytes;
}

void append(Bytes& bytes, const Bytes& more) { bytes.insert(bytes.end(), more.begin(), more.end()); }

Bytes opening(const std::string& token, size_t padding = 0) {
    ClientHello hello;
    hello.protocol_min = protocol_version_min;
    hello.protocol_max = protocol_version_max;
    hello.model = model_version;
    hello.software = "hostile" + std::string(padding, '.');
    hello.token = token;
    hello.view.altitude = 20 * 1024;
    Bytes bytes(stream_magic.begin(), stream_magic.end());
    append(bytes, frame(encode(ClientMessage(hello))));
    return bytes;
}

/// Twenty messages in a row.
template <class Make>
Bytes salvo(uint32_t& sequence, Make make) {
    Bytes bytes;
    for (int i = 0; i < 20; ++i) append(bytes, frame(encode(ClientMessage(make(++sequence)))));
    return bytes;
}

}  // namespace

struct HostilePeers::Impl {
    /// One peer; reconnects until the thread ends.
    struct Peer {
        Peer(Impl& all, Group g, int n)
            : impl(all), group(std::move(g)), number(n), socket(all.io), timer(all.io) {}
        Impl& impl;
        Group group;
        int number;
        Tcp::socket socket;
        asio::steady_timer timer;
        std::array<uint8_t, 4096> chunk{};
        FrameReader frames{FrameReader::Opening::frames, 1U << 20};
        Bytes sending;
        size_t sent = 0;
        uint32_t sequence = 0;
        uint32_t stand = 0;  // handlers of an earlier connection know by it that they are late
        bool standing = false;
        bool goodbye = false;

        void dial() {
            Failed ignored;
            const uint32_t now = ++stand;
            socket = Tcp::socket(impl.io);
            socket.open(Tcp::v4(), ignored);
            const int address = 2 + number / peers_an_address;
            socket.bind(
                {asio::ip::make_address_v4(fmt::format("127.0.{}.{}", 1 + address / 250, 1 + address % 250)),
                 0},
                ignored);
            frames = FrameReader(FrameReader::Opening::frames, 1U << 20);
            goodbye = false;
            sequence = 0;
            socket.async_connect({asio::ip::address_v4::loopback(), impl.port}, [this, now](Failed failed) {
                if (now != stand) return;
                if (failed) return again();
                ++impl.counts.connections;
                standing = true;
                start();
            });
        }
        void again() {
            Failed ignored;
            const uint32_t now = ++stand;
            if (standing && !goodbye) ++impl.counts.without_a_word;
            standing = false;
            socket.close(ignored);
            timer.expires_after(milliseconds(1));
            timer.async_wait([this, now](Failed failed) {
                if (!failed && now == stand) dial();
            });
        }
        void start() {
            if (group.hostility == Hostility::hang_up) {
                goodbye = true;  // it asked for none
                return again();
            }
            if (group.hostility != Hostility::question_flood) read();
            sending = first();
            sent = 0;
            if (!sending.empty()) write();
        }
        Bytes first() const {
            switch (group.hostility) {
                case Hostility::slow_hello: return opening({});
                case Hostility::magic_alone: return {stream_magic.begin(), stream_magic.end()};
                case Hostility::half_hello: {
                    Bytes all = opening({}, 3600);
                    all.pop_back();
                    return all;
                }
                case Hostility::view_flood:
                case Hostility::command_flood:
                case Hostility::question_flood: return opening(group.token);
                case Hostility::garbage:
                    return noise(65536, static_cast<uint64_t>(number) + impl.counts.connections);
                case Hostility::oversize: {
                    Bytes bytes(stream_magic.begin(), stream_magic.end());
                    append(bytes, {0, 0, 0, 0x40, 0, 0, 0, 0});
                    append(bytes, noise(65536, 7));
                    return bytes;
                }
                case Hostility::bad_token: return opening(group.token);
                case Hostility::silence:
                case Hostility::hang_up: break;
            }
            return {};
        }
        Bytes next() {
            ViewState view;
            view.altitude = 20 * 1024;
            switch (group.hostility) {
                case Hostility::view_flood:
                    return salvo(sequence, [&](uint32_t n) {
                        view.position.x = int64_t{n} * 65536;
                        return ViewUpdate{n, view};
                    });
                case Hostility::command_flood:
                    return salvo(sequence, [](uint32_t n) {
                        Command command;
                        command.sequence = n;
                        command.action = StopWind{{1}};
                        return command;
                    });
                case Hostility::question_flood:
                    return salvo(sequence, [](uint32_t n) {
                        Command command;
                        command.sequence = n;
                        command.action = ListBoxes{};
                        return command;
                    });
                default: return {};
            }
        }
        void write() {
            const uint32_t now = stand;
            const size_t count =
                group.hostility == Hostility::slow_hello ? 1 : std::min<size_t>(sending.size() - sent, 16384);
            asio::async_write(
                socket, asio::buffer(sending.data() + sent, count), [this, now](Failed failed, size_t done) {
                    if (now != stand) return;
                    impl.counts.bytes_sent += done;
                    // What could not be sent may still have been answered by a goodbye.
                    if (failed) {
                        if (group.hostility == Hostility::question_flood) again();
                        return;
                    }
                    sent += done;
                    if (sent < sending.size())
                        return group.hostility == Hostility::slow_hello ? write_later() : write();
                    sending = next();
                    sent = 0;
                    if (!sending.empty()) write();
                });
        }
        void write_later() {
            const uint32_t now = stand;
            timer.expires_after(slow_pause);
            timer.async_wait([this, now](Failed failed) {
                if (!failed && now == stand) write();
            });
        }
        void read() {
            const uint32_t now = stand;
            socket.async_read_some(asio::buffer(chunk), [this, now](Failed failed, size_t count) {
                if (now != stand) return;
                if (failed) return again();
                take(std::span<const uint8_t>(chunk).first(count));
                read();
            });
        }
        void take(std::span<const uint8_t> input) {
            while (true) {
                const auto payload = frames.next(input);
                if (!payload || !*payload) return;
                const auto message = decode_server(**payload);
                if (!message) return;
                if (const auto* said = std::get_if<Goodbye>(&*message)) {
                    goodbye = true;
                    ++impl.counts.goodbyes[said->code];
                }
            }
        }
    };

    Impl(uint16_t p, const std::vector<Group>& groups) : port(p) {
        int number = 0;
        for (const Group& group : groups)
            for (int i = 0; i < group.peers; ++i)
                peers.push_back(std::make_unique<Peer>(*this, group, number++));
        for (const auto& peer : peers) asio::post(io, [p = peer.get()] { p->dial(); });
        thread = std::thread([this] {
            give_way_to_others();
            const auto work = asio::make_work_guard(io);
            io.run();
        });
    }
    template <class F>
    auto here(F f) {
        std::promise<decltype(f())> promise;
        asio::post(io, [&] { promise.set_value(f()); });
        return promise.get_future().get();
    }

    asio::io_context io{1};
    uint16_t port;
    HostileCounts counts;
    std::vector<std::unique_ptr<Peer>> peers;
    std::thread thread;
};

HostilePeers::HostilePeers(uint16_t port, const std::vector<Group>& groups)
    : impl_(std::make_unique<Impl>(port, groups)) {}

HostilePeers::~HostilePeers() {
    asio::post(impl_->io, [this] { impl_->io.stop(); });
    impl_->thread.join();
}

HostileCounts HostilePeers::counts() const {
    return impl_->here([this] { return impl_->counts; });
}

int HostilePeers::standing() const {
    return impl_->here([this] {
        int count = 0;
        for (const auto& peer : impl_->peers) count += peer->standing ? 1 : 0;
        return count;
    });
}

}  // namespace trochoid
