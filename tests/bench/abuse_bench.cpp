// R7: what hostile peers do to good ones. The server has a core of its own; good clients and hostile peers share the other, where the
// hostile ones give way, so that what is seen is the server's doing.
#include <algorithm>
#include <array>
#include <future>
#include <numeric>
#include <thread>
#include <vector>

#include "protocol/units/hash.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/stopwatch.hpp"
#include "tests/bench/wire_sea.hpp"
#include "tests/support/net/hostile_peers.hpp"
#include "tests/support/net/sea_client.hpp"
#include "tests/support/net/server_process.hpp"

namespace trochoid::bench {
namespace {

constexpr int good_clients = 20;

/// Clients that move on all the time and take the time from each view to its result.
class GoodClients {
public:
    explicit GoodClients(uint16_t port) {
        for (int i = 0; i < good_clients; ++i) {
            ClientHello hello;
            hello.view = sea_camera(1000.0 * i, 0, 18 * i);
            one_[static_cast<size_t>(i)].shown = hello.view;
            SeaClient::Events events;
            events.result = [this, i](const Delta& last, int64_t received_us) { took(i, last, received_us); };
            events.closed = [this](const Goodbye&, CloseCause) { ++lost_; };
            one_[static_cast<size_t>(i)].client =
                std::make_unique<SeaClient>(loop_, Endpoint{"127.0.0.1", port}, hello, events);
        }
        here([this] {
            for (One& one : one_) one.client->open();
        });
        for (int i = 0; i < 500 && here([this] { return began(); }) < good_clients; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        here([this] {
            for (int i = 0; i < good_clients; ++i) step(i);
        });
    }
    ~GoodClients() {
        here([this] {
            for (One& one : one_) one.client->leave();
        });
        loop_.stop();
    }
    GoodClients(const GoodClients&) = delete;
    GoodClients& operator=(const GoodClients&) = delete;

    /// Milliseconds from view to result over the next seconds.
    std::vector<double> watch(double seconds) {
        here([this] { times_.clear(); });
        std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
        return here([this] { return times_; });
    }
    int lost() {
        return here([this] { return lost_; });
    }

private:
    struct One {
        std::unique_ptr<SeaClient> client;
        ViewState shown;
        int64_t shown_us = 0;
        bool waits = false;
        bool began = false;
    };

    int began() const {
        return static_cast<int>(
            std::count_if(one_.begin(), one_.end(), [](const One& one) { return one.began; }));
    }
    void took(int i, const Delta& last, int64_t received_us) {
        One& one = one_[static_cast<size_t>(i)];
        one.began = true;
        if (!one.waits || !(last.key.anchor.position == one.shown.position)) return;
        one.waits = false;
        times_.push_back(static_cast<double>(received_us - one.shown_us) * 1e-3);
    }
    // 40 m on, beyond what the last result allows for: each view asks for a new result. At odd times, so that no rhythm forms.
    void step(int i) {
        One& one = one_[static_cast<size_t>(i)];
        one.shown.position.z -= to_lattice(40.0);
        one.shown_us = client_monotonic_us();
        one.waits = true;
        one.client->show(one.shown);
        dice_ = splitmix64(dice_);
        loop_.after(std::chrono::milliseconds(150 + static_cast<int64_t>(dice_ % 100)),
                    [this, i] { step(i); });
    }
    template <class F>
    auto here(F f) -> decltype(f()) {
        std::packaged_task<decltype(f())()> task(f);
        loop_.post([&task] { task(); });
        return task.get_future().get();
    }

    NetLoop loop_;
    std::array<One, good_clients> one_;
    std::vector<double> times_;
    uint64_t dice_ = 1;
    int lost_ = 0;
};

double percentile(std::vector<double> values, double share) {
    if (values.empty()) return 0.0;
    std::sort(values.begin(), values.end());
    return values[std::min(values.size() - 1,
                           static_cast<size_t>(share * static_cast<double>(values.size())))];
}

using Groups = std::vector<HostilePeers::Group>;

struct Attack {
    const char* name;
    Groups groups;
};

std::vector<Attack> attacks() {
    const auto group = [](Hostility hostility, int peers, std::string token = {}) {
        return HostilePeers::Group{hostility, peers, std::move(token)};
    };
    std::vector<Attack> list{
        {"200 slow hellos", {group(Hostility::slow_hello, 200)}},
        {"view flood", {group(Hostility::view_flood, 8)}},
        {"command flood", {group(Hostility::command_flood, 8)}},
        {"questions, unread", {group(Hostility::question_flood, 8)}},
        {"garbage", {group(Hostility::garbage, 8)}},
        {"oversize frames", {group(Hostility::oversize, 8)}},
        {"bad tokens", {group(Hostility::bad_token, 8, "not a token that anybody gave out")}},
        {"replayed tokens", {group(Hostility::bad_token, 8, ServerProcess::director_token("open water"))}},
        {"connect and close", {group(Hostility::hang_up, 16)}},
    };
    Attack together{"all together", {}};
    for (const Attack& attack : list)
        together.groups.insert(together.groups.end(), attack.groups.begin(), attack.groups.end());
    list.push_back(together);
    return list;
}

/// Bytes of a fresh server's own memory that each of so many peers costs it.
double memory_of(Hostility hostility, int peers) {
    const ServerProcess server(open_water_scene());
    const uint64_t before = server.memory();
    const HostilePeers crowd(server.port(), {{hostility, peers, {}}});
    for (int i = 0; i < 300 && crowd.standing() < peers; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
    const int standing = crowd.standing();
    if (standing < peers)
        throw OperatorError(fmt::format("only {} of {} connections stand", standing, peers));
    return static_cast<double>(server.memory() - before) / peers;
}

void measure_memory(Report& report) {
    const int peers = report.quick() ? 300 : 1000;
    const double silent = memory_of(Hostility::silence, peers);
    const double begun = memory_of(Hostility::magic_alone, peers);
    const double half = memory_of(Hostility::half_hello, peers);
    fmt::print(
        "{} connections without a word: {:.0f} bytes each; that say what they speak: {:.0f}; with half a hello of 3.8 KB: {:.0f}\n",
        peers, silent, begun, half);
    report.at_most("of a peer's size before its login", half - begun, 4096, " bytes");
    report.figure("begun_connection_bytes", begun);
    report.figure("silent_connection_bytes", silent);
    report.figure("half_hello_bytes", half);
}

void measure(Report& report) {
    const double phase_s = report.quick() ? 1.5 : 3.0;
    const int rounds = report.quick() ? 1 : 2;
    ServerProcess server(open_water_scene());
    server.pin({0});
    pin_ourselves({1});
    GoodClients good(server.port());
    good.watch(1.0);
    fmt::print("{:>20} {:>9} {:>9} {:>9} {:>9} {:>8} {:>12} {:>10} {:>8}\n", "attack", "median", "p99 alone",
               "p99 beside", "ratio", "samples", "connections", "MB sent", "server %");
    std::vector<double> worst_ratio;
    for (const Attack& attack : attacks()) {
        std::vector<double> alone;
        std::vector<double> beside;
        HostileCounts counts;
        double used = 0.0;
        for (int round = 0; round < rounds; ++round) {
            const auto quiet = good.watch(phase_s);
            alone.insert(alone.end(), quiet.begin(), quiet.end());
            const HostilePeers peers(server.port(), attack.groups);
            std::this_thread::sleep_for(std::chrono::milliseconds(300));
            const double before = server.processor_seconds();
            const auto attacked = good.watch(phase_s);
            used = (server.processor_seconds() - before) / phase_s;
            beside.insert(beside.end(), attacked.begin(), attacked.end());
            const HostileCounts now = peers.counts();
            counts.connections += now.connections;
            counts.bytes_sent += now.bytes_sent;
        }
        const double p99_alone = percentile(alone, 0.99);
        const double p99_beside = percentile(beside, 0.99);
        worst_ratio.push_back(p99_beside / p99_alone);
        fmt::print("{:>20} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f} {:>8} {:>12} {:>10.1f} {:>8.0f}\n",
                   attack.name, percentile(beside, 0.5), p99_alone, p99_beside, worst_ratio.back(),
                   beside.size(), counts.connections, static_cast<double>(counts.bytes_sent) * 1e-6,
                   used * 100.0);
        report.at_most(fmt::format("p99 beside {}, over alone", attack.name), worst_ratio.back(), 1.10);
        report.figure(fmt::format("p99_ratio_{}", attack.name), worst_ratio.back());
    }
    const int lost = good.lost();
    report.check("good clients thrown out", std::to_string(lost), "0", lost == 0);
    if (!server.stop()) throw OperatorError("the server did not stop well:\n" + server.log().substr(0, 2000));
    uint64_t coded = 0;
    for (const auto& [code, count] : server.ended_by_code()) {
        fmt::print("ended with {}: {}\n", code, count);
        coded += code != 0 ? count : 0;
    }
    report.check("connections that ended with a code", fmt::format("{} of {}", coded, server.connections()),
                 "all", coded == server.connections());
    measure_memory(report);
    const double worst = *std::max_element(worst_ratio.begin(), worst_ratio.end());
    report.write(fmt::format("p99 at worst {:.2f} of alone, {:.0f} bytes a half hello", worst,
                             report.kept("half_hello_bytes")));
}

}  // namespace
}  // namespace trochoid::bench

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, trochoid::bench::measure); }
