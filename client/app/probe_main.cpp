#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <future>
#include <stdexcept>
#include <thread>

#include "client/app/probe_grid.hpp"
#include "client/app/probe_options.hpp"
#include "client/app/probe_report.hpp"
#include "client/net/blocking_link.hpp"
#include "protocol/model/self_check.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"

namespace {

using namespace trochoid;

/// Ctrl-C and SIGTERM end watching.
volatile std::sig_atomic_t interrupted = 0;

/// The server refused, went away or was too slow.
struct ProbeError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

SessionOptions session_options(const ProbeOptions& options) {
    SessionOptions session;
    session.server = options.server;
    session.software = fmt::format("trochoid-probe {}", software_version());
    session.fresh_token = [&login = options.login] { return login.token(Role::viewer); };
    session.view = view_of_nothing();
    session.regions = options.regions;
    session.reconnect = options.watch;
    return session;
}

/// Waits until the regions are covered by a snapshot that holds at least so much of the log.
void await_cover(OceanSession& session, const ProbeOptions& options, LogPosition at_least) {
    const auto covered = [&] {
        const auto known = session.snapshot();
        return known->result != 0 && known->regions == options.regions && known->log_position >= at_least;
    };
    const auto over = [&] {
        const SessionStatistics s = session.statistics();
        return s.state == LinkState::ended || (s.state == LinkState::waiting && s.connections == 0);
    };
    const bool in_time = session.wait_until([&] { return covered() || over(); }, options.patience);
    if (covered()) return;
    const SessionStatistics s = session.statistics();
    if (in_time && s.connections == 0 && !session.hello()) throw OperatorError(s.sentence);
    throw ProbeError(
        in_time
            ? s.sentence
            : fmt::format("the server did not cover the regions within {} s: try again, or look at its log",
                          options.patience.count() / 1000));
}

std::vector<ProbeSample> read_water(const std::shared_ptr<const StoreSnapshot>& known,
                                    const std::vector<LatticePoint>& points, SeaTime time) {
    const WaterSampler sampler(known, time);
    std::vector<ProbeSample> samples;
    samples.reserve(points.size());
    const std::vector<SurfaceSample> surface = sampler.surface(points);
    const std::vector<WaterAnswer> water = sampler.water(points);
    for (size_t i = 0; i < points.size(); ++i) samples.push_back({time, points[i], surface[i], water[i]});
    return samples;
}

/// The server's answer; waits for it.
SampleReply ask_server(OceanSession& session, const ProbeOptions& options, SeaTime time,
                       const std::vector<LatticePoint>& points) {
    auto promise = std::make_shared<std::promise<Result<SampleReply>>>();
    auto answer = promise->get_future();
    session.sample(time, points,
                   [promise](Result<SampleReply> reply) { promise->set_value(std::move(reply)); });
    if (answer.wait_for(options.patience) != std::future_status::ready)
        throw ProbeError(fmt::format("the server gave no samples within {} s: try again, or look at its log",
                                     options.patience.count() / 1000));
    Result<SampleReply> reply = answer.get();
    if (!reply) throw ProbeError(fmt::format("the server gave no samples: {}", reply.error().message));
    if (reply->samples.size() != points.size())
        throw ProbeError(fmt::format("the server gave {} samples for {} points: it breaks the protocol",
                                     reply->samples.size(), points.size()));
    return std::move(*reply);
}

/// Reads points and asks the server for them, both from the same log position.
std::vector<ProbeSample> read_and_compare(OceanSession& session, const ProbeOptions& options, SeaTime time,
                                          const std::vector<LatticePoint>& points, ProbeComparison& sum) {
    constexpr int most_tries = 20;
    for (int i = 0; i < most_tries; ++i) {
        const SampleReply reply = ask_server(session, options, time, points);
        await_cover(session, options, reply.log_position);
        const auto known = session.snapshot();
        if (known->log_position != reply.log_position) continue;  // an event came in between
        std::vector<ProbeSample> samples = read_water(known, points, time);
        for (size_t j = 0; j < samples.size(); ++j) compare(sum, samples[j], reply.samples[j]);
        return samples;
    }
    throw ProbeError(
        "the sea changes too often to compare two moments of its log: try again when fewer commands come");
}

std::vector<ProbeSample> read_time(OceanSession& session, const ProbeOptions& options, SeaTime time,
                                   ProbeComparison& sum) {
    if (!options.compare) return read_water(session.snapshot(), options.points, time);
    const size_t batch = std::max<size_t>(1, session.hello()->limits.sample_points);
    std::vector<ProbeSample> all;
    for (size_t at = 0; at < options.points.size(); at += batch) {
        const auto begin = options.points.begin() + static_cast<std::ptrdiff_t>(at);
        const auto end =
            options.points.begin() + static_cast<std::ptrdiff_t>(std::min(at + batch, options.points.size()));
        const auto more = read_and_compare(session, options, time, {begin, end}, sum);
        all.insert(all.end(), more.begin(), more.end());
    }
    return all;
}

/// Waits until the time has come and nothing can change it any more.
void await_confirmed(OceanSession& session, const ProbeOptions& options, SeaTime time) {
    const auto confirmed = [&] { return session.snapshot()->watermark >= time; };
    const auto ended = [&] { return session.statistics().state == LinkState::ended; };
    // The watermark says enough: it runs ahead of the time by less than the server's lead.
    const bool in_time = session.wait_until([&] { return confirmed() || ended(); }, options.patience);
    if (confirmed()) return;
    throw ProbeError(
        in_time
            ? session.statistics().sentence
            : fmt::format(
                  "sea time {:.3f} s was not confirmed within {} s: see trochoid-ctl time, or give more --patience",
                  static_cast<double>(time.us) * 1e-6, options.patience.count() / 1000));
}

int read_times(OceanSession& session, const ProbeOptions& options) {
    const SeaTime first = (options.at_s ? SeaTime{seconds_to_us(*options.at_s)} : session.sea_time_now()) +
                          seconds_to_us(options.in_s);
    ProbeComparison sum;
    std::vector<ProbeSample> all;
    for (uint32_t i = 0; i < options.times; ++i) {
        const SeaTime time = first + int64_t{i} * seconds_to_us(options.every_s);
        if (options.follow) await_confirmed(session, options, time);
        const auto samples = read_time(session, options, time, sum);
        if (options.output == ProbeOutput::bits)
            for (const ProbeSample& sample : samples) fmt::print("{}", bits_line(sample));
        else
            all.insert(all.end(), samples.begin(), samples.end());
    }
    const SessionStatistics statistics = session.statistics();
    const auto known = session.snapshot();
    if (options.output == ProbeOutput::json)
        fmt::print("{}", json_of(all, options.compare ? &sum : nullptr, statistics, *known));
    if (options.output == ProbeOutput::table) fmt::print("{}", table_of(all));
    // Bits and JSON are for programs: the words for people go elsewhere.
    std::FILE* words = options.output == ProbeOutput::table ? stdout : stderr;
    if (options.compare) fmt::print(words, "{}", comparison_line(sum));
    fmt::print(words, "{}", summary(statistics, *known));
    return sum.identical == sum.asked ? 0 : 1;
}

int watch(OceanSession& session, const ProbeOptions& options) {
    std::signal(SIGINT, [](int) { interrupted = 1; });
    std::signal(SIGTERM, [](int) { interrupted = 1; });
    const auto begin = std::chrono::steady_clock::now();
    const std::chrono::duration<double> interval(options.every_s);
    std::string said;
    for (uint64_t i = 0; interrupted == 0; ++i) {
        const std::chrono::duration<double> since_begin = std::chrono::steady_clock::now() - begin;
        if (options.seconds && since_begin.count() >= *options.seconds) break;
        const SessionStatistics statistics = session.statistics();
        if (statistics.state == LinkState::ended) throw ProbeError(statistics.sentence);
        if (statistics.state != LinkState::live && statistics.sentence != said)
            fmt::print(stderr, "trochoid-probe: {}\n", statistics.sentence);
        said = statistics.sentence;
        const auto samples = read_water(session.snapshot(), {options.points.front()}, session.sea_time_now());
        fmt::print("{}", watch_line(samples.front()));
        std::fflush(stdout);
        // In short naps, so that Ctrl-C ends it soon.
        const auto next = begin + interval * static_cast<double>(i + 1);
        while (interrupted == 0 && std::chrono::steady_clock::now() < next)
            std::this_thread::sleep_for(std::min<std::chrono::duration<double>>(
                next - std::chrono::steady_clock::now(), std::chrono::milliseconds(50)));
    }
    fmt::print("{}", summary(session.statistics(), *session.snapshot()));
    return 0;
}

/// What a budget buys and what coarse evaluation saves; 0 where the stated bounds hold.
int read_grid(OceanSession& session, const ProbeOptions& options) {
    const LatticeGrid grid = *grid_within(options.regions.front(), options.grid);
    const SeaTime first = (options.at_s ? SeaTime{seconds_to_us(*options.at_s)} : session.sea_time_now()) +
                          seconds_to_us(options.in_s);
    const bool json = options.output == ProbeOutput::json;
    bool bounds_hold = true;
    for (uint32_t i = 0; i < options.times; ++i) {
        const SeaTime time = first + int64_t{i} * seconds_to_us(options.every_s);
        const Sea sea = session.snapshot()->sea;
        if (options.budget) {
            const BudgetAnswer answer = spend_budget(sea, time, grid, *options.budget);
            fmt::print("{}", json ? json_line(answer) : text_of(answer));
            bounds_hold = bounds_hold && answer.keeps_bound();
        }
        if (options.coarse) {
            const CoarseAnswer answer = evaluate_coarsely(sea, time, grid, {*options.coarse});
            fmt::print("{}", json ? json_line(answer) : text_of(answer));
            bounds_hold = bounds_hold && answer.keeps_bound();
        }
    }
    fmt::print(json ? stderr : stdout, "{}", summary(session.statistics(), *session.snapshot()));
    return bounds_hold ? 0 : 1;
}

int run(const ProbeOptions& options) {
    self_check();
    OceanSession session(session_options(options));
    await_cover(session, options, {});
    if (options.budget || options.coarse) return read_grid(session, options);
    return options.watch ? watch(session, options) : read_times(session, options);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const auto options = read_probe_options(argc, argv);
        return options ? run(*options) : 0;
    } catch (const OperatorError& error) {
        fmt::print(stderr, "trochoid-probe: {}\n", error.what());
        return 2;
    } catch (const ProbeError& error) {
        fmt::print(stderr, "trochoid-probe: {}\n", error.what());
        return 1;
    }
}
