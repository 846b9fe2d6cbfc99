#include <algorithm>

#include "protocol/codec/plane_coding.hpp"
#include "protocol/model/terrain_file.hpp"
#include "protocol/units/hash.hpp"
#include "tests/fuzz/allocation_meter.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace trochoid {

namespace {

template <class T>
void check_plane(std::span<const uint8_t> coded, size_t columns, size_t rows) {
    const Bytes bytes = owned(coded);
    std::vector<T> values(columns * rows);
    std::span<const uint8_t> in(bytes);
    if (!read_plane(in, std::span<T>(values), columns)) return;
    // Only the shortest form is legal: what was read is what is written.
    Bytes again;
    append_plane(again, std::span<const T>(values), columns);
    const size_t used = bytes.size() - in.size();
    TROCHOID_ASSERT(again.size() == used && std::equal(again.begin(), again.end(), bytes.begin()),
                    "{} bytes read, {} written", used, again.size());
}

void check_planes(std::span<const uint8_t> input) {
    InputReader control(input);
    const uint8_t form = control.byte();
    const size_t columns = 1 + control.byte() % 65U;
    const size_t rows = 1 + control.byte() % 65U;
    switch (form % 5) {
        case 0: return check_plane<int16_t>(control.rest(), columns, rows);
        case 1: return check_plane<uint16_t>(control.rest(), columns, rows);
        case 2: return check_plane<int32_t>(control.rest(), columns, rows);
        case 3: {
            LandBlock block;
            const Bytes bytes = owned(control.rest());
            if (const auto read = read_nodes(bytes, block); !read) return check_refusal(read.error());
            TROCHOID_ASSERT(code_nodes(block) == bytes, "other bytes for the same land block");
            return;
        }
        default: {
            TerrainTile tile;
            const Bytes bytes = owned(control.rest());
            if (const auto read = read_heights(bytes, tile); !read) return check_refusal(read.error());
            TROCHOID_ASSERT(code_heights(tile) == bytes, "other bytes for the same tile");
        }
    }
}

Bytes mutate_planes(const Bytes& input, Dice& dice, size_t most) {
    Bytes out{static_cast<uint8_t>(dice.between(0, 4)), static_cast<uint8_t>(dice.between(0, 64)),
              static_cast<uint8_t>(dice.between(0, 64))};
    if (dice.coin() && input.size() > 3) std::copy_n(input.begin(), 3, out.begin());
    if (out[0] % 5 == 3) {
        const Bytes coded = code_nodes(random_block(dice, {0, 0}));
        out.insert(out.end(), coded.begin(), coded.end());
    } else {
        std::vector<int16_t> values((1 + out[1] % 65U) * (1 + out[2] % 65U));
        for (int16_t& v : values) v = dice.between(0, 3) == 0 ? dice.any<int16_t>() : int16_t{7};
        append_plane(out, std::span<const int16_t>(values), 1 + out[1] % 65U);
    }
    if (dice.coin() && out.size() > 4)
        out[static_cast<size_t>(dice.between(3, static_cast<int64_t>(out.size()) - 1))] = dice.any<uint8_t>();
    return out.size() <= most ? out : Bytes{};
}

/// A terrain file has one form: what decodes encodes to the same bytes, and takes no more memory than the file accounts for.
void check_terrain(std::span<const uint8_t> input) {
    const Bytes bytes = owned(input);
    const AllocationMeter meter;
    const auto grid = decode_terrain(bytes);
    TROCHOID_ASSERT(meter.bytes() <= 4096 + 4 * bytes.size(), "{} bytes for a file of {}", meter.bytes(),
                    bytes.size());
    if (!grid) return check_refusal(grid.error());
    TROCHOID_ASSERT(encode_terrain(*grid) == bytes, "other bytes for the same terrain");
}

/// The hash that closes the file.
void repair_terrain(std::span<uint8_t> input) {
    if (input.size() < 8) return;
    const auto hashed = input.first(input.size() - 8);
    uint64_t hash = 0xcbf29ce484222325U;
    for (const uint8_t b : hashed) hash = (hash ^ b) * 0x100000001b3U;
    for (size_t i = 0; i < 8; ++i) input[hashed.size() + i] = static_cast<uint8_t>(hash >> (8 * i));
}

/// A length and a key that only whoever reads the program, or its coverage, finds.
void check_planted(std::span<const uint8_t> input) {
    if (input.size() < 6 || input[0] != 'R' || input[1] != 'e' || input[2] != 'e' || input[3] != 'f') return;
    TROCHOID_ASSERT(input[4] != '!' || input[5] < 0x80, "planted");
}

}  // namespace

const FuzzTarget planes_target{"planes", check_planes, 16'384, mutate_planes};
const FuzzTarget terrain_target{"terrain_file", check_terrain, 4096, nullptr, repair_terrain};
const FuzzTarget planted_target{"planted", check_planted, 64};

}  // namespace trochoid
