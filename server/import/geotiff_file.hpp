#pragma once

#include "server/import/raster_file.hpp"

namespace trochoid {

/// One band of heights in a GeoTIFF (stripped or tiled; 8, 16, 32-bit integers, 32 and 64-bit floats; any
/// compression that this libtiff has).
class GeotiffFile final : public RasterFile {
public:
    /// Throws OperatorError for a missing or unreadable file, one without georeference, with several bands or with
    /// samples that are no heights.
    explicit GeotiffFile(const std::filesystem::path& path);
    ~GeotiffFile() override;

    const RasterPlacement& placement() const override;
    /// Value of GDAL's nodata tag.
    std::optional<double> stated_nodata() const override;
    /// From the descriptions in the file ("positive=down", "depth", "elevation", ...).
    StatedSign stated_sign() const override;
    std::vector<float> read(int64_t column, int64_t row, int64_t columns, int64_t rows,
                            std::optional<double> nodata) const override;

private:
    struct Handle;
    std::unique_ptr<Handle> handle_;
};

}  // namespace trochoid
