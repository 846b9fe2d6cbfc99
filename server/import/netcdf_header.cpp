#include "server/import/netcdf_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "server/import/raster_file.hpp"

namespace trochoid {
namespace {

/// Longer headers belong to no raster.
constexpr uint64_t header_max = uint64_t{1} << 24;
constexpr uint64_t name_max = 256;
constexpr uint64_t dimensions_max = 1024;
/// Above any file's size; sums and products stop here.
constexpr uint64_t endless = uint64_t{1} << 60;

constexpr uint32_t dimension_tag = 10;
constexpr uint32_t variable_tag = 11;
constexpr uint32_t attribute_tag = 12;

/// Bytes of a value by nc_type (NC_BYTE = 1 on); the last five only in CDF-5.
constexpr std::array<uint64_t, 12> value_bytes{0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
constexpr uint32_t last_old_type = 6;

constexpr uint64_t padded(uint64_t bytes) { return (bytes + 3) / 4 * 4; }

uint64_t product(uint64_t a, uint64_t b) { return b != 0 && a > endless / b ? endless : a * b; }
uint64_t sum(uint64_t a, uint64_t b) {
    return a >= endless || b >= endless ? endless : std::min(a + b, endless);
}

/// Reads the header from its first byte to its last.
class ClassicHeader {
public:
    ClassicHeader(const std::filesystem::path& path, uint64_t size) : path_(path), size_(size) {
        std::ifstream file(path, std::ios::binary);
        bytes_.resize(static_cast<size_t>(std::min(size, header_max)));
        file.read(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
        bytes_.resize(static_cast<size_t>(file.gcount()));
    }

    void check() {
        version_ = take(4) & 0xff;
        if (version_ != 1 && version_ != 2 && version_ != 5)
            refuse(fmt::format("its version {} of the classic format is unknown", version_));
        const uint64_t streamed = version_ == 5 ? UINT64_MAX : UINT32_MAX;
        records_ = take_count();
        if (records_ == streamed)
            refuse_raster(path_,
                          "it was written as a stream, its records uncounted: convert it with nccopy -k nc4");
        const uint64_t dimensions = take_list(dimension_tag);
        for (uint64_t i = 0; i < dimensions; ++i) take_dimension();
        take_attributes();
        const uint64_t variables = take_list(variable_tag);
        for (uint64_t i = 0; i < variables; ++i) take_variable();
        place_variables();
    }

private:
    /// What decides where a variable's values lie.
    struct Variable {
        uint64_t begin;
        /// Of all values, or of one record, without padding.
        uint64_t bytes;
        bool recorded;
    };

    [[noreturn]] void refuse(std::string_view why) const {
        refuse_raster(path_, fmt::format("the netCDF header is damaged ({}): fetch it again", why));
    }
    void need(uint64_t bytes) const {
        if (bytes <= bytes_.size() - at_) return;
        if (bytes_.size() < size_ && bytes < header_max) refuse("it has no end within 16 MiB");
        refuse_raster(path_,
                      "the file is damaged or cut short (its netCDF header does not end): fetch it again");
    }
    /// Big-endian.
    uint64_t take(uint64_t bytes) {
        need(bytes);
        uint64_t value = 0;
        for (; bytes > 0; --bytes) value = value << 8 | static_cast<uint8_t>(bytes_[at_++]);
        return value;
    }
    /// NON_NEG of the grammar.
    uint64_t take_count() { return take(version_ == 5 ? 8 : 4); }
    void skip(uint64_t bytes) {
        need(bytes);
        at_ += static_cast<size_t>(bytes);
    }
    /// The elements of a list that may be absent.
    uint64_t take_list(uint32_t tag) {
        const uint64_t found = take(4);
        const uint64_t count = take_count();
        if (found != tag && (found != 0 || count != 0))
            refuse(fmt::format("a list begins with {} and {}", found, count));
        return count;
    }
    void take_name() {
        const uint64_t length = take_count();
        if (length == 0 || length > name_max) refuse(fmt::format("a name of {} bytes", length));
        need(padded(length));
        for (uint64_t i = 0; i < length; ++i) {
            const auto letter = static_cast<uint8_t>(bytes_[at_ + static_cast<size_t>(i)]);
            if (letter < 0x20 || letter == 0x7f || letter == '/') refuse("a name that is no text");
        }
        skip(padded(length));
    }
    /// Bytes of a value.
    uint64_t take_type() {
        const uint64_t type = take(4);
        if (type == 0 || type >= value_bytes.size() || (version_ != 5 && type > last_old_type))
            refuse(fmt::format("values of type {}", type));
        return value_bytes[static_cast<size_t>(type)];
    }
    void take_dimension() {
        take_name();
        const uint64_t length = take_count();
        // No variable holds more values than its file has bytes; a dimension may lie unused.
        if (length > INT64_MAX) refuse(fmt::format("a dimension of {} values", length));
        if (length == 0 && record_) refuse("two dimensions of records");
        if (length == 0) record_ = lengths_.size();
        lengths_.push_back(length);
    }
    void take_attributes() {
        const uint64_t count = take_list(attribute_tag);
        for (uint64_t i = 0; i < count; ++i) {
            take_name();
            const uint64_t bytes = take_type();
            skip(padded(product(take_count(), bytes)));
        }
    }
    void take_variable() {
        take_name();
        const uint64_t count = take_count();
        if (count > dimensions_max) refuse(fmt::format("a variable with {} dimensions", count));
        Variable variable{0, 1, false};
        for (uint64_t i = 0; i < count; ++i) {
            const uint64_t dimension = take_count();
            if (dimension >= lengths_.size()) refuse(fmt::format("a variable over dimension {}", dimension));
            if (dimension == record_) {
                if (i != 0) refuse("records are not a variable's first dimension");
                variable.recorded = true;
                continue;
            }
            variable.bytes = product(variable.bytes, lengths_[static_cast<size_t>(dimension)]);
        }
        take_attributes();
        variable.bytes = product(variable.bytes, take_type());
        // The stated size: of large variables it is wrong by design, and of all it follows from the rest.
        take_count();
        variable.begin = take(version_ == 1 ? 4 : 8);
        variables_.push_back(variable);
    }
    void place_variables() const {
        uint64_t record = 0;
        uint64_t recorded = 0;
        for (const Variable& variable : variables_)
            if (variable.recorded) {
                record = sum(record, padded(variable.bytes));
                ++recorded;
            }
        // One variable alone has its records without padding.
        if (recorded == 1)
            for (const Variable& variable : variables_)
                if (variable.recorded) record = variable.bytes;
        uint64_t end = at_;
        for (const Variable& variable : variables_) {
            if (variable.begin < at_) refuse("a variable's values lie in the header");
            uint64_t bytes = variable.bytes;
            if (variable.recorded)
                bytes = records_ == 0 ? 0 : sum(product(records_ - 1, record), variable.bytes);
            if (bytes != 0) end = std::max(end, sum(variable.begin, bytes));
        }
        if (end > size_)
            refuse_raster(path_, end >= endless || end / 4096 > size_
                                     ? "the netCDF header is damaged (its values would fill thousands of "
                                       "such files): fetch it again"
                                     : fmt::format("the file is cut short ({} bytes of {}): fetch it again",
                                                   size_, end));
    }

    const std::filesystem::path& path_;
    uint64_t size_;
    std::string bytes_;
    size_t at_ = 0;
    uint64_t version_ = 0;
    uint64_t records_ = 0;
    std::vector<uint64_t> lengths_;
    std::optional<size_t> record_;
    std::vector<Variable> variables_;
};

}  // namespace

void check_netcdf_header(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::array<char, 3> mark{};
    file.read(mark.data(), mark.size());
    if (file.gcount() != 3 || mark != std::array{'C', 'D', 'F'}) return;
    ClassicHeader(path, std::filesystem::file_size(path)).check();
}

}  // namespace trochoid
