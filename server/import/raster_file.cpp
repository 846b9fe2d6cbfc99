#include "server/import/raster_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>

#include "protocol/units/operator_error.hpp"
#include "server/import/geotiff_file.hpp"
#include "server/import/netcdf_file.hpp"
#include "server/import/png_file.hpp"

namespace trochoid {

void refuse_raster(const std::filesystem::path& path, std::string_view why) {
    throw OperatorError(fmt::format("{}: {}", path.string(), why));
}

StatedSign sign_in_text(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const std::size_t at = text.find("positive");
    if (at != std::string::npos) {
        const std::string after = text.substr(at, 24);
        if (after.find("down") != std::string::npos) return StatedSign::positive_down;
        if (after.find("up") != std::string::npos) return StatedSign::positive_up;
    }
    const auto has = [&](const char* word) { return text.find(word) != std::string::npos; };
    const bool up = has("elevation") || has("altitude") || has("height");
    const bool down = has("depth");
    if (up == down) return StatedSign::none;
    return up ? StatedSign::positive_up : StatedSign::positive_down;
}

std::unique_ptr<RasterFile> open_raster(const std::filesystem::path& path, const std::string& variable) {
    std::error_code failure;
    if (!std::filesystem::is_regular_file(path, failure))
        throw OperatorError(fmt::format("cannot open the raster {}: check the path", path.string()));
    std::ifstream file(path, std::ios::binary);
    std::array<char, 8> first{};
    file.read(first.data(), first.size());
    const std::string_view start(first.data(), static_cast<std::size_t>(file.gcount()));
    const auto begins_with = [&](std::string_view mark) { return start.substr(0, mark.size()) == mark; };

    const bool netcdf = (begins_with("CDF") && start.size() > 3) || begins_with("\x89HDF\r\n\x1a\n");
    if (!variable.empty() && !netcdf)
        refuse_raster(path, "only netCDF files have variables to choose from: leave out --variable");
    if (netcdf) return std::make_unique<NetcdfFile>(path, variable);
    if (begins_with("\x89PNG\r\n\x1a\n")) return std::make_unique<PngFile>(path);
    if (begins_with("II") || begins_with("MM")) return std::make_unique<GeotiffFile>(path);
    refuse_raster(
        path, "this is no TIFF, netCDF or PNG, by its first bytes: convert it with gdal_translate -of GTiff");
}

}  // namespace trochoid
