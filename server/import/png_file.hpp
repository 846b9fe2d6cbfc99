#pragma once

#include "server/import/raster_file.hpp"

namespace trochoid {

/// Heights in a 16-bit grayscale PNG, with a TOML file beside it (the same name, ending in .toml) that says where and how
/// high they are:
///
///     height_scale  = 0.03125          # metres a count, above 0 (required)
///     height_offset = -64.0            # metres of count 0 (required)
///     positive      = "up"             # or "down": depths (default "up")
///     nodata        = 0                # count of missing samples (default: none)
///     projection    = "+proj=tmerc …"  # PROJ string in metres (default: longitude and latitude in degrees)
///     bounds        = [-6.6, 49.8, -6.1, 50.0]  # west, south, east, north: outer edges of the outer pixels; or
///     origin        = [-6.6, 50.0]     # west and north edge of the first pixel, with
///     pixel_size    = [0.001, 0.001]   # eastwards and southwards, above 0
///     source        = "own survey"     # for the record (default: nothing)
///
/// Row 0 is the northern one. Unknown keys are refused.
class PngFile final : public RasterFile {
public:
    static constexpr int64_t side_max = 32'768;
    static constexpr int64_t samples_max = 268'435'456;

    /// Reads both files whole. Throws OperatorError for a picture that is not 16-bit grayscale or is damaged, a missing
    /// sidecar, and keys that are missing, unknown or senseless.
    explicit PngFile(const std::filesystem::path& path);

    const RasterPlacement& placement() const override { return placement_; }
    std::optional<double> stated_nodata() const override { return nodata_; }
    StatedSign stated_sign() const override { return sign_; }
    std::string stated_source() const override { return source_; }
    std::vector<float> read(int64_t column, int64_t row, int64_t columns, int64_t rows,
                            std::optional<double> nodata) const override;

private:
    void read_sidecar(const std::filesystem::path& path);

    RasterPlacement placement_;
    std::vector<uint16_t> counts_;
    double scale_ = 1.0;
    double offset_ = 0.0;
    std::optional<double> nodata_;
    StatedSign sign_ = StatedSign::positive_up;
    std::string source_;
};

}  // namespace trochoid
