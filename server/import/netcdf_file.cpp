#include "server/import/netcdf_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <netcdf.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "server/import/map_projection.hpp"
#include "server/import/netcdf_header.hpp"

namespace trochoid {
namespace {

/// Values read from the file at once: 128 MiB of doubles, so that compressed chunks are unpacked few times.
constexpr int64_t values_at_once = 16'777'216;
/// A coordinate may miss its evenly spaced place by this share of a step (they are often stored as floats).
constexpr double uneven_max = 0.05;

constexpr std::array<std::string_view, 8> height_names{"elevation", "z",        "Band1", "topo",
                                                       "height",    "altitude", "depth", "bathymetry"};
constexpr std::array<std::string_view, 3> column_names{"lon", "longitude", "x"};
constexpr std::array<std::string_view, 3> row_names{"lat", "latitude", "y"};

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

template <std::size_t n>
bool is_one_of(const std::array<std::string_view, n>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), lower(name)) != names.end();
}

bool is_height_type(nc_type type) {
    switch (type) {
        case NC_BYTE:
        case NC_UBYTE:
        case NC_SHORT:
        case NC_USHORT:
        case NC_INT:
        case NC_UINT:
        case NC_FLOAT:
        case NC_DOUBLE: return true;
        default: return false;
    }
}

/// An opened file; closes itself.
class Dataset {
public:
    explicit Dataset(const std::filesystem::path& path) : path_(path) {
        check_netcdf_header(path);
        const int status = nc_open(path.c_str(), NC_NOWRITE, &id_);
        if (status != NC_NOERR)
            refuse_raster(path, fmt::format("netCDF cannot open it ({}): fetch it again, or convert it with "
                                            "gdal_translate -of GTiff",
                                            nc_strerror(status)));
    }
    ~Dataset() { nc_close(id_); }
    Dataset(const Dataset&) = delete;
    Dataset& operator=(const Dataset&) = delete;

    int id() const { return id_; }
    const std::filesystem::path& path() const { return path_; }

    void check(int status) const {
        if (status != NC_NOERR)
            refuse_raster(path_, fmt::format("the file is damaged or cut short ({}): fetch it again",
                                             nc_strerror(status)));
    }
    std::string variable_name(int variable) const {
        std::array<char, NC_MAX_NAME + 1> name{};
        check(nc_inq_varname(id_, variable, name.data()));
        return name.data();
    }
    std::vector<int> dimensions_of(int variable) const {
        int count = 0;
        check(nc_inq_varndims(id_, variable, &count));
        std::vector<int> dimensions(static_cast<std::size_t>(count));
        check(nc_inq_vardimid(id_, variable, dimensions.data()));
        return dimensions;
    }
    std::size_t length_of(int dimension) const {
        std::size_t length = 0;
        check(nc_inq_dimlen(id_, dimension, &length));
        return length;
    }
    /// A text attribute (a char array or one string); empty where there is none.
    std::string text(int variable, const char* attribute) const {
        nc_type type = NC_NAT;
        std::size_t length = 0;
        if (nc_inq_att(id_, variable, attribute, &type, &length) != NC_NOERR) return {};
        if (type == NC_CHAR && length < 65'536) {
            std::string value(length, '\0');
            check(nc_get_att_text(id_, variable, attribute, value.data()));
            return value;
        }
        if (type != NC_STRING || length != 1) return {};
        char* value = nullptr;
        check(nc_get_att_string(id_, variable, attribute, &value));
        std::string copy = value ? value : "";
        nc_free_string(1, &value);
        return copy;
    }
    /// A single number; nothing where there is none.
    std::optional<double> number(int variable, const char* attribute) const {
        nc_type type = NC_NAT;
        std::size_t length = 0;
        if (nc_inq_att(id_, variable, attribute, &type, &length) != NC_NOERR || length != 1 ||
            !is_height_type(type))
            return {};
        double value = 0.0;
        check(nc_get_att_double(id_, variable, attribute, &value));
        return value;
    }

private:
    std::filesystem::path path_;
    int id_ = -1;
};

/// Evenly spaced coordinates: value of the first, and the step.
struct Axis {
    double first = 0.0;
    double step = 0.0;
};

std::vector<double> read_axis_values(const Dataset& file, int variable) {
    const std::string name = file.variable_name(variable);
    const std::size_t length = file.length_of(file.dimensions_of(variable)[0]);
    if (length < 2)
        refuse_raster(file.path(), "the raster has fewer than 2 columns or rows: give one with heights");
    if (length > NetcdfFile::side_max)
        refuse_raster(file.path(),
                      fmt::format("{} coordinates in {} are absurd: fetch the file again, or cut "
                                  "the region out (gdal_translate -projwin)",
                                  length, name));
    const std::string units = lower(file.text(variable, "units"));
    if (!units.empty() && units.find("degree") == std::string::npos)
        refuse_raster(file.path(), fmt::format("its coordinate {} is in {}, not in degrees: warp it to "
                                               "EPSG:4326 first (gdalwarp -t_srs EPSG:4326)",
                                               name, units));
    std::vector<double> values(length);
    file.check(nc_get_var_double(file.id(), variable, values.data()));
    return values;
}

Axis even_axis(const Dataset& file, int variable, bool longitude) {
    std::vector<double> values = read_axis_values(file, variable);
    if (longitude)
        // 0..180 and then -180..0 is one row of columns on the globe.
        for (std::size_t i = 1; i < values.size(); ++i)
            values[i] = values[i - 1] + wrap_degrees(values[i] - values[i - 1]);
    Axis axis{values.front(), (values.back() - values.front()) / static_cast<double>(values.size() - 1)};
    const double reach = longitude ? 720.0 : 90.0 + 1e-3;
    bool even = std::isfinite(axis.step) && axis.step != 0.0;
    for (std::size_t i = 0; even && i < values.size(); ++i) {
        const double miss = values[i] - (axis.first + axis.step * static_cast<double>(i));
        even = std::fabs(miss) <= uneven_max * std::fabs(axis.step) && std::fabs(values[i]) <= reach;
    }
    if (!even)
        refuse_raster(file.path(),
                      fmt::format("the coordinates in {} are not evenly spaced degrees: regrid it first "
                                  "(gdalwarp -t_srs EPSG:4326, gmt grdsample, cdo remapbil)",
                                  file.variable_name(variable)));
    return axis;
}

/// The variable of the same name as the dimension, over it alone; -1 where there is none.
int coordinate_of(const Dataset& file, int dimension) {
    std::array<char, NC_MAX_NAME + 1> name{};
    file.check(nc_inq_dimname(file.id(), dimension, name.data()));
    int variable = -1;
    if (nc_inq_varid(file.id(), name.data(), &variable) != NC_NOERR) return -1;
    return file.dimensions_of(variable) == std::vector<int>{dimension} ? variable : -1;
}

/// Whether the variable is a grid over coordinates that we know, its rows being latitudes.
bool is_grid(const Dataset& file, int variable) {
    const std::vector<int> dimensions = file.dimensions_of(variable);
    if (dimensions.size() < 2) return false;
    for (std::size_t i = 0; i + 2 < dimensions.size(); ++i)
        if (file.length_of(dimensions[i]) != 1) return false;
    const int row = coordinate_of(file, dimensions[dimensions.size() - 2]);
    const int column = coordinate_of(file, dimensions[dimensions.size() - 1]);
    // By name, or as the CF conventions say it: units of degrees_north and degrees_east.
    const auto is_axis = [&](int axis, const auto& names, const char* towards) {
        return axis >= 0 && (is_one_of(names, file.variable_name(axis)) ||
                             lower(file.text(axis, "units")).find(towards) != std::string::npos);
    };
    return is_axis(row, row_names, "north") && is_axis(column, column_names, "east");
}

int named_variable(const Dataset& file, const std::string& name) {
    int variable = -1;
    if (nc_inq_varid(file.id(), name.c_str(), &variable) != NC_NOERR)
        refuse_raster(file.path(), fmt::format("it has no variable '{}': correct --variable", name));
    if (!is_grid(file, variable))
        refuse_raster(file.path(),
                      fmt::format("its variable {} is no grid over 1-D coordinates lat and lon (or "
                                  "latitude and longitude, y and x) in this order: transpose or "
                                  "convert it with gdal_translate -of GTiff",
                                  name));
    return variable;
}

int height_variable(const Dataset& file, const std::string& wanted) {
    if (!wanted.empty()) return named_variable(file, wanted);
    int count = 0;
    file.check(nc_inq_nvars(file.id(), &count));
    std::vector<int> grids;
    std::vector<std::string> names, grid_names;
    for (int variable = 0; variable < count; ++variable) {
        names.push_back(file.variable_name(variable));
        if (!is_grid(file, variable)) continue;
        grids.push_back(variable);
        grid_names.push_back(names.back());
    }
    for (const std::string_view name : height_names)
        for (std::size_t i = 0; i < grids.size(); ++i)
            if (grid_names[i] == name) return grids[i];
    if (grids.size() == 1) return grids[0];
    if (!grids.empty())
        refuse_raster(file.path(),
                      fmt::format("its variables {} may all hold the heights: choose with --variable",
                                  fmt::join(grid_names, ", ")));
    refuse_raster(
        file.path(),
        fmt::format("it has no variable over 1-D coordinates lat and lon (or latitude and longitude, y "
                    "and x); there are: {}. Convert it with gdal_translate -of GTiff",
                    names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

void check_units(const Dataset& file, int variable) {
    const std::string units = lower(file.text(variable, "units"));
    for (const char* other : {"km", "kilometer", "kilometers", "kilometre", "kilometres", "dm", "cm", "mm",
                              "ft", "feet", "foot", "fathom", "fathoms"})
        if (units == other)
            refuse_raster(
                file.path(),
                fmt::format("its heights are in {}: convert them to metres first (gdal_calc.py)", units));
}

}  // namespace

struct NetcdfFile::Handle {
    explicit Handle(const std::filesystem::path& path) : file(path) {}

    Dataset file;
    int variable = -1;
    nc_type type = NC_NAT;
    std::size_t leading = 0;  ///< dimensions of length 1 before rows and columns
    RasterPlacement placement;
    double scale = 1.0;
    double offset = 0.0;
    std::optional<double> fill;
    std::optional<double> missing;
    StatedSign sign = StatedSign::none;

    void read_marks();
    float height_of(double raw, std::optional<double> nodata) const;
};

void NetcdfFile::Handle::read_marks() {
    file.check(nc_inq_vartype(file.id(), variable, &type));
    if (!is_height_type(type))
        refuse_raster(file.path(), fmt::format("its variable {} holds no numbers of 8 to 32 bits or floats: "
                                               "convert it (gdal_translate -ot Float32)",
                                               file.variable_name(variable)));
    scale = file.number(variable, "scale_factor").value_or(1.0);
    offset = file.number(variable, "add_offset").value_or(0.0);
    if (!std::isfinite(scale) || scale == 0.0 || !std::isfinite(offset))
        refuse_raster(file.path(),
                      "its scale_factor or add_offset is no usable number: correct it (ncatted)");
    fill = file.number(variable, "_FillValue");
    missing = file.number(variable, "missing_value");
    if (!fill) switch (type) {
            case NC_SHORT: fill = NC_FILL_SHORT; break;
            case NC_USHORT: fill = NC_FILL_USHORT; break;
            case NC_INT: fill = NC_FILL_INT; break;
            case NC_UINT: fill = NC_FILL_UINT; break;
            case NC_FLOAT: fill = static_cast<double>(NC_FILL_FLOAT); break;
            case NC_DOUBLE: fill = NC_FILL_DOUBLE; break;
            default: break;
        }
    const std::string stated = file.text(variable, "positive");
    sign = sign_in_text(fmt::format("{} {} {} {}", stated.empty() ? "" : "positive=" + stated,
                                    file.variable_name(variable), file.text(variable, "standard_name"),
                                    file.text(variable, "long_name")));
}

float NetcdfFile::Handle::height_of(double raw, std::optional<double> nodata) const {
    const auto marks = [&](std::optional<double> mark) {
        return mark && (raw == *mark ||
                        // A float's mark may have been given as decimal digits.
                        (type == NC_FLOAT && static_cast<float>(raw) == static_cast<float>(*mark)));
    };
    if (marks(nodata) || marks(missing)) return std::numeric_limits<float>::quiet_NaN();
    return static_cast<float>(scale == 1.0 && offset == 0.0 ? raw : raw * scale + offset);
}

NetcdfFile::NetcdfFile(const std::filesystem::path& path, const std::string& variable)
    : handle_(std::make_unique<Handle>(path)) {
    Handle& h = *handle_;
    h.variable = height_variable(h.file, variable);
    h.read_marks();
    check_units(h.file, h.variable);
    const std::vector<int> dimensions = h.file.dimensions_of(h.variable);
    h.leading = dimensions.size() - 2;
    const Axis row = even_axis(h.file, coordinate_of(h.file, dimensions[h.leading]), false);
    const Axis column = even_axis(h.file, coordinate_of(h.file, dimensions[h.leading + 1]), true);
    h.placement.rows = static_cast<int64_t>(h.file.length_of(dimensions[h.leading]));
    h.placement.columns = static_cast<int64_t>(h.file.length_of(dimensions[h.leading + 1]));
    h.placement.a = {column.first, column.step, 0.0, row.first, 0.0, row.step};
}

NetcdfFile::~NetcdfFile() = default;

const RasterPlacement& NetcdfFile::placement() const { return handle_->placement; }

std::optional<double> NetcdfFile::stated_nodata() const { return handle_->fill; }

StatedSign NetcdfFile::stated_sign() const { return handle_->sign; }

std::vector<float> NetcdfFile::read(int64_t column, int64_t row, int64_t columns, int64_t rows,
                                    std::optional<double> nodata) const {
    const Handle& h = *handle_;
    std::vector<float> samples;
    samples.reserve(static_cast<std::size_t>(columns * rows));
    const int64_t rows_at_once = std::clamp<int64_t>(values_at_once / columns, 1, rows);
    std::vector<double> raw(static_cast<std::size_t>(rows_at_once * columns));
    for (int64_t done = 0; done < rows; done += rows_at_once) {
        const int64_t here = std::min(rows_at_once, rows - done);
        std::vector<std::size_t> start(h.leading, 0), count(h.leading, 1);
        start.insert(start.end(), {static_cast<std::size_t>(row + done), static_cast<std::size_t>(column)});
        count.insert(count.end(), {static_cast<std::size_t>(here), static_cast<std::size_t>(columns)});
        h.file.check(nc_get_vara_double(h.file.id(), h.variable, start.data(), count.data(), raw.data()));
        for (int64_t i = 0; i < here * columns; ++i)
            samples.push_back(h.height_of(raw[static_cast<std::size_t>(i)], nodata));
    }
    return samples;
}

}  // namespace trochoid
