#include "tests/unit/import/raster_writers.hpp"

#include <gtest/gtest.h>
#include <netcdf.h>
#include <png.h>

#include <array>
#include <cmath>
#include <cstdio>

namespace trochoid {
namespace {

int mode_of(NetcdfSpec::Format format) {
    switch (format) {
        case NetcdfSpec::Format::classic: return NC_CLOBBER;
        case NetcdfSpec::Format::offset_64: return NC_CLOBBER | NC_64BIT_OFFSET;
        case NetcdfSpec::Format::data_64: return NC_CLOBBER | NC_64BIT_DATA;
        default: return NC_CLOBBER | NC_NETCDF4;
    }
}

void put_text(int file, int variable, const char* name, const std::string& text) {
    if (text.empty()) return;
    ASSERT_EQ(nc_put_att_text(file, variable, name, text.size(), text.c_str()), NC_NOERR);
}

void put_number(int file, int variable, const char* name, nc_type type, std::optional<double> value) {
    if (!value) return;
    ASSERT_EQ(nc_put_att_double(file, variable, name, type, 1, &*value), NC_NOERR);
}

std::vector<double> axis_values(const NetcdfSpec& spec, bool is_x) {
    std::vector<double> values;
    const std::size_t count = is_x ? spec.columns : spec.rows;
    for (std::size_t i = 0; i < count; ++i) {
        double value = is_x ? spec.first_x + spec.step_x * static_cast<double>(i)
                            : spec.first_y + spec.step_y * static_cast<double>(i);
        if (is_x && spec.wrapped) value = std::remainder(value, 360.0);
        if (!is_x && i + 1 == count) value += spec.bend * spec.step_y;
        values.push_back(value);
    }
    return values;
}

void write_heights(int file, int variable, const NetcdfSpec& spec) {
    std::vector<double> values;
    const auto at = [&](std::size_t c, std::size_t r) {
        const double height = spec.height(spec.first_x + spec.step_x * static_cast<double>(c),
                                          spec.first_y + spec.step_y * static_cast<double>(r));
        const double packed = (height - spec.add_offset) / spec.scale_factor;
        return spec.type == NC_FLOAT || spec.type == NC_DOUBLE ? packed : std::round(packed);
    };
    if (spec.transposed) {
        for (std::size_t c = 0; c < spec.columns; ++c)
            for (std::size_t r = 0; r < spec.rows; ++r) values.push_back(at(c, r));
    } else {
        for (std::size_t r = 0; r < spec.rows; ++r)
            for (std::size_t c = 0; c < spec.columns; ++c) values.push_back(at(c, r));
    }
    ASSERT_EQ(nc_put_var_double(file, variable, values.data()), NC_NOERR);
}

}  // namespace

void write_netcdf(const std::filesystem::path& path, const NetcdfSpec& spec) {
    int file = -1, x = -1, y = -1, time = -1;
    ASSERT_EQ(nc_create(path.c_str(), mode_of(spec.format), &file), NC_NOERR);
    ASSERT_EQ(nc_def_dim(file, "time", 1, &time), NC_NOERR);
    ASSERT_EQ(nc_def_dim(file, spec.y_name.c_str(), spec.rows, &y), NC_NOERR);
    ASSERT_EQ(nc_def_dim(file, spec.x_name.c_str(), spec.columns, &x), NC_NOERR);
    std::array<int, 2> axes{-1, -1};
    if (!spec.without_axes) {
        const nc_type axis_type = spec.float_axes ? NC_FLOAT : NC_DOUBLE;
        ASSERT_EQ(nc_def_var(file, spec.x_name.c_str(), axis_type, 1, &x, &axes[0]), NC_NOERR);
        ASSERT_EQ(nc_def_var(file, spec.y_name.c_str(), axis_type, 1, &y, &axes[1]), NC_NOERR);
        const bool cf = spec.axis_units == "CF";
        put_text(file, axes[0], "units", cf ? "degrees_east" : spec.axis_units);
        put_text(file, axes[1], "units", cf ? "degrees_north" : spec.axis_units);
    }
    std::vector<int> dimensions = spec.transposed ? std::vector{x, y} : std::vector{y, x};
    if (spec.with_time) dimensions.insert(dimensions.begin(), time);
    const nc_type type = spec.type == 0 ? NC_SHORT : spec.type;
    const auto count = static_cast<int>(dimensions.size());
    int variable = -1;
    ASSERT_EQ(nc_def_var(file, spec.variable.c_str(), type, count, dimensions.data(), &variable), NC_NOERR);
    if (spec.chunk > 0) {
        std::vector<std::size_t> chunks(dimensions.size(), spec.chunk);
        if (spec.with_time) chunks[0] = 1;
        ASSERT_EQ(nc_def_var_chunking(file, variable, NC_CHUNKED, chunks.data()), NC_NOERR);
        ASSERT_EQ(nc_def_var_deflate(file, variable, 1, 1, 4), NC_NOERR);
    }
    put_text(file, variable, "units", spec.units);
    put_text(file, variable, "positive", spec.positive);
    put_number(file, variable, "_FillValue", type, spec.fill);
    put_number(file, variable, "missing_value", type, spec.missing);
    if (spec.scale_factor != 1.0) put_number(file, variable, "scale_factor", NC_DOUBLE, spec.scale_factor);
    if (spec.add_offset != 0.0) put_number(file, variable, "add_offset", NC_DOUBLE, spec.add_offset);
    if (!spec.also.empty()) {
        int other = -1;
        ASSERT_EQ(nc_def_var(file, spec.also.c_str(), NC_FLOAT, count, dimensions.data(), &other), NC_NOERR);
    }
    ASSERT_EQ(nc_enddef(file), NC_NOERR);
    if (!spec.without_axes) {
        ASSERT_EQ(nc_put_var_double(file, axes[0], axis_values(spec, true).data()), NC_NOERR);
        ASSERT_EQ(nc_put_var_double(file, axes[1], axis_values(spec, false).data()), NC_NOERR);
    }
    write_heights(file, variable, spec);
    ASSERT_EQ(nc_close(file), NC_NOERR);
}

void write_png(const std::filesystem::path& path, const PngSpec& spec) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    ASSERT_NE(file, nullptr);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, spec.columns, spec.rows, spec.bits, spec.colour_type,
                 spec.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    const std::size_t channels = png_get_channels(png, info);
    const std::size_t sample_bytes = spec.bits == 16 ? 2 : 1;
    std::vector<std::vector<png_byte>> rows(spec.rows);
    std::vector<png_bytep> row_starts;
    for (uint32_t r = 0; r < spec.rows; ++r) {
        for (uint32_t c = 0; c < spec.columns; ++c) {
            const uint16_t count = spec.count(c, r);
            for (std::size_t i = 0; i < channels; ++i) {
                if (sample_bytes == 2) rows[r].push_back(static_cast<png_byte>(count >> 8));
                rows[r].push_back(static_cast<png_byte>(count & 0xff));
            }
        }
        row_starts.push_back(rows[r].data());
    }
    png_write_image(png, row_starts.data());
    png_write_end(png, nullptr);
    png_destroy_write_struct(&png, &info);
    ASSERT_EQ(std::fclose(file), 0);
}

}  // namespace trochoid
