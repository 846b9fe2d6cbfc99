#include "protocol/model/terrain_file.hpp"

#include <algorithm>
#include <bit>
#include <string_view>
#include <utility>

#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {
namespace {

constexpr std::string_view magic = "TROCHTER";
constexpr std::size_t hash_bytes = 8;

class ByteWriter {
public:
    void number(uint64_t value, int count) {
        for (int i = 0; i < count; ++i) bytes_.push_back(static_cast<uint8_t>(value >> (8 * i)));
    }
    void raw(std::string_view text) {
        for (const char c : text) bytes_.push_back(static_cast<uint8_t>(c));
    }
    void counted(std::string_view text) {
        TROCHOID_ASSERT(text.size() <= terrain_text_max, "{} bytes", text.size());
        number(text.size(), 2);
        raw(text);
    }
    void reserve(std::size_t count) { bytes_.reserve(count); }
    std::vector<uint8_t> take_with_hash() {
        number(Hash64().bytes(bytes_).value(), hash_bytes);
        return std::move(bytes_);
    }

private:
    std::vector<uint8_t> bytes_;
};

/// Reads numbers in order; after the first read beyond the end every read gives 0 and `cut_short` says so.
class ByteReader {
public:
    explicit ByteReader(std::span<const uint8_t> bytes) : rest_(bytes) {}

    uint64_t number(std::size_t count) {
        uint64_t value = 0;
        const auto part = take(count);
        for (std::size_t i = 0; i < part.size(); ++i) value |= uint64_t{part[i]} << (8 * i);
        return value;
    }
    uint32_t u32() { return static_cast<uint32_t>(number(4)); }
    int32_t i32() { return static_cast<int32_t>(u32()); }
    int64_t i64() { return static_cast<int64_t>(number(8)); }
    double f64() { return std::bit_cast<double>(number(8)); }
    std::string counted() {
        const auto length = static_cast<std::size_t>(number(2));
        const auto part = take(length);
        return std::string(part.begin(), part.end());
    }
    std::span<const uint8_t> take(std::size_t count) {
        if (count > rest_.size()) {
            cut_short_ = true;
            rest_ = {};
            return {};
        }
        const auto part = rest_.first(count);
        rest_ = rest_.subspan(count);
        return part;
    }
    std::size_t left() const { return rest_.size(); }
    bool cut_short() const { return cut_short_; }

private:
    std::span<const uint8_t> rest_;
    bool cut_short_ = false;
};

Error cut_short_error() {
    return {ErrorCode::malformed_frame, "the terrain is cut short: copy or import it again"};
}

/// The members before the heights.
TerrainGrid read_header(ByteReader& reader) {
    TerrainGrid grid;
    grid.origin_x = reader.i64();
    grid.origin_z = reader.i64();
    grid.spacing_log2 = reader.u32();
    grid.columns = reader.u32();
    grid.rows = reader.u32();
    grid.height_step_log2 = reader.i32();
    grid.open_sea_depth = reader.i32();
    grid.origin_lon = reader.f64();
    grid.origin_lat = reader.f64();
    grid.projection = reader.counted();
    grid.provenance = reader.counted();
    return grid;
}

}  // namespace

std::vector<uint8_t> encode_terrain(const TerrainGrid& grid) {
    const char* fault = terrain_fault(grid);
    TROCHOID_ASSERT(fault == nullptr, "{}", fault);
    ByteWriter writer;
    writer.reserve(256 + grid.projection.size() + grid.provenance.size() + 2 * grid.heights.size());
    writer.raw(magic);
    writer.number(terrain_file_version, 4);
    writer.number(static_cast<uint64_t>(grid.origin_x), 8);
    writer.number(static_cast<uint64_t>(grid.origin_z), 8);
    writer.number(grid.spacing_log2, 4);
    writer.number(grid.columns, 4);
    writer.number(grid.rows, 4);
    writer.number(static_cast<uint32_t>(grid.height_step_log2), 4);
    writer.number(static_cast<uint32_t>(grid.open_sea_depth), 4);
    writer.number(std::bit_cast<uint64_t>(grid.origin_lon), 8);
    writer.number(std::bit_cast<uint64_t>(grid.origin_lat), 8);
    writer.counted(grid.projection);
    writer.counted(grid.provenance);
    for (const int16_t height : grid.heights) writer.number(static_cast<uint16_t>(height), 2);
    return writer.take_with_hash();
}

Result<TerrainGrid> decode_terrain(std::span<const uint8_t> bytes) {
    const auto same = [](char expected, uint8_t found) { return static_cast<uint8_t>(expected) == found; };
    if (bytes.size() < magic.size() || !std::equal(magic.begin(), magic.end(), bytes.begin(), same))
        return Error{ErrorCode::wrong_magic, "this is no terrain: make one with trochoid-import"};
    ByteReader reader(bytes.subspan(magic.size()));
    const uint32_t version = reader.u32();
    if (reader.cut_short()) return cut_short_error();
    if (version != terrain_file_version)
        return Error{ErrorCode::protocol_version,
                     fmt::format("the terrain has format version {}, this program reads {}: import it again",
                                 version, terrain_file_version)};
    TerrainGrid grid = read_header(reader);
    if (reader.cut_short()) return cut_short_error();
    // Both sides fit 32 bits, so the product cannot overflow before it is compared with what is there.
    const uint64_t samples = uint64_t{grid.columns} * grid.rows;
    const uint64_t left = reader.left();
    if (samples > left / 2 || samples * 2 + hash_bytes > left) return cut_short_error();
    if (samples * 2 + hash_bytes < left)
        return Error{ErrorCode::trailing_bytes,
                     "there are bytes behind the end of the terrain: import it again"};
    const uint64_t computed = Hash64().bytes(bytes.first(bytes.size() - hash_bytes)).value();
    const auto height_bytes = reader.take(static_cast<std::size_t>(samples) * 2);
    if (reader.number(hash_bytes) != computed)
        return Error{ErrorCode::verification_failed,
                     "the terrain's bytes do not match its hash: copy or import it again"};
    grid.heights.reserve(static_cast<std::size_t>(samples));
    for (std::size_t i = 0; i < height_bytes.size(); i += 2)
        grid.heights.push_back(static_cast<int16_t>(height_bytes[i] | (height_bytes[i + 1] << 8)));
    if (grid.projection.size() > terrain_text_max || grid.provenance.size() > terrain_text_max)
        return Error{ErrorCode::value_out_of_range,
                     "a text of the terrain is longer than 4096 bytes: import it again"};
    if (const char* fault = terrain_fault(grid))
        return Error{ErrorCode::value_out_of_range, fmt::format("in the terrain {}: import it again", fault)};
    return grid;
}

uint64_t terrain_hash(const TerrainGrid& grid) {
    const std::vector<uint8_t> bytes = encode_terrain(grid);
    uint64_t hash = 0;
    for (std::size_t i = 0; i < hash_bytes; ++i)
        hash |= uint64_t{bytes[bytes.size() - hash_bytes + i]} << (8 * i);
    return hash;
}

}  // namespace trochoid
