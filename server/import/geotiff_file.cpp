#include "server/import/geotiff_file.hpp"

#include <fmt/format.h>
#include <geotiff/geo_normalize.h>
#include <geotiff/geotiff.h>
#include <geotiff/geovalues.h>
#include <geotiff/xtiffio.h>
#include <tiffio.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <mutex>

namespace trochoid {
namespace {

constexpr uint32_t gdal_metadata_tag = 42112;
constexpr uint32_t gdal_nodata_tag = 42113;
/// EPSG's "mean sea level height" and "mean sea level depth".
constexpr uint16_t msl_height_code = 5714;
constexpr uint16_t msl_depth_code = 5715;
/// No honest height raster has larger strips or tiles; keeps a damaged header from asking for all memory.
constexpr tmsize_t block_bytes_max = tmsize_t{1} << 28;

/// What libtiff complained about last on this thread; becomes part of our message instead of going to standard error.
thread_local std::string last_complaint;

void keep_complaint(const char*, const char* format, va_list arguments) {
    std::array<char, 256> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    last_complaint = text.data();
}

TIFFExtendProc earlier_extender = nullptr;

void add_gdal_tags(TIFF* tiff) {
    static const std::array<TIFFFieldInfo, 2> fields{
        {{gdal_metadata_tag, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, const_cast<char*>("GDALMetadata")},
         {gdal_nodata_tag, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, const_cast<char*>("GDALNoData")}}};
    TIFFMergeFieldInfo(tiff, fields.data(), static_cast<uint32_t>(fields.size()));
    if (earlier_extender) earlier_extender(tiff);
}

void set_up_libtiff() {
    static std::once_flag once;
    std::call_once(once, [] {
        TIFFSetErrorHandler(keep_complaint);
        TIFFSetWarningHandler(nullptr);
        XTIFFInitialize();
        earlier_extender = TIFFSetTagExtender(add_gdal_tags);
    });
}

struct TiffClose {
    void operator()(TIFF* tiff) const { XTIFFClose(tiff); }
};
struct KeysFree {
    void operator()(GTIF* keys) const { GTIFFree(keys); }
};
struct DefinitionFree {
    void operator()(GTIFDefn* definition) const { GTIFFreeDefn(definition); }
};
using TiffPointer = std::unique_ptr<TIFF, TiffClose>;

std::string text_tag(TIFF* tiff, uint32_t tag) {
    const char* text = nullptr;
    return TIFFGetField(tiff, tag, &text) == 1 && text ? text : "";
}

std::vector<double> numbers_tag(TIFF* tiff, uint32_t tag) {
    uint16_t count = 0;
    const double* values = nullptr;
    if (TIFFGetField(tiff, tag, &count, &values) != 1 || !values) return {};
    return {values, values + count};
}

/// Affine from raster coordinates (0, 0 at the outer corner of the first pixel where pixels are areas) to source ones.
std::array<double, 6> raster_affine(TIFF* tiff, const std::string& path) {
    const std::vector<double> matrix = numbers_tag(tiff, TIFFTAG_GEOTRANSMATRIX);
    if (matrix.size() == 16) return {matrix[3], matrix[0], matrix[1], matrix[7], matrix[4], matrix[5]};
    const std::vector<double> scale = numbers_tag(tiff, TIFFTAG_GEOPIXELSCALE);
    const std::vector<double> tie = numbers_tag(tiff, TIFFTAG_GEOTIEPOINTS);
    if (scale.size() >= 2 && tie.size() >= 6)
        // Rows grow southwards by the standard; a negative scale turns that round (south-up).
        return {tie[3] - tie[0] * scale[0], scale[0], 0.0, tie[4] + tie[1] * scale[1], 0.0, -scale[1]};
    if (tie.size() > 6)
        refuse_raster(path,
                      "it has ground control points only: straighten it first, for instance with gdalwarp");
    refuse_raster(
        path,
        "the raster has no georeference (no pixel scale with tie point, no transformation): give it one, for instance "
        "with gdal_edit.py -a_ullr -a_srs EPSG:4326");
}

/// PROJ string of a projected source; empty for longitude and latitude in degrees.
std::string source_projection(GTIF* keys, const std::string& path) {
    const std::unique_ptr<GTIFDefn, DefinitionFree> definition(GTIFAllocDefn());
    const bool defined = definition && GTIFGetDefn(keys, definition.get()) == 1;
    if (defined && definition->Model == ModelTypeGeographic) {
        if (std::fabs(definition->UOMAngleInDegrees - 1.0) > 1e-9)
            refuse_raster(
                path,
                "its coordinates are angles in another unit than degrees: warp it to EPSG:4326 first (gdalwarp)");
        return "";
    }
    if (!defined || definition->Model != ModelTypeProjected)
        refuse_raster(
            path,
            "the raster has no georeference (no coordinate system): give it one, for instance with gdal_edit.py -a_srs "
            "EPSG:4326");
    char* text = GTIFGetProj4Defn(definition.get());
    std::string projection = text ? text : "";
    GTIFFreeMemory(text);
    if (projection.substr(0, 6) != "+proj=")
        refuse_raster(
            path, "its projection is not known here: warp it to EPSG:4326 first (gdalwarp -t_srs EPSG:4326)");
    return projection;
}

struct SampleType {
    uint16_t bits = 0;
    uint16_t format = 0;
    std::size_t bytes() const { return bits / 8u; }
};

bool is_height_type(SampleType type) {
    if (type.format == SAMPLEFORMAT_IEEEFP) return type.bits == 32 || type.bits == 64;
    const bool integer = type.format == SAMPLEFORMAT_INT || type.format == SAMPLEFORMAT_UINT;
    return integer && (type.bits == 8 || type.bits == 16 || type.bits == 32);
}

template <class T>
float height_of(const uint8_t* bytes, std::optional<double> nodata) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    // The nodata text may be a float's decimal digits; compare what the file can hold.
    if (nodata && static_cast<double>(value) == *nodata) return std::numeric_limits<float>::quiet_NaN();
    if constexpr (std::is_same_v<T, float>)
        if (nodata && value == static_cast<float>(*nodata)) return std::numeric_limits<float>::quiet_NaN();
    return static_cast<float>(value);
}

float decode_sample(SampleType type, const uint8_t* bytes, std::optional<double> nodata) {
    if (type.format == SAMPLEFORMAT_IEEEFP)
        return type.bits == 32 ? height_of<float>(bytes, nodata) : height_of<double>(bytes, nodata);
    const bool is_signed = type.format == SAMPLEFORMAT_INT;
    switch (type.bits) {
        case 8: return is_signed ? height_of<int8_t>(bytes, nodata) : height_of<uint8_t>(bytes, nodata);
        case 16: return is_signed ? height_of<int16_t>(bytes, nodata) : height_of<uint16_t>(bytes, nodata);
        default: return is_signed ? height_of<int32_t>(bytes, nodata) : height_of<uint32_t>(bytes, nodata);
    }
}

}  // namespace

struct GeotiffFile::Handle {
    std::string path;
    TiffPointer tiff;
    SampleType type;
    RasterPlacement placement;
    std::optional<double> nodata;
    StatedSign sign = StatedSign::none;

    /// A strip is a block as wide as the raster.
    int64_t block_columns = 0;
    int64_t block_rows = 0;
    bool tiled = false;

    void read_layout();
    void read_georeference();
    void read_descriptions();
    void read_block(int64_t column, int64_t row, std::vector<uint8_t>& bytes) const;
};

void GeotiffFile::Handle::read_layout() {
    uint32_t columns = 0, rows = 0;
    uint16_t bands = 1;
    TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &columns);
    TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &rows);
    TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, &bands);
    TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_BITSPERSAMPLE, &type.bits);
    TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLEFORMAT, &type.format);
    if (columns < 2 || rows < 2)
        refuse_raster(path, "the raster has fewer than 2 columns or rows: give one with heights");
    if (bands != 1)
        refuse_raster(
            path, fmt::format("the raster has {} bands: extract the one with heights (gdal_translate -b N)",
                              bands));
    if (!is_height_type(type))
        refuse_raster(
            path,
            fmt::format(
                "samples of {} bits in TIFF format {} are no heights: convert them (gdal_translate -ot Float32)",
                type.bits, type.format));
    placement.columns = columns;
    placement.rows = rows;
    tiled = TIFFIsTiled(tiff.get()) != 0;
    uint32_t block_width = columns, block_height = rows;
    if (tiled) {
        TIFFGetField(tiff.get(), TIFFTAG_TILEWIDTH, &block_width);
        TIFFGetField(tiff.get(), TIFFTAG_TILELENGTH, &block_height);
    } else {
        TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_ROWSPERSTRIP, &block_height);
        block_height = std::min(block_height, rows);
    }
    const tmsize_t bytes = tiled ? TIFFTileSize(tiff.get()) : TIFFStripSize(tiff.get());
    if (block_width == 0 || block_height == 0 || bytes <= 0 || bytes > block_bytes_max)
        refuse_raster(
            path,
            "its strips or tiles are empty or above 256 MiB: rewrite it (gdal_translate -co TILED=YES)");
    block_columns = block_width;
    block_rows = block_height;
}

void GeotiffFile::Handle::read_georeference() {
    const std::unique_ptr<GTIF, KeysFree> keys(GTIFNew(tiff.get()));
    if (!keys) refuse_raster(path, "its geographic keys cannot be read: rewrite it (gdal_translate)");
    const std::array<double, 6> corner = raster_affine(tiff.get(), path);
    placement.projection = source_projection(keys.get(), path);
    uint16_t raster_type = RasterPixelIsArea;
    GTIFKeyGetSHORT(keys.get(), GTRasterTypeGeoKey, &raster_type, 0, 1);
    const double centre = raster_type == RasterPixelIsPoint ? 0.0 : 0.5;
    placement.a = corner;
    placement.a[0] += centre * (corner[1] + corner[2]);
    placement.a[3] += centre * (corner[4] + corner[5]);
    const double area = corner[1] * corner[5] - corner[2] * corner[4];
    if (!std::isfinite(area) || area == 0.0)
        refuse_raster(
            path,
            "the raster has no georeference (its pixels have no size): give it one (gdal_edit.py -a_ullr)");
    uint16_t vertical = 0;
    GTIFKeyGetSHORT(keys.get(), VerticalCSTypeGeoKey, &vertical, 0, 1);
    if (vertical == msl_height_code) sign = StatedSign::positive_up;
    if (vertical == msl_depth_code) sign = StatedSign::positive_down;
}

void GeotiffFile::Handle::read_descriptions() {
    if (sign == StatedSign::none)
        sign = sign_in_text(text_tag(tiff.get(), gdal_metadata_tag) + " " +
                            text_tag(tiff.get(), TIFFTAG_IMAGEDESCRIPTION));
    const std::string text = text_tag(tiff.get(), gdal_nodata_tag);
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (end != text.c_str()) nodata = value;
}

void GeotiffFile::Handle::read_block(int64_t column, int64_t row, std::vector<uint8_t>& bytes) const {
    const auto x = static_cast<uint32_t>(column);
    const auto y = static_cast<uint32_t>(row);
    const auto size = static_cast<tmsize_t>(bytes.size());
    const int64_t rows_here = tiled ? block_rows : std::min(block_rows, placement.rows - row);
    const auto needed = static_cast<tmsize_t>(block_columns * rows_here * static_cast<int64_t>(type.bytes()));
    last_complaint.clear();
    const tmsize_t got =
        tiled ? TIFFReadEncodedTile(tiff.get(), TIFFComputeTile(tiff.get(), x, y, 0, 0), bytes.data(), size)
              : TIFFReadEncodedStrip(tiff.get(), TIFFComputeStrip(tiff.get(), y, 0), bytes.data(), size);
    if (got < needed)
        refuse_raster(
            path,
            fmt::format("the data at column {}, row {} is damaged or cut short ({}): fetch the file again",
                        column, row, last_complaint.empty() ? "too few bytes" : last_complaint));
}

GeotiffFile::GeotiffFile(const std::filesystem::path& path) : handle_(std::make_unique<Handle>()) {
    set_up_libtiff();
    handle_->path = path.string();
    last_complaint.clear();
    // 'm': read instead of mapping, so that a file cut short while we read is an error and no signal.
    handle_->tiff.reset(XTIFFOpen(path.c_str(), "rm"));
    if (!handle_->tiff)
        refuse_raster(
            handle_->path,
            fmt::format("this is no TIFF ({}): convert it with gdal_translate -of GTiff", last_complaint));
    handle_->read_layout();
    handle_->read_georeference();
    handle_->read_descriptions();
}

GeotiffFile::~GeotiffFile() = default;

const RasterPlacement& GeotiffFile::placement() const { return handle_->placement; }

std::optional<double> GeotiffFile::stated_nodata() const { return handle_->nodata; }

StatedSign GeotiffFile::stated_sign() const { return handle_->sign; }

std::vector<float> GeotiffFile::read(int64_t column, int64_t row, int64_t columns, int64_t rows,
                                     std::optional<double> nodata) const {
    const Handle& h = *handle_;
    std::vector<float> samples(static_cast<std::size_t>(columns * rows));
    std::vector<uint8_t> bytes(
        static_cast<std::size_t>(h.tiled ? TIFFTileSize(h.tiff.get()) : TIFFStripSize(h.tiff.get())));
    for (int64_t top = row / h.block_rows * h.block_rows; top < row + rows; top += h.block_rows) {
        for (int64_t left = column / h.block_columns * h.block_columns; left < column + columns;
             left += h.block_columns) {
            h.read_block(left, top, bytes);
            const int64_t last_row = std::min(top + h.block_rows, row + rows);
            const int64_t last_column = std::min(left + h.block_columns, column + columns);
            for (int64_t r = std::max(top, row); r < last_row; ++r) {
                for (int64_t c = std::max(left, column); c < last_column; ++c) {
                    const auto from =
                        static_cast<std::size_t>((r - top) * h.block_columns + (c - left)) * h.type.bytes();
                    const auto to = static_cast<std::size_t>((r - row) * columns + (c - column));
                    samples[to] = decode_sample(h.type, bytes.data() + from, nodata);
                }
            }
        }
    }
    return samples;
}

}  // namespace trochoid
