#include "server/import/raster_import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "protocol/units/lattice.hpp"
#include "protocol/units/operator_error.hpp"
#include "server/import/raster_file.hpp"

namespace trochoid {
namespace {

/// Samples that one import may hold (1 GiB of floats).
constexpr double window_samples_max = 268'435'456.0;
/// Pixels by which a place may miss the outer samples' centres: half a pixel, and a little for rounding.
constexpr double rim = 0.5 + 1e-6;

/// A position in the raster, in samples from the centre of the first one. On a raster around the globe columns may
/// lie beyond the ends; they mean the same column a turn away.
struct RasterPoint {
    double column = 0.0;
    double row = 0.0;
};

/// From places on earth to raster positions.
class RasterLocator {
public:
    RasterLocator(const RasterPlacement& placement, LonLat origin) : placement_(placement), origin_(origin) {
        if (!placement.projection.empty())
            projection_ = std::make_unique<ProjConversion>(placement.projection);
        const double period = 360.0 / std::fabs(placement.a[1]);
        const bool straight = placement.a[2] == 0.0 && placement.a[4] == 0.0;
        const bool whole = std::fabs(period - std::round(period)) < 0.01;
        if (!projection_ && straight && whole && static_cast<double>(placement.columns) >= std::round(period))
            columns_around_ = static_cast<int64_t>(std::round(period));
    }

    /// Columns of a full turn; 0 where the raster does not go around the globe.
    int64_t columns_around() const { return columns_around_; }

    /// Raster positions of the places; on a raster in longitudes, on that turn on which the origin lies inside it.
    std::vector<RasterPoint> locate(const std::vector<LonLat>& places) const {
        const double turn = projection_ ? 0.0 : best_turn();
        std::vector<RasterPoint> points;
        points.reserve(places.size());
        for (const LonLat& place : places) {
            // Continuous around the origin, so that a seam between two places does not tear them apart.
            const double lon = origin_.lon + wrap_degrees(place.lon - origin_.lon) + turn;
            points.push_back(projection_ ? from_source(projection_->forward(place))
                                         : from_source({lon, place.lat}));
        }
        return points;
    }

    bool covers(RasterPoint p) const {
        const bool column_in =
            columns_around_ != 0 ||
            (p.column >= -rim && p.column <= static_cast<double>(placement_.columns) - 1.0 + rim);
        return column_in && p.row >= -rim && p.row <= static_cast<double>(placement_.rows) - 1.0 + rim;
    }

    /// The raster's outline for a message.
    std::string bounds_text() const {
        double west = std::numeric_limits<double>::infinity(), east = -west, south = west, north = -west;
        for (const double c : {-0.5, static_cast<double>(placement_.columns) - 0.5}) {
            for (const double r : {-0.5, static_cast<double>(placement_.rows) - 0.5}) {
                const auto& a = placement_.a;
                const EastNorth source{a[0] + a[1] * c + a[2] * r, a[3] + a[4] * c + a[5] * r};
                const LonLat corner =
                    projection_ ? projection_->inverse(source) : LonLat{source.east, source.north};
                west = std::min(west, corner.lon);
                east = std::max(east, corner.lon);
                south = std::min(south, corner.lat);
                north = std::max(north, corner.lat);
            }
        }
        return fmt::format("longitude {:.6g} to {:.6g}, latitude {:.6g} to {:.6g}", west, east, south, north);
    }

private:
    RasterPoint from_source(EastNorth source) const {
        const auto& a = placement_.a;
        const double x = source.east - a[0];
        const double y = source.north - a[3];
        const double determinant = a[1] * a[5] - a[2] * a[4];
        return {(x * a[5] - y * a[2]) / determinant, (y * a[1] - x * a[4]) / determinant};
    }

    /// Whole turns, in degrees, that bring the origin into the raster's longitudes.
    double best_turn() const {
        for (const double turn : {0.0, 360.0, -360.0, 720.0, -720.0}) {
            const RasterPoint at = from_source({origin_.lon + turn, origin_.lat});
            if (at.column >= -rim && at.column <= static_cast<double>(placement_.columns) - 1.0 + rim)
                return turn;
        }
        return 0.0;
    }

    RasterPlacement placement_;
    LonLat origin_;
    std::unique_ptr<ProjConversion> projection_;
    int64_t columns_around_ = 0;
};

/// The part of a raster that an import touches.
struct Window {
    int64_t column = 0;
    int64_t row = 0;
    int64_t columns = 0;
    int64_t rows = 0;
    std::vector<float> samples;
};

Window enclosing_window(const std::vector<RasterPoint>& points, const RasterPlacement& placement,
                        bool around) {
    double first_column = points[0].column, last_column = first_column;
    double first_row = points[0].row, last_row = first_row;
    for (const RasterPoint& p : points) {
        first_column = std::min(first_column, p.column);
        last_column = std::max(last_column, p.column);
        first_row = std::min(first_row, p.row);
        last_row = std::max(last_row, p.row);
    }
    // One sample more all round, so that filling sees the neighbours.
    double west = std::floor(first_column) - 1.0, east = std::floor(last_column) + 2.0;
    if (!around) {
        west = std::max(west, 0.0);
        east = std::min(east, static_cast<double>(placement.columns) - 1.0);
    }
    const double top = std::max(std::floor(first_row) - 1.0, 0.0);
    const double bottom = std::min(std::floor(last_row) + 2.0, static_cast<double>(placement.rows) - 1.0);
    if ((east - west + 1.0) * (bottom - top + 1.0) > window_samples_max)
        throw OperatorError(
            "the extent covers more than 268 million raster samples: give a smaller --extent or a coarser raster "
            "(gdalwarp -r average -tr)");
    return {static_cast<int64_t>(west),
            static_cast<int64_t>(top),
            static_cast<int64_t>(east - west) + 1,
            static_cast<int64_t>(bottom - top) + 1,
            {}};
}

/// Reads the window, on a raster around the globe piece by piece from seam to seam.
void read_window(const RasterFile& file, int64_t columns_around, std::optional<double> nodata,
                 Window& window) {
    if (columns_around == 0) {
        window.samples = file.read(window.column, window.row, window.columns, window.rows, nodata);
        return;
    }
    window.samples.resize(static_cast<std::size_t>(window.columns * window.rows));
    for (int64_t done = 0; done < window.columns;) {
        const int64_t position = window.column + done;
        const int64_t column = ((position % columns_around) + columns_around) % columns_around;
        const int64_t count = std::min(window.columns - done, columns_around - column);
        const std::vector<float> piece = file.read(column, window.row, count, window.rows, nodata);
        for (int64_t row = 0; row < window.rows; ++row)
            std::copy_n(piece.begin() + row * count, count,
                        window.samples.begin() + row * window.columns + done);
        done += count;
    }
}

double bilinear(const Window& window, RasterPoint p) {
    // Between the outermost samples' centres and the raster's rim the outermost samples hold.
    const double x = std::clamp(p.column - static_cast<double>(window.column), 0.0,
                                static_cast<double>(window.columns) - 1.0);
    const double y =
        std::clamp(p.row - static_cast<double>(window.row), 0.0, static_cast<double>(window.rows) - 1.0);
    const int64_t column = std::min(static_cast<int64_t>(x), window.columns - 2);
    const int64_t row = std::min(static_cast<int64_t>(y), window.rows - 2);
    const double fx = x - static_cast<double>(column);
    const double fy = y - static_cast<double>(row);
    const auto at = [&](int64_t c, int64_t r) {
        return static_cast<double>(window.samples[static_cast<std::size_t>(r * window.columns + c)]);
    };
    return std::lerp(std::lerp(at(column, row), at(column + 1, row), fx),
                     std::lerp(at(column, row + 1), at(column + 1, row + 1), fx), fy);
}

/// Whether values count downwards; adds to the notes why.
bool positive_down(const RasterRequest& request, StatedSign stated, const std::vector<float>& samples,
                   std::vector<std::string>& notes) {
    if (request.sign != RasterSign::automatic) return request.sign == RasterSign::down;
    if (stated != StatedSign::none) {
        const bool down = stated == StatedSign::positive_down;
        notes.push_back(
            fmt::format("values taken as positive {}, as the file describes them", down ? "down" : "up"));
        return down;
    }
    const auto [low, high] = std::minmax_element(samples.begin(), samples.end());
    if (*low >= 0.0F && *high > 0.0F)
        throw OperatorError(
            "all values here are positive, which may mean depths or land: say --positive down or --positive up");
    notes.emplace_back(
        "values taken as positive up, since some are negative: give --positive down if land came out as sea");
    return false;
}

void check_coverage(const RasterLocator& locator, const std::vector<RasterPoint>& points,
                    const std::filesystem::path& path) {
    const auto outside =
        std::count_if(points.begin(), points.end(), [&](RasterPoint p) { return !locator.covers(p); });
    if (outside > 0)
        throw OperatorError(fmt::format(
            "{:.3g} % of the wanted area lie outside the raster {}, which covers {}: give another --origin or a smaller "
            "--extent",
            100.0 * static_cast<double>(outside) / static_cast<double>(points.size()), path.string(),
            locator.bounds_text()));
}

void fill_window(Window& window, const std::filesystem::path& path, std::vector<std::string>& notes) {
    const auto missing =
        std::count_if(window.samples.begin(), window.samples.end(), [](float v) { return std::isnan(v); });
    const double share = static_cast<double>(missing) / static_cast<double>(window.samples.size());
    if (share > 0.5)
        throw OperatorError(fmt::format(
            "{}: {:.3g} % of the samples here are missing, more than half: give another raster or "
            "place",
            path.string(), 100.0 * share));
    const std::size_t filled = fill_missing(window.samples, window.columns, window.rows);
    if (filled > 0)
        notes.push_back(
            fmt::format("{} missing samples ({:.3g} %) filled from their neighbours", filled, 100.0 * share));
}

/// A note where the raster is much finer than the grid, so that bilinear sampling skips samples.
void note_skipped_samples(const std::vector<RasterPoint>& points, std::vector<std::string>& notes) {
    const double step = std::hypot(points[1].column - points[0].column, points[1].row - points[0].row);
    if (step > 2.0)
        notes.push_back(fmt::format(
            "the raster is {:.1f} times finer than the grid and was not averaged: a finer --spacing or "
            "gdalwarp -r average keeps its detail",
            step));
}

}  // namespace

std::size_t fill_missing(std::vector<float>& samples, int64_t columns, int64_t rows) {
    std::vector<int64_t> missing;
    for (std::size_t i = 0; i < samples.size(); ++i)
        if (std::isnan(samples[i])) missing.push_back(static_cast<int64_t>(i));
    std::size_t filled = 0;
    while (!missing.empty()) {
        std::vector<std::pair<int64_t, float>> ring;
        std::vector<int64_t> still_missing;
        for (const int64_t index : missing) {
            double sum = 0.0;
            int known = 0;
            for (int64_t row = std::max<int64_t>(index / columns - 1, 0);
                 row <= std::min(index / columns + 1, rows - 1); ++row) {
                for (int64_t column = std::max<int64_t>(index % columns - 1, 0);
                     column <= std::min(index % columns + 1, columns - 1); ++column) {
                    const float value = samples[static_cast<std::size_t>(row * columns + column)];
                    if (std::isnan(value)) continue;
                    sum += value;
                    ++known;
                }
            }
            if (known == 0)
                still_missing.push_back(index);
            else
                ring.emplace_back(index, static_cast<float>(sum / known));
        }
        if (ring.empty()) break;
        for (const auto& [index, value] : ring) samples[static_cast<std::size_t>(index)] = value;
        filled += ring.size();
        missing = std::move(still_missing);
    }
    return filled;
}

ImportedTerrain import_raster(const std::filesystem::path& raster, const RasterRequest& request) {
    const std::unique_ptr<RasterFile> opened = open_raster(raster, request.variable);
    const RasterFile& file = *opened;
    const WorldMap map(request.grid.projection, request.grid.origin);
    ImportedTerrain result;
    result.grid = plan_grid(request.grid, map);
    std::vector<std::string> notes;

    const RasterLocator locator(file.placement(), request.grid.origin);
    const std::vector<RasterPoint> points = locator.locate(sample_places(result.grid, map));
    check_coverage(locator, points, raster);
    note_skipped_samples(points, notes);
    Window window = enclosing_window(points, file.placement(), locator.columns_around() != 0);
    const std::optional<double> nodata = request.nodata ? request.nodata : file.stated_nodata();
    read_window(file, locator.columns_around(), nodata, window);
    fill_window(window, raster, notes);

    const double sign = positive_down(request, file.stated_sign(), window.samples, notes) ? -1.0 : 1.0;
    std::vector<double> metres;
    metres.reserve(points.size());
    for (const RasterPoint& point : points) metres.push_back(sign * bilinear(window, point));
    store_heights(result.grid, metres);
    set_open_sea(result.grid, request.open_depth);
    const std::string source = file.stated_source();
    result.grid.provenance = fmt::format("Heights: {}, positive {}.{}{}", raster.filename().string(),
                                         sign < 0.0 ? "down" : "up", source.empty() ? "" : " ", source);
    result.report = describe_heights(result.grid);
    result.report.notes = std::move(notes);
    return result;
}

}  // namespace trochoid
