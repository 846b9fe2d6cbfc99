#include "tests/determinism/places.hpp"

#include <fmt/format.h>

#include "protocol/model/interest_state.hpp"

namespace trochoid {
namespace {

constexpr size_t most_boxes_seen = 4;

}  // namespace

std::vector<LatticePoint> places_to_look_at(const SeaInstant& instant) {
    std::vector<LatticePoint> places{{0, 0}};
    for (const LiveBox& live : instant.live()) {
        if (places.size() > most_boxes_seen) break;
        const WaveTrainBox& box = live.box->record;
        if (box.length == 0 || box.width == 0) continue;
        const int64_t u = live.instant.front / 2;
        const int64_t v = box.width / 2;
        places.push_back({live.instant.origin.x + ((u * box.ux - v * box.uz) >> 30),
                          live.instant.origin.z + ((u * box.uz + v * box.ux) >> 30)});
    }
    return places;
}

std::string tile_and_point(LatticePoint p) {
    const PatchKey tile = patch_at(p, 16);
    return fmt::format("tile {}/{},{} point {},{}", tile.level, tile.x, tile.z, p.x, p.z);
}

}  // namespace trochoid
