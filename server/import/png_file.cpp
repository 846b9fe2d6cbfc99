#include "server/import/png_file.hpp"

#include <fmt/format.h>
#include <png.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <limits>

#include "protocol/units/operator_error.hpp"
#include "server/import/map_projection.hpp"

namespace trochoid {
namespace {

struct FileClose {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

/// libpng's reading state. Its errors jump to where setjmp was called, so the functions that call it hold nothing that
/// wants destroying.
struct Decoder {
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::array<char, 160> complaint{};

    Decoder() {
        png = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, &keep_complaint, &ignore_warning);
        if (png) info = png_create_info_struct(png);
        if (!info) throw std::bad_alloc();
        png_set_user_limits(png, PngFile::side_max, PngFile::side_max);
    }
    ~Decoder() { png_destroy_read_struct(&png, &info, nullptr); }
    Decoder(const Decoder&) = delete;
    Decoder& operator=(const Decoder&) = delete;

    static void keep_complaint(png_structp png, png_const_charp text) {
        auto* decoder = static_cast<Decoder*>(png_get_error_ptr(png));
        std::snprintf(decoder->complaint.data(), decoder->complaint.size(), "%s", text);
        png_longjmp(png, 1);
    }
    static void ignore_warning(png_structp, png_const_charp) {}

    bool read_header(std::FILE* file) {
        // NOLINTNEXTLINE(cert-err52-cpp): libpng's way to report errors.
        if (setjmp(png_jmpbuf(png)) != 0) return false;
        png_init_io(png, file);
        png_read_info(png, info);
        if constexpr (std::endian::native == std::endian::little) png_set_swap(png);
        png_set_interlace_handling(png);
        png_read_update_info(png, info);
        return true;
    }
    bool read_rows(png_bytepp rows) {
        // NOLINTNEXTLINE(cert-err52-cpp): libpng's way to report errors.
        if (setjmp(png_jmpbuf(png)) != 0) return false;
        png_read_image(png, rows);
        png_read_end(png, nullptr);
        return true;
    }
};

/// A sidecar's values, with complaints that name file and key.
class Sidecar {
public:
    explicit Sidecar(std::filesystem::path path) : path_(std::move(path)) {
        std::error_code failure;
        if (!std::filesystem::is_regular_file(path_, failure))
            throw OperatorError(
                fmt::format("{} is missing: a PNG of heights needs this file beside it, with height_scale, "
                            "height_offset and bounds (trochoid-import raster --help)",
                            path_.string()));
        try {
            table_ = toml::parse_file(path_.string());
        } catch (const toml::parse_error& error) {
            throw OperatorError(fmt::format("{}:{}: not TOML: {}: correct this line", path_.string(),
                                            error.source().begin.line, error.description()));
        }
        constexpr std::array<std::string_view, 9> known{"height_scale", "height_offset", "positive",
                                                        "nodata",       "projection",    "bounds",
                                                        "origin",       "pixel_size",    "source"};
        for (const auto& [key, value] : table_)
            if (std::find(known.begin(), known.end(), key.str()) == known.end())
                refuse(key.str(), "is unknown: remove it");
    }

    bool has(std::string_view key) const { return table_.contains(key); }

    std::optional<double> number(std::string_view key) const {
        if (!has(key)) return {};
        const auto value = table_[key].value<double>();
        if (!value || !std::isfinite(*value)) refuse(key, "is no number: give one");
        return value;
    }
    std::optional<std::string> text(std::string_view key) const {
        if (!has(key)) return {};
        auto value = table_[key].value<std::string>();
        if (!value || value->size() > 1024) refuse(key, "is no text of at most 1024 bytes: give one");
        return value;
    }
    template <std::size_t n>
    std::array<double, n> numbers(std::string_view key, std::string_view meaning) const {
        std::array<double, n> values{};
        const toml::array* list = table_[key].as_array();
        bool good = list && list->size() == n;
        for (std::size_t i = 0; good && i < n; ++i) {
            const auto value = (*list)[i].value<double>();
            good = value && std::isfinite(*value);
            if (good) values[i] = *value;
        }
        if (!good) refuse(key, fmt::format("is not [{}]: give these {} numbers", meaning, n));
        return values;
    }

    [[noreturn]] void refuse(std::string_view key, std::string_view complaint) const {
        throw OperatorError(fmt::format("{}: {} {}", path_.string(), key, complaint));
    }

private:
    std::filesystem::path path_;
    toml::table table_;
};

/// Outer edges, from `bounds` or from `origin` and `pixel_size`.
std::array<double, 6> placement_of(const Sidecar& sidecar, double columns, double rows) {
    double west = 0.0, north = 0.0, across = 0.0, down = 0.0;
    if (sidecar.has("bounds")) {
        if (sidecar.has("origin") || sidecar.has("pixel_size"))
            sidecar.refuse("bounds", "stands beside origin or pixel_size: keep bounds, or those two");
        const auto edge = sidecar.numbers<4>("bounds", "west, south, east, north");
        west = edge[0];
        north = edge[3];
        across = (edge[2] - edge[0]) / columns;
        down = (edge[3] - edge[1]) / rows;
        if (!(across > 0.0 && down > 0.0))
            sidecar.refuse("bounds",
                           "has east not above west or north not above south (over the date line east "
                           "goes beyond 180): correct it");
    } else if (sidecar.has("origin") && sidecar.has("pixel_size")) {
        const auto corner = sidecar.numbers<2>("origin", "west, north");
        const auto size = sidecar.numbers<2>("pixel_size", "eastwards, southwards");
        west = corner[0];
        north = corner[1];
        across = size[0];
        down = size[1];
        if (!(across > 0.0 && down > 0.0))
            sidecar.refuse("pixel_size", "is not above 0 both ways: correct it");
    } else {
        sidecar.refuse("bounds",
                       "is missing: give bounds = [west, south, east, north], or origin and pixel_size");
    }
    if (!sidecar.has("projection") && !(std::fabs(west) <= 540.0 && across * columns <= 360.01 &&
                                        north <= 90.01 && north - down * rows >= -90.01))
        sidecar.refuse(sidecar.has("bounds") ? "bounds" : "origin",
                       "does not lie on the globe, in degrees: correct it, or name the projection");
    return {west + 0.5 * across, across, 0.0, north - 0.5 * down, 0.0, -down};
}

}  // namespace

PngFile::PngFile(const std::filesystem::path& path) {
    const std::unique_ptr<std::FILE, FileClose> file(std::fopen(path.c_str(), "rb"));
    if (!file) throw OperatorError(fmt::format("cannot open the raster {}: check the path", path.string()));
    Decoder decoder;
    const auto damaged = [&] {
        refuse_raster(path, fmt::format("the PNG is damaged or too large ({}): fetch it again",
                                        decoder.complaint.data()));
    };
    if (!decoder.read_header(file.get())) damaged();
    const int depth = png_get_bit_depth(decoder.png, decoder.info);
    const int channels = png_get_channels(decoder.png, decoder.info);
    if (depth != 16 || channels != 1)
        refuse_raster(path,
                      fmt::format("a PNG of {} channels of {} bits is no raster of heights: write 16-bit "
                                  "grayscale without alpha (gdal_translate -of PNG -ot UInt16)",
                                  channels, depth));
    placement_.columns = png_get_image_width(decoder.png, decoder.info);
    placement_.rows = png_get_image_height(decoder.png, decoder.info);
    if (placement_.columns < 2 || placement_.rows < 2)
        refuse_raster(path, "the raster has fewer than 2 columns or rows: give one with heights");
    if (placement_.columns * placement_.rows > samples_max)
        refuse_raster(path, "the PNG has more than 268 million samples: cut the region out first");
    read_sidecar(std::filesystem::path(path).replace_extension(".toml"));

    counts_.resize(static_cast<std::size_t>(placement_.columns * placement_.rows));
    std::vector<png_bytep> rows;
    for (int64_t row = 0; row < placement_.rows; ++row)
        rows.push_back(reinterpret_cast<png_bytep>(counts_.data() + row * placement_.columns));
    if (!decoder.read_rows(rows.data())) damaged();
}

void PngFile::read_sidecar(const std::filesystem::path& path) {
    const Sidecar sidecar(path);
    for (const std::string_view key : {"height_scale", "height_offset"})
        if (!sidecar.has(key)) sidecar.refuse(key, "is missing: give metres a count, and metres of count 0");
    scale_ = *sidecar.number("height_scale");
    offset_ = *sidecar.number("height_offset");
    if (!(scale_ > 0.0)) sidecar.refuse("height_scale", "is not above 0: give metres a count");
    nodata_ = sidecar.number("nodata");
    if (nodata_ && !(*nodata_ >= 0.0 && *nodata_ <= 65'535.0))
        sidecar.refuse("nodata", "is no count from 0 to 65535: correct it");
    const std::string positive = sidecar.text("positive").value_or("up");
    if (positive != "up" && positive != "down")
        sidecar.refuse("positive", "is neither \"up\" nor \"down\": correct it");
    sign_ = positive == "up" ? StatedSign::positive_up : StatedSign::positive_down;
    placement_.projection = sidecar.text("projection").value_or("");
    if (!placement_.projection.empty()) ProjConversion{placement_.projection};
    source_ = sidecar.text("source").value_or("");
    placement_.a =
        placement_of(sidecar, static_cast<double>(placement_.columns), static_cast<double>(placement_.rows));
}

std::vector<float> PngFile::read(int64_t column, int64_t row, int64_t columns, int64_t rows,
                                 std::optional<double> nodata) const {
    std::vector<float> samples;
    samples.reserve(static_cast<std::size_t>(columns * rows));
    for (int64_t r = row; r < row + rows; ++r) {
        for (int64_t c = column; c < column + columns; ++c) {
            const double count = counts_[static_cast<std::size_t>(r * placement_.columns + c)];
            samples.push_back(nodata && count == *nodata ? std::numeric_limits<float>::quiet_NaN()
                                                         : static_cast<float>(count * scale_ + offset_));
        }
    }
    return samples;
}

}  // namespace trochoid
