#include "protocol/codec/plane_coding.hpp"

#include <limits>
#include <optional>

namespace trochoid {

namespace {

// |prediction| <= 3 * 2^31, so a residual's zigzag has at most 35 bits.
constexpr int longest_varint = 5;

void append_varint(Bytes& out, uint64_t v) {
    for (; v >= 0x80; v >>= 7) out.push_back(static_cast<uint8_t>(v | 0x80U));
    out.push_back(static_cast<uint8_t>(v));
}

std::optional<uint64_t> read_varint(std::span<const uint8_t>& in) {
    uint64_t v = 0;
    for (int i = 0; i < longest_varint && static_cast<size_t>(i) < in.size(); ++i) {
        const uint8_t byte = in[static_cast<size_t>(i)];
        v |= static_cast<uint64_t>(byte & 0x7fU) << (7 * i);
        if ((byte & 0x80U) != 0) continue;
        if (byte == 0 && i > 0) return std::nullopt;  // a shorter form exists
        in = in.subspan(static_cast<size_t>(i) + 1);
        return v;
    }
    return std::nullopt;
}

uint64_t zigzag(int64_t v) { return (static_cast<uint64_t>(v) << 1) ^ (v < 0 ? ~uint64_t{0} : 0); }
int64_t unzigzag(uint64_t v) { return static_cast<int64_t>(v >> 1) ^ -static_cast<int64_t>(v & 1); }

template <class T>
int64_t prediction(std::span<const T> values, size_t i, size_t columns) {
    const bool first_row = i < columns;
    const bool first_column = i % columns == 0;
    if (first_row) return first_column ? 0 : int64_t{values[i - 1]};
    if (first_column) return values[i - columns];
    return int64_t{values[i - 1]} + values[i - columns] - values[i - columns - 1];
}

}  // namespace

template <class T>
void append_plane(Bytes& out, std::span<const T> values, size_t columns) {
    uint64_t zeros = 0;
    const auto end_run = [&] {
        if (zeros == 0) return;
        append_varint(out, 0);
        append_varint(out, zeros - 1);
        zeros = 0;
    };
    for (size_t i = 0; i < values.size(); ++i) {
        const int64_t residual = values[i] - prediction(values, i, columns);
        if (residual == 0) {
            ++zeros;
            continue;
        }
        end_run();
        append_varint(out, zigzag(residual));
    }
    end_run();
}

template <class T>
bool read_plane(std::span<const uint8_t>& in, std::span<T> values, size_t columns) {
    uint64_t zeros = 0;
    bool after_run = false;
    for (size_t i = 0; i < values.size(); ++i) {
        int64_t residual = 0;
        if (zeros > 0) {
            --zeros;
        } else {
            const auto token = read_varint(in);
            if (!token || (*token == 0 && after_run)) return false;
            after_run = *token == 0;
            residual = unzigzag(*token);
            if (after_run) {
                const auto more = read_varint(in);
                if (!more || *more >= values.size() - i) return false;
                zeros = *more;
            }
        }
        const int64_t value = prediction(std::span<const T>(values), i, columns) + residual;
        if (value < std::numeric_limits<T>::min() || value > std::numeric_limits<T>::max()) return false;
        values[i] = static_cast<T>(value);
    }
    return true;
}

template void append_plane(Bytes&, std::span<const int32_t>, size_t);
template void append_plane(Bytes&, std::span<const int16_t>, size_t);
template void append_plane(Bytes&, std::span<const uint16_t>, size_t);
template bool read_plane(std::span<const uint8_t>&, std::span<int32_t>, size_t);
template bool read_plane(std::span<const uint8_t>&, std::span<int16_t>, size_t);
template bool read_plane(std::span<const uint8_t>&, std::span<uint16_t>, size_t);

Bytes code_nodes(const LandBlock& block) {
    Bytes out;
    append_plane(out, std::span<const int32_t>(block.shift), block_nodes);
    append_plane(out, std::span<const uint16_t>(block.gain), block_nodes);
    if (block.orbit != LandBlock::unit_orbits())
        append_plane(out, std::span<const uint16_t>(block.orbit), block_nodes);
    return out;
}

Result<Done> read_nodes(std::span<const uint8_t> in, LandBlock& block) {
    const Error uncoded{ErrorCode::value_out_of_range,
                        "a land block's nodes are not 17 x 17 shifts, gains and orbits in the plane coding"};
    if (!read_plane(in, std::span<int32_t>(block.shift), block_nodes) ||
        !read_plane(in, std::span<uint16_t>(block.gain), block_nodes))
        return uncoded;
    block.orbit = LandBlock::unit_orbits();
    if (!in.empty()) {
        if (!read_plane(in, std::span<uint16_t>(block.orbit), block_nodes) || !in.empty()) return uncoded;
        if (block.orbit == LandBlock::unit_orbits())
            return Error{ErrorCode::value_out_of_range,
                         "a land block's orbits are all 1: such a plane is left out"};
    }
    return validate(block);
}

Bytes code_heights(const TerrainTile& tile) {
    Bytes out;
    append_plane(out, std::span<const int16_t>(tile.heights), terrain_tile_samples);
    return out;
}

Result<Done> read_heights(std::span<const uint8_t> in, TerrainTile& tile) {
    tile.heights.resize(size_t{terrain_tile_samples} * terrain_tile_samples);
    if (!read_plane(in, std::span<int16_t>(tile.heights), terrain_tile_samples) || !in.empty())
        return Error{ErrorCode::value_out_of_range,
                     "a terrain tile's heights are not 65 x 65 counts in the plane coding"};
    return Done{};
}

}  // namespace trochoid
