// Prints how much of the sea the viewer whitens at winds, near and far, beside Monahan and O'Muircheartaigh's share:
// foam_table [moments [metres…]]
#include <fmt/format.h>

#include <cstdlib>
#include <vector>

#include "client/gpu/offscreen_context.hpp"
#include "tests/gpu/foam_coverage.hpp"

using namespace trochoid;

int main(int argc, char** argv) {
    const int moments = argc > 1 ? std::atoi(argv[1]) : 40;
    std::vector<double> sides;
    for (int i = 2; i < argc; ++i) sides.push_back(std::atof(argv[i]));
    if (sides.empty()) sides = {40, 150, 1500, 6000};
    OffscreenContext context;
    fmt::print("wind m/s | law %");
    for (const double side : sides) fmt::print(" | {:.0f} m wide %", side);
    fmt::print("\n");
    for (const double wind : {5.0, 8.0, 12.0, 17.0, 25.0}) {
        FoamCoverage coverage(wind);
        fmt::print("{:.1f} | {:.3f}", coverage.wind_m_s(), 100 * monahan_share(wind));
        for (const double side : sides) {
            const double share = coverage.mean(side, moments, 3.0);
            fmt::print(" | {:.3f} ({:.2f})", 100 * share, share / monahan_share(wind));
        }
        fmt::print("\n");
        std::fflush(stdout);
    }
    return 0;
}
