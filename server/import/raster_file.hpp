#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
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

/// One band of heights or depths in metres, whatever the format that holds it.
class RasterFile {
public:
    RasterFile() = default;
    RasterFile(const RasterFile&) = delete;
    RasterFile& operator=(const RasterFile&) = delete;
    virtual ~RasterFile() = default;

    virtual const RasterPlacement& placement() const = 0;
    /// The file's own mark of missing samples, as the file holds it (before any scale and offset).
    virtual std::optional<double> stated_nodata() const = 0;
    virtual StatedSign stated_sign() const = 0;
    /// Where the file says that its heights come from; empty where it does not.
    virtual std::string stated_source() const { return {}; }

    /// Samples of a rectangle inside the raster, row-major in the file's row order, metres; NaN where a value is NaN or
    /// equals `nodata` (compared in the file's sample type, before scale and offset). Throws OperatorError for damaged
    /// data.
    virtual std::vector<float> read(int64_t column, int64_t row, int64_t columns, int64_t rows,
                                    std::optional<double> nodata) const = 0;
};

/// Opens a GeoTIFF, a netCDF or a PNG with its sidecar; which of them the first bytes say, not the name. `variable`: of a
/// netCDF, the one with the heights; empty chooses. Throws OperatorError for a missing or unreadable file, and for all that
/// the format's own class refuses.
std::unique_ptr<RasterFile> open_raster(const std::filesystem::path& path, const std::string& variable = {});

/// Looks for "positive ... up" or "down" and for words of height or depth.
StatedSign sign_in_text(std::string text);

/// Throws OperatorError "PATH: why".
[[noreturn]] void refuse_raster(const std::filesystem::path& path, std::string_view why);

}  // namespace trochoid
