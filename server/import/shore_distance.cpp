#include "server/import/shore_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "protocol/units/lattice.hpp"

namespace trochoid {
namespace {

/// Below this many sides a tree's node is searched one by one.
constexpr uint32_t leaf_sides = 4;

/// Toggles the samples inside one ring; returns how many there are.
std::size_t toggle_inside(const TerrainGrid& grid, const ShoreRing& ring, std::vector<uint8_t>& land) {
    const double spacing = to_metres(int64_t{1} << grid.spacing_log2);
    const double west = to_metres(grid.origin_x);
    const double north = -to_metres(grid.origin_z);
    // Crossings of each sample row with the ring's sides, metres east.
    std::vector<std::vector<double>> crossings(grid.rows);
    for (std::size_t i = 0; i < ring.size(); ++i) {
        EastNorth upper = ring[i];
        EastNorth lower = ring[(i + 1) % ring.size()];
        if (upper.north < lower.north) std::swap(upper, lower);
        // Rows with lower.north < row's north <= upper.north: half open, so a corner counts once.
        const double last_row = static_cast<double>(grid.rows) - 1.0;
        const double first = std::max(0.0, std::ceil((north - upper.north) / spacing) - 1.0);
        for (double row = first; row <= last_row; row += 1.0) {
            const double at = north - row * spacing;
            if (at > upper.north) continue;
            if (at <= lower.north) break;
            const double share = (at - lower.north) / (upper.north - lower.north);
            crossings[static_cast<std::size_t>(row)].push_back(lower.east +
                                                               share * (upper.east - lower.east));
        }
    }
    std::size_t inside = 0;
    for (std::size_t row = 0; row < crossings.size(); ++row) {
        std::vector<double>& line = crossings[row];
        std::sort(line.begin(), line.end());
        for (std::size_t i = 0; i + 1 < line.size(); i += 2) {
            const double last = static_cast<double>(grid.columns);
            const double from = std::clamp(std::ceil((line[i] - west) / spacing), 0.0, last);
            const double to = std::clamp(std::ceil((line[i + 1] - west) / spacing), 0.0, last);
            for (auto column = static_cast<std::size_t>(from); column < static_cast<std::size_t>(to);
                 ++column) {
                land[row * grid.columns + column] ^= 1;
                ++inside;
            }
        }
    }
    return inside;
}

bool reaches_into(const TerrainGrid& grid, const ShoreRing& ring) {
    const double width = to_metres((int64_t{grid.columns} - 1) << grid.spacing_log2);
    const double depth = to_metres((int64_t{grid.rows} - 1) << grid.spacing_log2);
    const double west = to_metres(grid.origin_x);
    const double north = -to_metres(grid.origin_z);
    return std::any_of(ring.begin(), ring.end(), [&](EastNorth p) {
        return p.east >= west && p.east <= west + width && p.north <= north && p.north >= north - depth;
    });
}

}  // namespace

LandMask land_mask(const TerrainGrid& grid, const std::vector<ShoreRing>& rings) {
    LandMask mask;
    mask.land.assign(std::size_t{grid.columns} * grid.rows, 0);
    for (const ShoreRing& ring : rings)
        if (toggle_inside(grid, ring, mask.land) == 0 && reaches_into(grid, ring))
            ++mask.rings_without_sample;
    return mask;
}

double squared_distance(const ShoreDistance::Side& side, EastNorth point) {
    const double along_east = side.to.east - side.from.east;
    const double along_north = side.to.north - side.from.north;
    const double from_east = point.east - side.from.east;
    const double from_north = point.north - side.from.north;
    const double length_squared = along_east * along_east + along_north * along_north;
    double share = 0.0;
    if (length_squared > 0.0)
        share = std::clamp((from_east * along_east + from_north * along_north) / length_squared, 0.0, 1.0);
    const double off_east = from_east - share * along_east;
    const double off_north = from_north - share * along_north;
    return off_east * off_east + off_north * off_north;
}

ShoreDistance::ShoreDistance(const std::vector<ShoreRing>& rings) {
    for (const ShoreRing& ring : rings)
        for (std::size_t i = 0; i < ring.size(); ++i)
            sides_.push_back({ring[i], ring[(i + 1) % ring.size()]});
    if (!sides_.empty()) build(0, static_cast<uint32_t>(sides_.size()));
}

uint32_t ShoreDistance::build(uint32_t first, uint32_t last) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    Box box{infinite, -infinite, infinite, -infinite};
    for (uint32_t i = first; i < last; ++i) {
        const Side& side = sides_[i];
        box.west = std::min({box.west, side.from.east, side.to.east});
        box.east = std::max({box.east, side.from.east, side.to.east});
        box.south = std::min({box.south, side.from.north, side.to.north});
        box.north = std::max({box.north, side.from.north, side.to.north});
    }
    const auto index = static_cast<uint32_t>(nodes_.size());
    nodes_.push_back({box, first, last, 0});
    if (last - first <= leaf_sides) return index;
    const bool split_east = box.east - box.west > box.north - box.south;
    const auto middle_of = [split_east](const Side& s) {
        return split_east ? s.from.east + s.to.east : s.from.north + s.to.north;
    };
    const uint32_t middle = first + (last - first) / 2;
    std::nth_element(sides_.begin() + first, sides_.begin() + middle, sides_.begin() + last,
                     [&](const Side& a, const Side& b) { return middle_of(a) < middle_of(b); });
    build(first, middle);
    nodes_[index].right = build(middle, last);
    return index;
}

double ShoreDistance::squared_to_box(const Box& box, EastNorth point) {
    const double east = std::max({box.west - point.east, 0.0, point.east - box.east});
    const double north = std::max({box.south - point.north, 0.0, point.north - box.north});
    return east * east + north * north;
}

void ShoreDistance::search(uint32_t index, EastNorth point, double& best_squared) const {
    const Node& node = nodes_[index];
    if (squared_to_box(node.box, point) >= best_squared) return;
    if (node.last - node.first <= leaf_sides) {
        for (uint32_t i = node.first; i < node.last; ++i)
            best_squared = std::min(best_squared, squared_distance(sides_[i], point));
        return;
    }
    // The nearer half first: it shrinks the search in the other.
    uint32_t nearer = index + 1;
    uint32_t farther = node.right;
    if (squared_to_box(nodes_[farther].box, point) < squared_to_box(nodes_[nearer].box, point))
        std::swap(nearer, farther);
    search(nearer, point, best_squared);
    search(farther, point, best_squared);
}

double ShoreDistance::at(EastNorth point) const {
    double best_squared = std::numeric_limits<double>::infinity();
    if (!nodes_.empty()) search(0, point, best_squared);
    return std::sqrt(best_squared);
}

}  // namespace trochoid
