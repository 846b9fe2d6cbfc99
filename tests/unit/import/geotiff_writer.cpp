#include "tests/unit/import/geotiff_writer.hpp"

#include <geotiff/geo_normalize.h>
#include <geotiff/geotiff.h>
#include <geotiff/geovalues.h>
#include <geotiff/xtiffio.h>
#include <gtest/gtest.h>
#include <tiffio.h>

#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "protocol/units/operator_error.hpp"

namespace trochoid {
namespace {

using Type = GeotiffSpec::Type;
using Georeference = GeotiffSpec::Georeference;

constexpr uint32_t tile_side = 16;

uint16_t bits_of(Type type) {
    switch (type) {
        case Type::uint8: return 8;
        case Type::int16:
        case Type::uint16: return 16;
        case Type::int32:
        case Type::float32: return 32;
        default: return 64;
    }
}

uint16_t format_of(Type type) {
    if (type == Type::float32 || type == Type::float64) return SAMPLEFORMAT_IEEEFP;
    return type == Type::uint8 || type == Type::uint16 ? SAMPLEFORMAT_UINT : SAMPLEFORMAT_INT;
}

template <class T>
void put(std::vector<uint8_t>& bytes, double value) {
    const T sample = std::is_integral_v<T> ? static_cast<T>(std::llround(value)) : static_cast<T>(value);
    std::array<uint8_t, sizeof(T)> raw{};
    std::memcpy(raw.data(), &sample, sizeof sample);
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

void put_sample(std::vector<uint8_t>& bytes, Type type, double value) {
    switch (type) {
        case Type::uint8: return put<uint8_t>(bytes, value);
        case Type::int16: return put<int16_t>(bytes, value);
        case Type::uint16: return put<uint16_t>(bytes, value);
        case Type::int32: return put<int32_t>(bytes, value);
        case Type::float32: return put<float>(bytes, value);
        case Type::float64: return put<double>(bytes, value);
        case Type::int64: return put<int64_t>(bytes, value);
    }
}

void write_layout(TIFF* tiff, const GeotiffSpec& spec) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, spec.columns);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, spec.rows);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, spec.bands);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, bits_of(spec.type));
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, format_of(spec.type));
    if (spec.deflate) {
        const bool is_float = format_of(spec.type) == SAMPLEFORMAT_IEEEFP;
        TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
        // libtiff 4.5 writes the floats' predictor with swapped bytes into files of foreign byte order (reads it right).
        if (!is_float || !spec.big_endian) TIFFSetField(tiff, TIFFTAG_PREDICTOR, is_float ? 3 : 2);
    }
    if (spec.tiled) {
        TIFFSetField(tiff, TIFFTAG_TILEWIDTH, tile_side);
        TIFFSetField(tiff, TIFFTAG_TILELENGTH, tile_side);
    } else {
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 3);
    }
    if (!spec.description.empty()) TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, spec.description.c_str());
    if (!spec.nodata.empty()) {
        static const TIFFFieldInfo field{42113,        -1, -1, TIFF_ASCII,
                                         FIELD_CUSTOM, 1,  0,  const_cast<char*>("GDALNoData")};
        TIFFMergeFieldInfo(tiff, &field, 1);
        TIFFSetField(tiff, 42113, spec.nodata.c_str());
    }
}

void write_georeference(TIFF* tiff, const GeotiffSpec& spec) {
    // The outer corner of the first pixel where pixels are areas, its centre where they are points.
    const double back = spec.pixel_is_point ? 0.0 : 0.5;
    const double corner_x = spec.first_x - back * spec.step_x;
    const double corner_y = spec.first_y - back * spec.step_y;
    if (spec.georeference == Georeference::matrix) {
        const std::array<double, 16> matrix{spec.step_x, 0, 0, corner_x, 0, spec.step_y, 0, corner_y,
                                            0,           0, 0, 0,        0, 0,           0, 1};
        TIFFSetField(tiff, TIFFTAG_GEOTRANSMATRIX, 16, matrix.data());
    } else if (spec.georeference == Georeference::control_points) {
        const std::array<double, 12> ties{0, 0, 0, corner_x,     corner_y,     0,
                                          5, 5, 0, corner_x + 5, corner_y - 5, 0};
        TIFFSetField(tiff, TIFFTAG_GEOTIEPOINTS, 12, ties.data());
    } else if (spec.georeference != Georeference::none) {
        const std::array<double, 3> scale{spec.step_x, -spec.step_y, 0};
        // Tied at another pixel than the first, as the format allows.
        const std::array<double, 6> tie{2, 1, 0, corner_x + 2 * spec.step_x, corner_y + spec.step_y, 0};
        TIFFSetField(tiff, TIFFTAG_GEOPIXELSCALE, 3, scale.data());
        TIFFSetField(tiff, TIFFTAG_GEOTIEPOINTS, 6, tie.data());
    }
    GTIF* keys = GTIFNew(tiff);
    if (spec.georeference != Georeference::none && spec.georeference != Georeference::no_system) {
        const int model = spec.projected_epsg ? ModelTypeProjected : ModelTypeGeographic;
        GTIFKeySet(keys, GTModelTypeGeoKey, TYPE_SHORT, 1, model);
        if (spec.projected_epsg)
            GTIFKeySet(keys, ProjectedCSTypeGeoKey, TYPE_SHORT, 1, spec.projected_epsg);
        else
            GTIFKeySet(keys, GeographicTypeGeoKey, TYPE_SHORT, 1, 4326);
        if (spec.vertical_epsg) GTIFKeySet(keys, VerticalCSTypeGeoKey, TYPE_SHORT, 1, spec.vertical_epsg);
    }
    GTIFKeySet(keys, GTRasterTypeGeoKey, TYPE_SHORT, 1,
               spec.pixel_is_point ? RasterPixelIsPoint : RasterPixelIsArea);
    GTIFWriteKeys(keys);
    GTIFFree(keys);
}

void write_samples(TIFF* tiff, const GeotiffSpec& spec) {
    const auto at = [&](uint32_t c, uint32_t r) {
        return spec.height(spec.first_x + c * spec.step_x, spec.first_y + r * spec.step_y);
    };
    if (spec.tiled) {
        for (uint32_t top = 0; top < spec.rows; top += tile_side) {
            for (uint32_t left = 0; left < spec.columns; left += tile_side) {
                std::vector<uint8_t> bytes;
                for (uint32_t i = 0; i < tile_side * tile_side; ++i)
                    put_sample(bytes, spec.type, at(left + i % tile_side, top + i / tile_side));
                ASSERT_GT(TIFFWriteEncodedTile(tiff, TIFFComputeTile(tiff, left, top, 0, 0), bytes.data(),
                                               static_cast<tmsize_t>(bytes.size())),
                          0);
            }
        }
        return;
    }
    for (uint32_t row = 0; row < spec.rows; ++row) {
        std::vector<uint8_t> bytes;
        for (uint32_t column = 0; column < spec.columns; ++column)
            for (uint16_t band = 0; band < spec.bands; ++band) put_sample(bytes, spec.type, at(column, row));
        ASSERT_EQ(TIFFWriteScanline(tiff, bytes.data(), row), 1);
    }
}

}  // namespace

void write_geotiff(const std::filesystem::path& path, const GeotiffSpec& spec) {
    TIFF* tiff = XTIFFOpen(path.c_str(), spec.big_endian ? "wb" : "wl");
    ASSERT_NE(tiff, nullptr);
    write_layout(tiff, spec);
    write_georeference(tiff, spec);
    write_samples(tiff, spec);
    XTIFFClose(tiff);
}

ScratchFolder::ScratchFolder() {
    std::random_device random;
    do {
        path_ = std::filesystem::temp_directory_path() / ("trochoid-import-" + std::to_string(random()));
    } while (!std::filesystem::create_directory(path_));
}

ScratchFolder::~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::string operator_error_of(const std::function<void()>& function) {
    try {
        function();
    } catch (const OperatorError& error) {
        return error.what();
    }
    return "";
}

}  // namespace trochoid
