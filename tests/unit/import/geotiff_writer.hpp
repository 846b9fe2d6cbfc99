#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace trochoid {

/// A small GeoTIFF for a test. Sample (c, r) lies at x = first_x + c * step_x, y = first_y + r * step_y (its centre), and
/// holds height(x, y).
struct GeotiffSpec {
    enum class Type { uint8, int16, uint16, int32, float32, float64, int64 };
    enum class Georeference { scale, matrix, none, no_system, control_points };

    uint32_t columns = 0;
    uint32_t rows = 0;
    double first_x = 0.0;
    double first_y = 0.0;
    double step_x = 0.0;
    double step_y = 0.0;  ///< negative: north-up
    std::function<double(double, double)> height;
    Type type = Type::float32;
    Georeference georeference = Georeference::scale;
    bool pixel_is_point = false;
    bool tiled = false;
    bool deflate = false;
    bool big_endian = false;
    uint16_t bands = 1;
    int projected_epsg = 0;   ///< 0: longitude and latitude (EPSG:4326)
    int vertical_epsg = 0;    ///< 0: none
    std::string nodata;       ///< GDAL's nodata tag
    std::string description;  ///< ImageDescription
};

void write_geotiff(const std::filesystem::path& path, const GeotiffSpec& spec);

/// A fresh folder that vanishes with the object.
class ScratchFolder {
public:
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
    std::filesystem::path path_;
};

/// Runs the function and returns the message of the OperatorError that it throws; empty where it throws none.
std::string operator_error_of(const std::function<void()>& function);

}  // namespace trochoid
