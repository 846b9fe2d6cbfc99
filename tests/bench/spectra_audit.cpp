// Does the sea that is computed from a wind have the heights and periods of the wind's spectrum, and of the literature?
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "protocol/units/lattice.hpp"
#include "server/world/integer_math.hpp"
#include "server/world/spectrum.hpp"
#include "tests/bench/report.hpp"
#include "tests/support/sea_audit.hpp"

namespace {

using namespace trochoid;

const char* name_of(Spectrum kind) {
    switch (kind) {
        case Spectrum::pierson_moskowitz: return "Pierson-Moskowitz";
        case Spectrum::jonswap: return "JONSWAP";
        case Spectrum::neumann: return "Neumann";
        default: return "automatic";
    }
}

struct Row {
    AuditCase wind;
    AuditResult result;
    /// What the published Hs has to be multiplied with where two fits of one paper part (JONSWAP), else 1.
    double parted() const {
        return result.kind == Spectrum::jonswap
                   ? 0.7864 * std::pow(result.dimensionless_fetch, 2.0 / 3.0 - 0.61)
                   : 1.0;
    }
};

/// Largest |value / reference - 1| over the rows, in percent.
template <class Value, class Reference>
double worst(const std::vector<Row>& rows, Value value, Reference reference) {
    double most = 0.0;
    for (const Row& row : rows) most = std::max(most, std::abs(value(row) / reference(row) - 1.0));
    return 100.0 * most;
}

void print_rows(const std::vector<Row>& rows) {
    fmt::print(
        "Hs in m, periods in s. surface: sampled; spectrum: its own integrals; published: see server/world/spectrum.hpp.\n");
    fmt::print(
        "Tz: zero up-crossings of the surface; Tm: 2 pi sqrt(m0/m2); Tp of the trains' binned energy.\n\n");
    fmt::print(
        "| U19.5 | fetch km | spectrum | Hs surface | spectrum | published | Tz surface | Tm spectrum | Tp trains | spectrum | published |\n");
    fmt::print("|--:|--:|:--|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (const auto& [wind, r] : rows)
        fmt::print(
            "| {:g} | {:g} | {} | {:.3f} | {:.3f} | {:.3f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n",
            wind.speed, wind.fetch / 1000.0, name_of(r.kind), r.surface_height, r.spectrum_height,
            r.published_height, r.surface_mean, r.spectrum_mean, r.train_peak, r.spectrum_peak,
            r.published_peak);
    fmt::print("\n");
}

void check_rows(const std::vector<Row>& rows, bench::Report& report) {
    const auto spectrum_height = [](const Row& row) { return row.result.spectrum_height; };
    report.at_most("Hs of the surface against its spectrum",
                   worst(
                       rows, [](const Row& row) { return row.result.surface_height; }, spectrum_height),
                   report.quick() ? 4.0 : 2.0, " %");
    report.at_most("Hs of the trains against their spectrum",
                   worst(
                       rows, [](const Row& row) { return row.result.train_height; }, spectrum_height),
                   1e-5, " %");
    report.at_most("Tz of the surface against Tm of its spectrum",
                   worst(
                       rows, [](const Row& row) { return row.result.surface_mean; },
                       [](const Row& row) { return row.result.spectrum_mean; }),
                   report.quick() ? 6.0 : 4.0, " %");
    report.at_most("Tp of the trains against the spectrum's",
                   worst(
                       rows, [](const Row& row) { return row.result.train_peak; },
                       [](const Row& row) { return row.result.spectrum_peak; }),
                   3.0, " %");
    report.at_most("Hs of the spectrum against what was published (JONSWAP: times its fits' ratio)",
                   worst(rows, spectrum_height,
                         [](const Row& row) { return row.result.published_height * row.parted(); }),
                   1.0, " %");
    report.at_most("Tp of the spectrum against what was published",
                   worst(
                       rows, [](const Row& row) { return row.result.spectrum_peak; },
                       [](const Row& row) { return row.result.published_peak; }),
                   0.5, " %");
}

nlohmann::json curve(const std::string& name, const std::vector<double>& x, const std::vector<double>& y,
                     bool dashed) {
    return {{"name", name}, {"x", x}, {"y", y}, {"dashed", dashed}};
}

/// Paper C's figure 2: the spectra of one wind.
nlohmann::json spectra_plot() {
    nlohmann::json plot = {
        {"title", "spectra of 12 m/s at 19.5 m"}, {"x", "frequency, rad/s"}, {"y", "S, m\u00b2 s"}};
    const auto add = [&](const std::string& name, const FrequencySpectrum& s, bool dashed) {
        std::vector<double> x;
        std::vector<double> y;
        for (double w = 0.3; w <= 2.5; w += 0.025) {
            x.push_back(w);
            y.push_back(s.density(w));
        }
        plot["curves"].push_back(curve(name, x, y, dashed));
    };
    for (const double km : {25.0, 80.0, 160.0})
        add(fmt::format("JONSWAP, {:g} km", km),
            wind_spectrum(12.0, to_lattice(km * 1000.0), Spectrum::jonswap), false);
    add("Pierson-Moskowitz", wind_spectrum(12.0, to_lattice(1e6), Spectrum::pierson_moskowitz), true);
    add("Neumann", wind_spectrum(12.0, to_lattice(1e6), Spectrum::neumann), true);
    return plot;
}

/// Measured and published heights over fetch (JONSWAP) or over wind (the others).
nlohmann::json heights_plot(const std::vector<Row>& rows) {
    nlohmann::json plot = {{"title", "JONSWAP: Hs over fetch, measured (line) and 0.0016 \u221ax (dashed)"},
                           {"x", "fetch, km"},
                           {"y", "Hs, m"},
                           {"log", true}};
    std::vector<double> speeds;
    for (const Row& row : rows)
        if (std::find(speeds.begin(), speeds.end(), row.wind.speed) == speeds.end())
            speeds.push_back(row.wind.speed);
    for (const double speed : speeds) {
        std::vector<double> x;
        std::vector<double> measured;
        std::vector<double> published;
        for (const Row& row : rows)
            if (row.wind.speed == speed && row.result.kind == Spectrum::jonswap) {
                x.push_back(row.wind.fetch / 1000.0);
                measured.push_back(row.result.surface_height);
                published.push_back(row.result.published_height);
            }
        plot["curves"].push_back(curve(fmt::format("{:g} m/s", speed), x, measured, false));
        plot["curves"].push_back(curve(fmt::format("{:g} m/s, published", speed), x, published, true));
    }
    return plot;
}

nlohmann::json developed_plot(const std::vector<Row>& rows) {
    nlohmann::json plot = {{"title", "fully developed: Hs over wind, measured (line) and published (dashed)"},
                           {"x", "wind at 19.5 m, m/s"},
                           {"y", "Hs, m"}};
    const double longest = rows.back().wind.fetch;
    for (const Spectrum kind : {Spectrum::pierson_moskowitz, Spectrum::neumann}) {
        std::vector<double> x;
        std::vector<double> measured;
        std::vector<double> published;
        for (const Row& row : rows)
            if (row.result.kind == kind && row.wind.fetch == longest) {
                x.push_back(row.wind.speed);
                measured.push_back(row.result.surface_height);
                published.push_back(row.result.published_height);
            }
        plot["curves"].push_back(curve(name_of(kind), x, measured, false));
        plot["curves"].push_back(curve(std::string(name_of(kind)) + ", published", x, published, true));
    }
    return plot;
}

void body(bench::Report& report) {
    const AuditEffort effort = report.quick() ? AuditEffort{128, 64, 4, 60} : AuditEffort{512, 64, 8, 200};
    const std::vector<double> speeds = report.quick() ? std::vector<double>{5.0, 12.0, 25.0}
                                                      : std::vector<double>{5.0, 8.0, 12.0, 18.0, 25.0};
    const std::vector<double> fetches = report.quick() ? std::vector<double>{5e3, 80e3, 1000e3}
                                                       : std::vector<double>{5e3, 25e3, 80e3, 300e3, 1000e3};
    std::vector<Row> rows;
    for (const Spectrum kind : {Spectrum::pierson_moskowitz, Spectrum::jonswap, Spectrum::neumann})
        for (const double speed : speeds)
            for (const double fetch : fetches) {
                const AuditCase wind{speed, fetch, kind};
                rows.push_back({wind, audit(wind, effort)});
            }
    print_rows(rows);
    check_rows(rows, report);
    report.plot(spectra_plot());
    report.plot(heights_plot(rows));
    report.plot(developed_plot(rows));
    const double height = worst(
        rows, [](const Row& row) { return row.result.surface_height; },
        [](const Row& row) { return row.result.spectrum_height; });
    report.figure("worst_height_percent", height);
    report.figure("seas", static_cast<double>(rows.size()));
    report.write(fmt::format("{} seas, Hs within {:.2f} % of their spectra", rows.size(), height));
}

}  // namespace

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, body); }
