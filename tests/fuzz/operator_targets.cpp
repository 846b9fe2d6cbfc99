#include <array>
#include <filesystem>
#include <fstream>

#include "protocol/units/operator_error.hpp"
#include "server/event/scene.hpp"
#include "server/import/geotiff_file.hpp"
#include "server/import/png_file.hpp"
#include "tests/fuzz/fuzz_target.hpp"

// Files that an operator names. Whatever is in them: a value within its ranges, or one OperatorError that names the file.
namespace trochoid {

namespace {

namespace fs = std::filesystem;

/// A file of this process alone, in memory where the system has such a place.
class Scratch {
public:
    Scratch() {
        const fs::path home = fs::is_directory("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
        const auto number = reinterpret_cast<uintptr_t>(this) ^
                            static_cast<uintptr_t>(std::hash<std::string>{}(fs::current_path()));
        for (int i = 0;; ++i) {
            folder_ = home / fmt::format("trochoid-fuzz-{:x}-{}", number, i);
            if (fs::create_directory(folder_)) break;
        }
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    ~Scratch() {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
    fs::path write(const char* name, std::span<const uint8_t> content) const {
        fs::path path = folder_ / name;
        std::ofstream(path, std::ios::binary | std::ios::trunc)
            .write(reinterpret_cast<const char*>(content.data()),
                   static_cast<std::streamsize>(content.size()));
        return path;
    }

private:
    fs::path folder_;
};

const Scratch& scratch() {
    static const Scratch one;
    return one;
}

template <class Read>
void check_file(const char* name, std::span<const uint8_t> input, Read read) {
    const fs::path path = scratch().write(name, input);
    try {
        read(path);
    } catch (const OperatorError& error) {
        const std::string_view sentence = error.what();
        TROCHOID_ASSERT(sentence.find(name) != std::string_view::npos, "no file in '{}'", sentence);
        TROCHOID_ASSERT(sentence.size() > path.string().size() + 10, "no reason in '{}'", sentence);
    }
}

void check_scene(std::span<const uint8_t> input) {
    check_file("scene.toml", input, [](const fs::path& path) {
        const Scene scene = load_scene(path);
        TROCHOID_ASSERT(scene == load_scene(path), "another scene the second time");
        for (const SceneBox& box : scene.boxes)
            TROCHOID_ASSERT(box.trains.size() <= 256 && box.length >= 0 && box.width >= 0, "box '{}'",
                            box.name);
        TROCHOID_ASSERT(scene.winds.size() + scene.boxes.size() + scene.ships.size() <= 1024,
                        "too many boxes");
    });
}

/// The placement makes sense, and a corner of the raster can be read.
void check_raster(const RasterFile& file) {
    const RasterPlacement& p = file.placement();
    TROCHOID_ASSERT(p.columns > 0 && p.rows > 0, "{} x {} samples", p.columns, p.rows);
    const int64_t columns = std::min(p.columns, int64_t{16});
    const int64_t rows = std::min(p.rows, int64_t{16});
    const auto samples = file.read(p.columns - columns, p.rows - rows, columns, rows, file.stated_nodata());
    TROCHOID_ASSERT(samples.size() == static_cast<size_t>(columns * rows), "{} samples", samples.size());
    (void)file.stated_sign();
    (void)file.stated_source();
}

uint32_t big_endian(std::span<const uint8_t> bytes, size_t at) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i) value = (value << 8) | bytes[at + i];
    return value;
}

/// A picture may say that it is large; what that costs is the operator's own affair, and nothing for a fuzzer.
void check_png(std::span<const uint8_t> input) {
    constexpr uint32_t largest = 1U << 20;
    if (input.size() > 24) {
        const uint64_t samples = uint64_t{big_endian(input, 16)} * big_endian(input, 20);
        if (samples > largest) return;
    }
    static const fs::path sidecar = [] {
        const std::string_view text =
            "height_scale = 0.5\nheight_offset = -64.0\nbounds = [-6.6, 49.8, -6.1, 50.0]\n";
        return scratch().write("raster.toml", {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
    }();
    check_file("raster.png", input, [](const fs::path& path) { check_raster(PngFile(path)); });
}

uint32_t crc32(std::span<const uint8_t> bytes) {
    uint32_t crc = UINT32_MAX;
    for (const uint8_t b : bytes) {
        crc ^= b;
        for (int i = 0; i < 8; ++i) crc = (crc >> 1) ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
    }
    return ~crc;
}

/// The checksums of all chunks.
void repair_png(std::span<uint8_t> input) {
    for (size_t at = 8; at + 12 <= input.size();) {
        const size_t length = big_endian(input, at);
        if (length > input.size() - at - 12) return;
        const uint32_t crc = crc32(input.subspan(at + 4, 4 + length));
        for (size_t i = 0; i < 4; ++i) input[at + 8 + length + i] = static_cast<uint8_t>(crc >> (24 - 8 * i));
        at += 12 + length;
    }
}

void check_geotiff(std::span<const uint8_t> input) {
    check_file("raster.tif", input, [](const fs::path& path) { check_raster(GeotiffFile(path)); });
}

}  // namespace

const FuzzTarget scene_target{"scene", check_scene, 4096};
const FuzzTarget png_target{"png", check_png, 2048, nullptr, repair_png};
const FuzzTarget geotiff_target{"geotiff", check_geotiff, 2048};

}  // namespace trochoid
