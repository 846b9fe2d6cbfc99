#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace trochoid {

/// Where a raster's samples lie.
struct RasterPlacement {
    int64_t columns = 0;
    int64_t rows = 0;
    /// Source coordinates of the centre of sample (c, r): x = a[0] + a[1] c + a[2] r, y = a[3] + a[4] c + a[5] r.
    /// Degrees of longitude and latitude, or metres of `projection`. Row order and pixel-is-area or -point are in here.
    std::array<double, 6> a{};
    /// PROJ string of the source's projection; empty for longitude and latitude.
    std::string projection;
};

/// What the file itself says about the sign of its values.
enum class StatedSign { none, positive_up, positive_down };

/// One band of heights in a GeoTIFF (stripped or tiled; 8, 16, 32-bit integers, 32 and 64-bit floats; any
/// compression that this libtiff has).
class GeotiffFile {
public:
    /// Throws OperatorError for a missing or unreadable file, one without georeference, with several bands or with
    /// samples that are no heights.
    explicit GeotiffFile(const std::filesystem::path& path);
    ~GeotiffFile();
    GeotiffFile(const GeotiffFile&) = delete;
    GeotiffFile& operator=(const GeotiffFile&) = delete;

    const RasterPlacement& placement() const;
    /// Value of GDAL's nodata tag.
    std::optional<double> stated_nodata() const;
    /// From the descriptions in the file ("positive=down", "depth", "elevation", ...).
    StatedSign stated_sign() const;

    /// Samples of a rectangle inside the raster, row-major in the file's row order; NaN where a value is NaN or equals
    /// `nodata` (compared in the file's sample type). Throws OperatorError for damaged data.
    std::vector<float> read(int64_t column, int64_t row, int64_t columns, int64_t rows,
                            std::optional<double> nodata) const;

private:
    struct Handle;
    std::unique_ptr<Handle> handle_;
};

}  // namespace trochoid
