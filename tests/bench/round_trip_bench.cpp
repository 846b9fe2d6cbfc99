// P6: from the TCP connection to every patch of the first view, raw, inside TLS 1.3 and as a WebSocket inside TLS, over delays
// that a proxy makes, with TCP's slow start (ten segments at first) as on a real way, which loopback has not.
#include <future>
#include <thread>
#include <vector>

#include "tests/bench/report.hpp"
#include "tests/bench/stopwatch.hpp"
#include "tests/bench/wire_sea.hpp"
#include "tests/support/net/chaos_proxy.hpp"
#include "tests/support/net/sea_client.hpp"
#include "tests/support/net/server_process.hpp"
#include "tests/support/net/test_certificate.hpp"

namespace trochoid::bench {
namespace {

constexpr uint32_t ten_segments = 14'600;
constexpr double allowed_besides_ms = 50.0;

struct FirstView {
    double ms = 0.0;
    size_t patches = 0;
    uint64_t bytes = 0;
};

/// `accepted_us`: when the proxy had the connection, on the monotonic clock; what a client does before its first byte (TLS, the
/// upgrade to a WebSocket) counts.
FirstView first_view(const Endpoint& server, const ViewState& view, const ChaosProxy& proxy) {
    NetLoop loop;
    std::promise<FirstView> done;
    ClientHello hello;
    hello.view = view;
    std::unique_ptr<SeaClient> client;
    SeaClient::Events events;
    bool told = false;
    int64_t whole_us = 0;
    events.result = [&](const Delta&, int64_t) {
        if (std::exchange(told, true)) return;
        whole_us = client_monotonic_us();
        FirstView found;
        found.patches = client->store().snapshot()->interest->patches.size();
        done.set_value(found);
    };
    events.closed = [&](const Goodbye& goodbye, CloseCause) {
        if (!std::exchange(told, true))
            done.set_exception(
                std::make_exception_ptr(OperatorError("the session ended: " + goodbye.message)));
    };
    client = std::make_unique<SeaClient>(loop, server, hello, events);
    loop.post([&] { client->open(); });
    FirstView found = done.get_future().get();
    const ProxiedConnection last = proxy.connections().back();
    found.ms = static_cast<double>(whole_us - last.accepted_us) * 1e-3;
    found.bytes = last.bytes_down;
    std::promise<void> left;
    loop.post([&] {
        client->leave();
        left.set_value();
    });
    left.get_future().wait();
    loop.stop();
    return found;
}

struct Way {
    const char* name;
    const char* scheme;
    int round_trips;
};

void measure(Report& report) {
    const int runs = report.quick() ? 3 : 15;
    const CertificateAndKey certificate = self_signed();
    const PemFile cert(certificate.certificate);
    const PemFile key(certificate.key);
    const ServerProcess server(open_water_scene(),
                               {"--log-level", "warn", "--tls-cert", cert.path(), "--tls-key", key.path()});
    const ViewState view = sea_camera(0, 0, 0);
    fmt::print("{:>6} {:>8} {:>10} {:>10} {:>8} {:>12} {:>8} {:>8}\n", "way", "RTT ms", "median ms",
               "worst ms", "bar ms", "round trips", "patches", "bytes");
    std::string words;
    for (const Way& way : {Way{"raw", "tcp", 2}, Way{"TLS", "tls", 3}, Way{"wss", "wss", 4}})
        for (const int rtt_ms : {0, 50, 200}) {
            ChaosSchedule schedule;
            schedule.always.up.delay_us = schedule.always.down.delay_us = rtt_ms * 500;
            schedule.always.up.first_window = schedule.always.down.first_window = ten_segments;
            ChaosProxy proxy(server.port(), schedule);
            Endpoint endpoint = parse_endpoint(fmt::format("{}://127.0.0.1:{}", way.scheme, proxy.port()));
            if (is_encrypted(endpoint.transport)) endpoint.ca_file = cert.path();
            first_view(endpoint, view, proxy);
            std::vector<double> times;
            times.reserve(static_cast<size_t>(runs));
            FirstView one;
            for (int i = 0; i < runs; ++i) times.push_back((one = first_view(endpoint, view, proxy)).ms);
            const double middle = median(times);
            const double bar = way.round_trips * rtt_ms + allowed_besides_ms;
            fmt::print("{:>6} {:>8} {:>10.1f} {:>10.1f} {:>8.0f} {:>12.2f} {:>8} {:>8}\n", way.name, rtt_ms,
                       middle, *std::max_element(times.begin(), times.end()), bar,
                       rtt_ms == 0 ? 0.0 : middle / rtt_ms, one.patches, one.bytes);
            report.at_most(fmt::format("{}, round trip {} ms", way.name, rtt_ms), middle, bar, " ms");
            report.at_least(fmt::format("{}, patches at {} ms", way.name, rtt_ms),
                            static_cast<double>(one.patches), 400);
            report.figure(fmt::format("{}_{}_ms", way.name, rtt_ms), middle);
            if (rtt_ms == 200)
                words += fmt::format("{}{} {:.0f} ms", words.empty() ? "" : ", ", way.name, middle);
        }
    report.write(words + " at a round trip of 200 ms");
}

}  // namespace
}  // namespace trochoid::bench

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, trochoid::bench::measure); }
