#include "server/import/terrain_path.hpp"

#include <fmt/format.h>

#include <fstream>
#include <system_error>
#include <vector>

#include "protocol/model/terrain_file.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {
namespace {

/// The largest legal file: 16385 x 16385 samples, two texts, fixed members.
constexpr std::uintmax_t file_bytes_max = std::uintmax_t{16385} * 16385 * 2 + 2 * terrain_text_max + 256;

}  // namespace

TerrainGrid read_terrain(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw OperatorError(fmt::format("cannot open the terrain {}: check the path", path.string()));
    std::error_code failure;
    const std::uintmax_t size = std::filesystem::file_size(path, failure);
    if (failure || size > file_bytes_max)
        throw OperatorError(fmt::format("{} is no terrain: make one with trochoid-import", path.string()));
    std::vector<uint8_t> bytes(static_cast<std::size_t>(size));
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!file) throw OperatorError(fmt::format("cannot read the terrain {}: check the disk", path.string()));
    Result<TerrainGrid> grid = decode_terrain(bytes);
    if (!grid) throw OperatorError(fmt::format("{}: {}", path.string(), grid.error().message));
    return std::move(grid).value();
}

void write_terrain(const std::filesystem::path& path, const TerrainGrid& grid) {
    // Renaming over a device or a pipe would replace it.
    std::error_code unknown;
    if (std::filesystem::exists(path, unknown) && !std::filesystem::is_regular_file(path, unknown))
        throw OperatorError(
            fmt::format("'{}' is no regular file: name a file to write the terrain to", path.string()));
    const std::vector<uint8_t> bytes = encode_terrain(grid);
    std::filesystem::path partial = path;
    partial += ".partial";
    std::ofstream file(partial, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    file.close();
    std::error_code failure;
    if (file) std::filesystem::rename(partial, path, failure);
    if (!file || failure) {
        std::error_code ignored;
        std::filesystem::remove(partial, ignored);
        throw OperatorError(
            fmt::format("cannot write the terrain {}: check that its folder exists, may be written to and "
                        "has space",
                        path.string()));
    }
}

}  // namespace trochoid
