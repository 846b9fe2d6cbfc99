#pragma once

#include "server/import/raster_file.hpp"

namespace trochoid {

/// A grid of heights in a netCDF file (classic, 64-bit or netCDF-4), as GEBCO, ETOPO and GMT write them: a variable over
/// evenly spaced 1-D coordinates in degrees, named lat/lon, latitude/longitude or y/x or with CF's units (latitudes and longitudes may run either way
/// and longitudes over a seam), 8, 16, 32-bit integers or floats, with scale_factor, add_offset, _FillValue and missing_value.
class NetcdfFile final : public RasterFile {
public:
    /// The largest dimension taken; beyond it lies a damaged header.
    static constexpr std::size_t side_max = 4'000'000;

    /// `variable` names the one with the heights; empty takes elevation, z, Band1 or another well-known name, or the only
    /// one that lies over such coordinates. Throws OperatorError where there is none or more than one, and for
    /// coordinates that are missing, uneven or not in degrees.
    NetcdfFile(const std::filesystem::path& path, const std::string& variable);
    ~NetcdfFile() override;

    const RasterPlacement& placement() const override;
    /// _FillValue, else netCDF's default for the type (none for bytes). missing_value counts beside it.
    std::optional<double> stated_nodata() const override;
    /// From `positive`, the names and the long name.
    StatedSign stated_sign() const override;
    std::vector<float> read(int64_t column, int64_t row, int64_t columns, int64_t rows,
                            std::optional<double> nodata) const override;

private:
    struct Handle;
    std::unique_ptr<Handle> handle_;
};

}  // namespace trochoid
