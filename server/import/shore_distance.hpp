#pragma once

#include <cstdint>
#include <vector>

#include "protocol/model/terrain.hpp"
#include "server/import/shore_line.hpp"

namespace trochoid {

/// Which of a grid's samples are land (1) or sea (0), row-major, by the even-odd rule; a point exactly on a ring's
/// western or northern side counts as inside.
struct LandMask {
    std::vector<uint8_t> land;
    /// Rings that reach into the grid's rectangle yet hold no sample: rocks smaller than a cell.
    std::size_t rings_without_sample = 0;
};

LandMask land_mask(const TerrainGrid& grid, const std::vector<ShoreRing>& rings);

/// Exact distance from any point to the nearest of the rings' sides, through a tree of bounding boxes.
class ShoreDistance {
public:
    explicit ShoreDistance(const std::vector<ShoreRing>& rings);

    /// Metres; infinity where there is no shore.
    double at(EastNorth point) const;

    struct Side {
        EastNorth from;
        EastNorth to;
    };

private:
    struct Box {
        double west, east, south, north;
    };
    struct Node {
        Box box;
        /// Sides [first, last); an inner node's halves are the node after it and `right`.
        uint32_t first, last, right;
    };

    uint32_t build(uint32_t first, uint32_t last);
    void search(uint32_t node, EastNorth point, double& best_squared) const;
    static double squared_to_box(const Box& box, EastNorth point);

    std::vector<Side> sides_;
    std::vector<Node> nodes_;
};

/// Square of the distance from a point to a side, square metres.
double squared_distance(const ShoreDistance::Side& side, EastNorth point);

}  // namespace trochoid
