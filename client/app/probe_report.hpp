#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "client/app/ocean_session.hpp"
#include "client/sample/water_sampler.hpp"

namespace trochoid {

/// What the probe reads at one point and time.
struct ProbeSample {
    SeaTime time;
    LatticePoint point;  ///< as a rest point for `surface`, as a fixed place for `answer`
    SurfaceSample surface;
    WaterAnswer answer;
};

/// How the server's own answers compare.
struct ProbeComparison {
    uint64_t asked = 0;
    uint64_t identical = 0;
    std::string first_difference;  ///< for people; empty where all are identical
    bool operator==(const ProbeComparison&) const = default;
};

/// The floats of a sample in the order of its declaration, as the bits that are compared.
std::vector<uint32_t> bits_of(const SurfaceSample& sample);

/// Counts the point in; says what differs if it is the first that does.
void compare(ProbeComparison& sum, const ProbeSample& ours, const SurfaceSample& servers);

std::string bits_line(const ProbeSample& sample);
std::string table_of(const std::vector<ProbeSample>& samples);
/// A line of --watch.
std::string watch_line(const ProbeSample& sample);
std::string comparison_line(const ProbeComparison& comparison);
/// What the session came to: server, fidelity, bytes.
std::string summary(const SessionStatistics& statistics, const StoreSnapshot& known);
std::string json_of(const std::vector<ProbeSample>& samples, const ProbeComparison* comparison,
                    const SessionStatistics& statistics, const StoreSnapshot& known);

}  // namespace trochoid
