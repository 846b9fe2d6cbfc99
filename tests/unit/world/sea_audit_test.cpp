#include "tests/support/sea_audit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "server/world/spectrum.hpp"

namespace trochoid {
namespace {

constexpr AuditEffort moderate{128, 64, 4, 60};

void expect_within(double value, double reference, double part, const char* what, const AuditCase& wind) {
    EXPECT_NEAR(value / reference, 1.0, part) << what << " of spectrum " << static_cast<int>(wind.spectrum)
                                              << ", " << wind.speed << " m/s over " << wind.fetch << " m";
}

TEST(SeaAudit, TheSurfaceHasItsSpectrumsHeightsAndPeriods) {
    for (const Spectrum spectrum : {Spectrum::pierson_moskowitz, Spectrum::jonswap, Spectrum::neumann})
        for (const double speed : {5.0, 12.0, 25.0})
            for (const double fetch : {5e3, 80e3}) {
                AuditCase wind{speed, fetch, spectrum};
                wind.trains = 64;
                const AuditResult r = audit(wind, moderate);
                EXPECT_EQ(r.kind, spectrum);
                expect_within(r.train_height, r.spectrum_height, 1e-7, "trains' Hs", wind);
                // 8192 samples: a standard error of 0.8 %.
                expect_within(r.surface_height, r.spectrum_height, 0.04, "surface's Hs", wind);
                // The highest of 64 equal shares has no second moment but its median's.
                expect_within(r.train_mean, r.spectrum_mean, 0.05, "trains' Tm", wind);
                expect_within(r.surface_mean, r.train_mean, 0.06, "surface's Tm", wind);
                expect_within(r.train_peak, r.spectrum_peak, 0.08, "trains' Tp", wind);
                expect_within(r.spectrum_peak, r.published_peak, 0.005, "spectrum's Tp", wind);
                if (spectrum == Spectrum::jonswap) {
                    // Its fits of the peak's parameters and of the energy part by x^0.057.
                    const double parted = 0.7864 * std::pow(r.dimensionless_fetch, 2.0 / 3.0 - 0.61);
                    expect_within(r.spectrum_height, parted * r.published_height, 0.01, "Hs", wind);
                } else {
                    expect_within(r.spectrum_height, r.published_height, 0.01, "Hs", wind);
                }
            }
}

TEST(SeaAudit, ThePartitionOfPaperCHasThemToo) {
    AuditCase wind{12.0, 80e3, Spectrum::jonswap};
    wind.directions = 8;
    const AuditResult r = audit(wind, moderate);
    expect_within(r.train_height, r.spectrum_height, 1e-7, "trains' Hs", wind);
    expect_within(r.surface_height, r.spectrum_height, 0.04, "surface's Hs", wind);
    expect_within(r.surface_mean, r.spectrum_mean, 0.06, "surface's Tm", wind);
}

}  // namespace
}  // namespace trochoid
