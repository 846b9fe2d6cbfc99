#include "tests/conformance/runner.hpp"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "tests/conformance/framed_stream.hpp"

namespace trochoid::conformance {

namespace {

/// Connections that cases may have open together.
class Berths {
public:
    explicit Berths(int count) : most_(count), free_(count) {}

    int take(int wanted) {
        const int count = std::min(wanted, most_);
        std::unique_lock lock(mutex_);
        freed_.wait(lock, [&] { return free_ >= count; });
        free_ -= count;
        return count;
    }
    void give(int count) {
        const std::lock_guard lock(mutex_);
        free_ += count;
        freed_.notify_all();
    }

private:
    const int most_;
    int free_;
    std::mutex mutex_;
    std::condition_variable freed_;
};

void attempt(const Case& it, const RunPlan& plan, Outcome& outcome) {
    const auto trial = plan.trial();
    try {
        it.body(*trial);
        plan.still_serves();
        outcome.verdict = Verdict::passed;
    } catch (const Failed& failed) {
        outcome.verdict = Verdict::failed;
        outcome.reason = failed.reason;
    } catch (const Skipped& skipped) {
        outcome.verdict = Verdict::skipped;
        outcome.reason = skipped.reason;
    } catch (const std::exception& error) {
        outcome.verdict = Verdict::failed;
        outcome.reason = std::string("the case broke off: ") + error.what();
    }
    outcome.close = trial->close();
    outcome.notes = trial->notes();
}

Outcome outcome_of(const Case& it, const RunPlan& plan) {
    Outcome outcome;
    outcome.id = it.id;
    outcome.title = it.title;
    const int64_t begin_us = monotonic_us();
    attempt(it, plan, outcome);
    if (outcome.verdict == Verdict::failed) {
        // The next case must not be blamed for this one.
        try {
            plan.still_serves();
        } catch (const Failed& failed) {
            outcome.reason += "; and " + failed.reason;
        }
    }
    outcome.took_us = monotonic_us() - begin_us;
    plan.expected.judge(outcome);
    return outcome;
}

int rank(Course course) {
    switch (course) {
        case Course::waiting: return 0;
        case Course::together: return 1;
        case Course::alone: return 2;
    }
    return 1;
}

}  // namespace

std::vector<Outcome> run(const RunPlan& plan) {
    std::vector<size_t> order(plan.cases.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        return rank(plan.cases[a].course) < rank(plan.cases[b].course);
    });
    const auto alone = std::find_if(order.begin(), order.end(),
                                    [&](size_t i) { return plan.cases[i].course == Course::alone; });
    const size_t beside = static_cast<size_t>(alone - order.begin());

    std::vector<Outcome> outcomes(plan.cases.size());
    Berths berths(plan.connections);
    std::mutex mutex;
    size_t next = 0;
    size_t done = 0;
    const auto carry_out = [&](size_t index) {
        const Case& it = plan.cases[index];
        const int held = berths.take(it.connections);
        Outcome outcome = outcome_of(it, plan);
        berths.give(held);
        const std::lock_guard lock(mutex);
        ++done;
        if (plan.progress) plan.progress(outcome, done);
        outcomes[index] = std::move(outcome);
    };
    const auto work = [&] {
        while (true) {
            size_t place = 0;
            {
                const std::lock_guard lock(mutex);
                if (next == beside) return;
                place = next++;
            }
            carry_out(order[place]);
        }
    };
    std::vector<std::thread> workers;
    workers.reserve(static_cast<size_t>(plan.jobs));
    for (int i = 0; i < plan.jobs; ++i) workers.emplace_back(work);
    for (std::thread& worker : workers) worker.join();
    for (size_t place = beside; place < order.size(); ++place) carry_out(order[place]);
    return outcomes;
}

}  // namespace trochoid::conformance
