#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "tests/conformance/case.hpp"
#include "tests/conformance/expected_failures.hpp"

namespace trochoid::conformance {

struct RunPlan {
    std::vector<Case> cases;
    /// Makes the trial of one run of a case.
    std::function<std::unique_ptr<Trial>()> trial;
    /// After every case: throws Failed where the program under test no longer serves others.
    std::function<void()> still_serves;
    int jobs = 6;          ///< cases side by side
    int connections = 10;  ///< most connections of cases at a time
    ExpectedFailures expected;
    /// After every case, in the order in which they end; one call at a time.
    std::function<void(const Outcome& outcome, size_t done)> progress;
};

/// Runs all cases: those that wait first, those that run alone last. Outcomes in the order of the plan.
std::vector<Outcome> run(const RunPlan& plan);

}  // namespace trochoid::conformance
