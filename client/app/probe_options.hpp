#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/net/endpoint.hpp"
#include "client/net/token_source.hpp"
#include "protocol/model/view.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

enum class ProbeOutput : uint8_t { table, json, bits };

/// What trochoid-probe is asked to do.
struct ProbeOptions {
    Endpoint server;
    TokenSource login;
    std::vector<SyncRegion> regions;   ///< at least one
    std::vector<LatticePoint> points;  ///< those given and those chosen by the seed
    std::optional<double> at_s;        ///< sea time of the first sample, seconds; none: now
    double in_s = 0.0;                 ///< seconds after that
    uint32_t times = 1;
    double every_s = 1.0;  ///< sea seconds between times; real seconds while watching
    ProbeOutput output = ProbeOutput::table;
    bool compare = false;           ///< ask the server for the same and count differences
    bool follow = false;            ///< wait for each time to come and to be confirmed
    bool watch = false;             ///< print the first point's water until ended
    std::optional<double> seconds;  ///< end watching after so long
    std::optional<double> budget;   ///< point-trains to be spent on a grid, instead of reading points
    std::optional<int> coarse;      ///< coarse step over grid step, instead of reading points
    uint32_t grid = 256;            ///< points along a side of the grid of both, inside the first region
    std::chrono::milliseconds patience{30000};
};

/// The command line as options. Nothing where --help or --version has been answered on standard output; OperatorError for
/// everything that does not fit, with what would.
std::optional<ProbeOptions> read_probe_options(int argc, const char* const* argv);

/// `count` points inside the regions (closed discs, taken in turn), the same for the same seed on every machine.
std::vector<LatticePoint> points_inside(const std::vector<SyncRegion>& regions, uint32_t count,
                                        uint64_t seed);

}  // namespace trochoid
