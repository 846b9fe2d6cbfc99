// R7: what hostile peers do to good ones. The server has one core for all its threads; good clients and hostile peers share the other,
// where the hostile ones give way, so that what is seen is the server's doing. Both are there before anything else on the machine; the
// server's thread for results aside, which gives way of its own will, is not. Calm and attack take turns, and the good clients
// do the same at the same times in each.
#include <algorithm>
#include <functional>
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

/// Clients that move on and take the time from each view to its result: all together one timetable, the same in each watch.
class MovingClients {
public:
    struct Manner {
        int clients = 0;
        double step_m = 0.0;  ///< from view to view
        int least_ms = 0;     ///< between two views, and
        int more_ms = 1;      ///< at most so many more
    };
    MovingClients(uint16_t port, const Manner& manner)
        : manner_(manner), one_(static_cast<size_t>(manner.clients)) {
        for (int i = 0; i < manner_.clients; ++i) {
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
        for (int i = 0; i < 500 && here([this] { return began(); }) < manner_.clients; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ~MovingClients() {
        here([this] {
            ++watch_;
            for (One& one : one_) one.client->leave();
        });
        loop_.stop();
    }
    MovingClients(const MovingClients&) = delete;
    MovingClients& operator=(const MovingClients&) = delete;

    /// From here on the thread of these runs only where others leave the core to it.
    void give_way() {
        here([] { give_way_to_others(); });
    }
    /// Milliseconds from view to result over the next seconds. `begin`: called once they move.
    std::vector<double> watch(double seconds, const std::function<void()>& begin = {}) {
        here([this] {
            times_.clear();
            ++watch_;
            for (int i = 0; i < manner_.clients; ++i) {
                One& one = one_[static_cast<size_t>(i)];
                one.dice = splitmix64(static_cast<uint64_t>(i) + 1);
                one.waits = false;
                next(i);
            }
        });
        if (begin) begin();
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
        uint64_t dice = 0;
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
    // At odd times, so that no rhythm forms.
    void next(int i) {
        One& one = one_[static_cast<size_t>(i)];
        one.dice = splitmix64(one.dice);
        const auto more = static_cast<int64_t>(one.dice % static_cast<uint64_t>(manner_.more_ms));
        loop_.after(std::chrono::milliseconds(manner_.least_ms + more), [this, i, watch = watch_] {
            if (watch == watch_) step(i);
        });
    }
    // Beyond what the last result allows for: each view asks for a new result.
    void step(int i) {
        One& one = one_[static_cast<size_t>(i)];
        one.shown.position.z -= to_lattice(manner_.step_m);
        one.shown_us = client_monotonic_us();
        one.waits = true;
        one.client->show(one.shown);
        next(i);
    }
    template <class F>
    auto here(F f) -> decltype(f()) {
        std::packaged_task<decltype(f())()> task(f);
        loop_.post([&task] { task(); });
        return task.get_future().get();
    }

    NetLoop loop_;
    Manner manner_;
    std::vector<One> one_;
    std::vector<double> times_;
    uint64_t watch_ = 0;
    int lost_ = 0;
};

constexpr MovingClients::Manner good_manner{40, 40.0, 150, 100};
// As much as the limits allow, from clients that keep the standard: another sea every time.
constexpr MovingClients::Manner hurried_manner{8, 20'000.0, 40, 1};

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
    bool hurried = false;  ///< and clients that ask for as much as they may
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
        {"hurried, within limits", {}, true},
    };
    Attack together{"all together", {}, true};
    for (const Attack& attack : list)
        together.groups.insert(together.groups.end(), attack.groups.begin(), attack.groups.end());
    list.push_back(together);
    return list;
}

/// Bytes of a fresh server's own memory that each of so many peers costs it.
double memory_of(Hostility hostility, int peers) {
    // Held-back connections would not be read from: here they all are.
    const ServerProcess server(open_water_scene(), {"--logins-per-address", "0"});
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

/// What one attack did: times of good clients without and with it, and what the hostile peers did and saw.
struct Outcome {
    std::vector<double> alone;
    std::vector<double> beside;
    HostileCounts counts;
    double seconds = 0.0;
    double server_seconds = 0.0;
};

void add(HostileCounts& sum, const HostileCounts& more) {
    sum.connections += more.connections;
    sum.bytes_sent += more.bytes_sent;
    sum.without_a_word += more.without_a_word;
    for (const auto& [code, count] : more.goodbyes) sum.goodbyes[code] += count;
}

// From the first moment of the attack on.
void attack_once(const ServerProcess& server, MovingClients& good, const Attack& attack, double phase_s,
                 Outcome& outcome) {
    const auto append = [](std::vector<double>& all, const std::vector<double>& more) {
        all.insert(all.end(), more.begin(), more.end());
    };
    append(outcome.alone, good.watch(phase_s));
    std::unique_ptr<MovingClients> hurried;
    if (attack.hurried) {
        hurried = std::make_unique<MovingClients>(server.port(), hurried_manner);
        hurried->give_way();
    }
    std::unique_ptr<HostilePeers> peers;
    const double before = server.processor_seconds();
    const double begun = now(Clock::wall);
    append(outcome.beside, good.watch(phase_s, [&] {
        if (hurried) hurried->watch(0.0);
        peers = std::make_unique<HostilePeers>(server.port(), attack.groups);
    }));
    add(outcome.counts, peers->counts());
    outcome.seconds += now(Clock::wall) - begun;
    outcome.server_seconds += server.processor_seconds() - before;
    peers.reset();
    hurried.reset();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // what they leave is cleared away
}

void show_codes(const ServerProcess& server, const HostileCounts& seen, Report& report) {
    uint64_t coded = 0;
    for (const auto& [code, count] : server.ended_by_code()) {
        fmt::print("ended with {}: {}\n", code, count);
        coded += code != 0 ? count : 0;
    }
    for (const auto& [status, count] : server.http_answers()) {
        fmt::print("answered with HTTP status {}: {}\n", status, count);
        coded += count;
    }
    for (const auto& [code, count] : seen.goodbyes)
        fmt::print("hostile peers were told {}: {}\n", static_cast<unsigned>(code), count);
    fmt::print("hostile peers whose connection ended before they had read why: {}\n", seen.without_a_word);
    const uint64_t all = server.connections_at_the_door();
    report.check("connections that ended with a code, or an HTTP status", fmt::format("{} of {}", coded, all),
                 "all", coded == all);
}

void measure(Report& report) {
    const double phase_s = report.quick() ? 1.5 : 3.0;
    const int rounds = report.quick() ? 2 : 8;
    ServerProcess server(open_water_scene());
    server.pin({0});
    pin_ourselves({1});
    MovingClients good(server.port(), good_manner);
    good.watch(1.0);
    fmt::print("{:>24} {:>8} {:>9} {:>10} {:>6} {:>8} {:>14} {:>6} {:>9}\n", "attack", "median", "p99 alone",
               "p99 beside", "ratio", "samples", "connections/s", "MB/s", "server %");
    std::vector<double> worst_ratio;
    HostileCounts seen;
    for (const Attack& attack : attacks()) {
        Outcome outcome;
        for (int round = 0; round < rounds; ++round) attack_once(server, good, attack, phase_s, outcome);
        add(seen, outcome.counts);
        const double p99_alone = percentile(outcome.alone, 0.99);
        const double p99_beside = percentile(outcome.beside, 0.99);
        worst_ratio.push_back(p99_beside / p99_alone);
        fmt::print("{:>24} {:>8.2f} {:>9.2f} {:>10.2f} {:>6.2f} {:>8} {:>14.0f} {:>6.1f} {:>9.0f}\n",
                   attack.name, percentile(outcome.beside, 0.5), p99_alone, p99_beside, worst_ratio.back(),
                   outcome.beside.size(), static_cast<double>(outcome.counts.connections) / outcome.seconds,
                   static_cast<double>(outcome.counts.bytes_sent) * 1e-6 / outcome.seconds,
                   outcome.server_seconds / outcome.seconds * 100.0);
        report.at_most(fmt::format("p99 beside {}, over alone", attack.name), worst_ratio.back(), 1.10);
        report.figure(fmt::format("p99_ratio_{}", attack.name), worst_ratio.back());
    }
    const int lost = good.lost();
    report.check("good clients thrown out", std::to_string(lost), "0", lost == 0);
    if (!server.stop()) throw OperatorError("the server did not stop well:\n" + server.log().substr(0, 2000));
    show_codes(server, seen, report);
    measure_memory(report);
    const double worst = *std::max_element(worst_ratio.begin(), worst_ratio.end());
    report.write(fmt::format("p99 at worst {:.2f} of alone, {:.0f} bytes a half hello", worst,
                             report.kept("half_hello_bytes")));
}

}  // namespace
}  // namespace trochoid::bench

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, trochoid::bench::measure); }
