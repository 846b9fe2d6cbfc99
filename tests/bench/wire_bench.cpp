// P5: what a client costs on the wire. Real server, real client, TCP without TLS; a proxy in between that only keeps segments
// to those of an Ethernet, so that the kernel counts them as they would travel.
#include <thread>
#include <vector>

#include "client/app/ocean_session.hpp"
#include "client/net/blocking_link.hpp"
#include "protocol/codec/codec.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/stopwatch.hpp"
#include "tests/bench/wire_sea.hpp"
#include "tests/support/net/chaos_proxy.hpp"
#include "tests/support/net/server_process.hpp"
#include "tests/support/net/tcp_counts.hpp"

namespace trochoid::bench {
namespace {

using Seconds = std::chrono::duration<double>;
using SteadyTime = std::chrono::steady_clock::time_point;

constexpr double warm_up_s = 10.0;
constexpr double field_bits_per_second = 256.0 * 256.0 * 32.0 * 20.0;

/// A session through a proxy of its own: what the kernel counts for the proxy's port is the session's.
struct MeteredSession {
    MeteredSession(uint16_t port, const ViewState& view) : proxy(port, {}) {
        SessionOptions options;
        options.server = {"127.0.0.1", proxy.port()};
        options.software = "bench";
        options.view = view;
        session = std::make_unique<OceanSession>(options);
        const bool came =
            session->wait_until([this] { return session->snapshot()->result > 0; }, std::chrono::seconds(20));
        if (!came) throw OperatorError("the server sends no sea: " + session->statistics().sentence);
    }
    TcpCounts counts() const { return counts_of_connections_to(proxy.port()); }
    size_t patches() const { return session->snapshot()->interest->patches.size(); }

    ChaosProxy proxy;
    std::unique_ptr<OceanSession> session;
};

void sleep_until(SteadyTime begin, double seconds) {
    std::this_thread::sleep_until(
        begin + std::chrono::duration_cast<std::chrono::steady_clock::duration>(Seconds(seconds)));
}

double kbit(uint64_t bytes, double seconds = 1.0) { return static_cast<double>(bytes) * 0.008 / seconds; }

double percentile(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values[std::min(values.size() - 1,
                           static_cast<size_t>(share * static_cast<double>(values.size())))];
}

/// kbit/s in each second of a flight at 30 m/s with the camera turning by 60 degrees to either side.
struct Flight {
    std::vector<double> windows;
    std::vector<double> patches;
    uint64_t views = 0;
    uint64_t results = 0;
};

Flight fly(MeteredSession& client, double seconds, bool turns) {
    Flight flight;
    const SteadyTime begin = std::chrono::steady_clock::now();
    const SessionStatistics before = client.session->statistics();
    TcpCounts last = client.counts();
    constexpr int steps_a_second = 30;
    for (int i = 1; i <= static_cast<int>(seconds * steps_a_second); ++i) {
        const double t = static_cast<double>(i) / steps_a_second;
        const double heading = turns ? 60.0 * std::sin(t * 2.0 * 3.14159265358979 / 10.0) : 0.0;
        ViewState view = sea_camera(0.0, -30.0 * t, heading);
        view.vz = -30.0F;
        client.session->set_view(view);
        sleep_until(begin, t);
        if (i % steps_a_second != 0) continue;
        const TcpCounts now = client.counts();
        flight.windows.push_back(kbit(now.on_the_wire() - last.on_the_wire()));
        flight.patches.push_back(static_cast<double>(client.patches()));
        last = now;
    }
    const SessionStatistics after = client.session->statistics();
    flight.views = after.views_sent - before.views_sent;
    flight.results = after.store.results - before.store.results;
    return flight;
}

StartWind storm(uint16_t trains) {
    StartWind wind;
    wind.speed = 25.0F;
    wind.towards_degrees = 80.0F;
    wind.origin = {to_lattice(-300.0), to_lattice(0.0)};
    wind.fetch = to_lattice(400000.0);
    wind.width = to_lattice(300000.0);
    wind.trains = trains;
    wind.seed = 77;
    return wind;
}

void direct(uint16_t port, const std::string& world, const StartWind& wind) {
    BlockingLink director({{"127.0.0.1", port}, "bench director", ServerProcess::director_token(world)});
    Command command;
    command.action = wind;
    const CommandReply reply = director.command(command);
    if (reply.code != ErrorCode::none) throw OperatorError("the storm was refused: " + reply.message);
}

/// Bytes on the wire, to this client, from just before the storm until it has long been told: `quiet_s` after it has come.
uint64_t bytes_of_storm(MeteredSession& client, uint16_t port, const std::string& world,
                        const StartWind& wind, double quiet_s) {
    const size_t boxes = client.session->snapshot()->interest->boxes.size();
    const uint64_t before = client.counts().on_the_wire();
    direct(port, world, wind);
    const bool told = client.session->wait_until(
        [&] { return client.session->snapshot()->interest->boxes.size() > boxes; }, std::chrono::seconds(60));
    if (!told) throw OperatorError("the storm never reached the client");
    sleep_until(std::chrono::steady_clock::now(), quiet_s);
    return client.counts().on_the_wire() - before;
}

/// What the land blocks of this state take in messages, in order of their fields and places.
uint64_t bytes_of_fields(const InterestState& state) {
    Delta delta;
    delta.result = 1;
    const size_t without = encode(ServerMessage(delta)).size();
    uint64_t bytes = 0;
    for (const auto& [key, block] : state.blocks) {
        delta.change.blocks = {block};
        bytes += encode(ServerMessage(delta)).size() - without;
    }
    return bytes;
}

struct CoastStorm {
    size_t patches = 0;
    size_t blocks = 0;
    uint64_t first_view = 0;  // terrain and fields with it
    uint64_t bytes = 0;
    uint64_t fields = 0;  // of these
    uint64_t apart() const { return bytes - std::min(bytes, fields); }
};

/// A storm of 100 trains over the Isles of Scilly, seen from the sea west of them.
CoastStorm storm_at_the_coast() {
    const ServerProcess server(TROCHOID_SOURCE_DIR "/server/scenes/scilly/scene.toml",
                               {"--log-level", "warn"});
    MeteredSession client(server.port(), sea_camera(-9000, 0, 90));
    CoastStorm out;
    // Terrain comes after the first result: until half a second brings nothing more.
    for (uint64_t last = 0; client.counts().on_the_wire() != last;) {
        last = client.counts().on_the_wire();
        sleep_until(std::chrono::steady_clock::now(), 0.45);
    }
    out.first_view = client.counts().on_the_wire();
    const uint64_t fields_before = bytes_of_fields(*client.session->snapshot()->interest);
    const size_t blocks_before = client.session->snapshot()->interest->blocks.size();
    StartWind wind = storm(100);
    wind.origin = {to_lattice(-9300.0), to_lattice(0.0)};
    wind.fetch = to_lattice(60000.0);
    wind.width = to_lattice(30000.0);
    out.bytes = bytes_of_storm(client, server.port(), "scilly", wind, 6.0);
    out.patches = client.patches();
    out.blocks = client.session->snapshot()->interest->blocks.size() - blocks_before;
    out.fields = bytes_of_fields(*client.session->snapshot()->interest) - fields_before;
    return out;
}

double bytes_a_train(const InterestState& state) {
    const auto encoded = [&](size_t trains) {
        WaveTrainBox box = *state.boxes.rbegin()->second;
        box.trains.resize(trains);
        Delta delta;
        delta.result = 1;
        delta.change.boxes.push_back(std::make_shared<const WaveTrainBox>(std::move(box)));
        return encode(ServerMessage(delta)).size();
    };
    const size_t trains = state.boxes.rbegin()->second->trains.size();
    const size_t half = trains / 2;
    return static_cast<double>(encoded(trains) - encoded(half)) / static_cast<double>(trains - half);
}

void measure(Report& report) {
    const double still_s = report.quick() ? 12.0 : 100.0;
    const double flight_s = report.quick() ? 12.0 : 60.0;
    const ServerProcess server(open_water_scene(), {"--log-level", "warn"});
    MeteredSession still(server.port(), sea_camera(0, 0, 20));
    MeteredSession straight(server.port(), sea_camera(0, 0, 0));
    MeteredSession turning(server.port(), sea_camera(0, 0, 0));
    const uint64_t first = still.counts().on_the_wire();
    const SteadyTime begin = std::chrono::steady_clock::now();
    sleep_until(begin, warm_up_s);

    const TcpCounts still_before = still.counts();
    Flight ahead;
    std::thread second([&] { ahead = fly(straight, flight_s, false); });
    const Flight yaw = fly(turning, flight_s, true);
    second.join();
    sleep_until(begin, warm_up_s + still_s);
    const TcpCounts still_after = still.counts();
    const double still_kbit = kbit(still_after.on_the_wire() - still_before.on_the_wire(), still_s);
    const uint64_t storm_bytes = bytes_of_storm(still, server.port(), "open water", storm(100), 4.0);
    const CoastStorm coast = storm_at_the_coast();

    fmt::print("first view: {} patches, {} trains, {} bytes on the wire\n", still.patches(), 60, first);
    fmt::print("static camera: {:.2f} kbit/s over {:.0f} s ({} bytes up, {} down, {} segments)\n", still_kbit,
               still_s, still_after.bytes_sent - still_before.bytes_sent,
               still_after.bytes_received - still_before.bytes_received,
               still_after.segments_sent + still_after.segments_received - still_before.segments_sent -
                   still_before.segments_received);
    const auto say = [](const char* what, const Flight& flight) {
        fmt::print(
            "{}: median {:.1f}, p95 {:.1f}, most {:.1f} kbit/s; {:.0f} patches (median), {} views, {} results\n",
            what, median(flight.windows), percentile(flight.windows, 0.95), percentile(flight.windows, 1.0),
            median(flight.patches), flight.views, flight.results);
    };
    say("30 m/s straight ahead", ahead);
    say("30 m/s, turning by 60 degrees in 5 s", yaw);
    fmt::print("storm of 100 trains: {} bytes on the wire\n", storm_bytes);
    fmt::print(
        "the same off the coast of Scilly: {} patches; {} bytes on the wire, {} of them {} land blocks, {} without; first "
        "view, terrain included: {} bytes\n",
        coast.patches, coast.bytes, coast.fields, coast.blocks, coast.apart(), coast.first_view);
    const double train_bytes = bytes_a_train(*still.session->snapshot()->interest);
    const double p95 = percentile(ahead.windows, 0.95);
    fmt::print(
        "a field of 256 x 256 floats at 20 Hz: {:.0f} kbit/s, {:.0f} times the static camera, {:.0f} times the flight\n",
        field_bits_per_second / 1000, field_bits_per_second / 1000 / still_kbit,
        field_bits_per_second / 1000 / p95);

    report.at_most("static camera", still_kbit, 2.0, " kbit/s");
    report.at_most("30 m/s, p95 of seconds", p95, 64.0, " kbit/s");
    report.at_least("patches in that flight", median(ahead.patches), 400);
    report.at_most("storm of 100 new trains", static_cast<double>(storm_bytes), 16384, " bytes");
    report.at_most("the same at a coast, land blocks apart", static_cast<double>(coast.apart()), 16384,
                   " bytes");
    report.at_most("a train's record", train_bytes, 28, " bytes");
    report.figure("static_kbit_per_s", still_kbit);
    report.figure("flight_p95_kbit_per_s", p95);
    report.figure("turning_flight_p95_kbit_per_s", percentile(yaw.windows, 0.95));
    report.figure("storm_bytes", static_cast<double>(storm_bytes));
    report.figure("coast_storm_bytes", static_cast<double>(coast.bytes));
    report.figure("coast_storm_field_bytes", static_cast<double>(coast.fields));
    report.figure("coast_storm_field_blocks", static_cast<double>(coast.blocks));
    report.figure("train_bytes", train_bytes);
    report.figure("first_view_bytes", static_cast<double>(first));
    report.figure("field_over_flight", field_bits_per_second / 1000 / p95);
    report.write(fmt::format("{:.2f} kbit/s still, {:.1f} in flight, storm {:.1f} KiB", still_kbit, p95,
                             static_cast<double>(storm_bytes) / 1024));
}

}  // namespace
}  // namespace trochoid::bench

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, trochoid::bench::measure); }
