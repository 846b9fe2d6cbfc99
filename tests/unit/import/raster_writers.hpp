#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace trochoid {

/// A small netCDF for a test. Sample (c, r) lies at x = first_x + c * step_x, y = first_y + r * step_y and holds
/// height(x, y), packed as (height - add_offset) / scale_factor.
struct NetcdfSpec {
    enum class Format { classic, offset_64, data_64, netcdf4 };

    std::size_t columns = 0;
    std::size_t rows = 0;
    double first_x = 0.0;
    double first_y = 0.0;
    double step_x = 0.0;
    double step_y = 0.0;
    std::function<double(double, double)> height;
    Format format = Format::netcdf4;
    int type = 0;  ///< nc_type; 0: NC_SHORT
    std::string x_name = "lon";
    std::string y_name = "lat";
    std::string variable = "elevation";
    std::string units = "m";
    std::string axis_units = "degrees";  ///< of both axes; empty: no attribute; CF: degrees_east and _north
    std::string positive;                ///< attribute of that name; empty: none
    bool float_axes = false;             ///< coordinates stored as 32-bit floats
    bool wrapped = false;                ///< longitudes written as -180..180, so that they jump
    bool with_time = false;              ///< a leading dimension of length 1
    bool transposed = false;             ///< dimensions in the order x, y
    bool without_axes = false;           ///< dimensions without coordinate variables
    std::optional<double> fill;
    std::optional<double> missing;
    double scale_factor = 1.0;
    double add_offset = 0.0;
    double bend = 0.0;      ///< moves the last latitude by this many steps
    std::string also;       ///< a second variable of this name over the same axes
    std::size_t chunk = 0;  ///< netcdf4: side of compressed chunks; 0: contiguous
};
void write_netcdf(const std::filesystem::path& path, const NetcdfSpec& spec);

/// Writes a grayscale PNG of 8 or 16 bits, or with alpha or as RGB; `interlaced` in Adam7 order.
struct PngSpec {
    uint32_t columns = 0;
    uint32_t rows = 0;
    std::function<uint16_t(uint32_t, uint32_t)> count;  ///< of column and row
    int bits = 16;
    int colour_type = 0;  ///< PNG_COLOR_TYPE_*
    bool interlaced = false;
};
void write_png(const std::filesystem::path& path, const PngSpec& spec);

}  // namespace trochoid
