#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "server/land/depth_response.hpp"
#include "server/land/land_area.hpp"
#include "server/land/land_settings.hpp"
#include "server/land/node_planes.hpp"
#include "server/land/tile_marks.hpp"
#include "server/land/wave_bands.hpp"

namespace trochoid {

/// What the land makes of one band, on a grid whose rows lie across the band's direction and whose columns are its rays.
/// Row i, column j lies at node coordinates (centre_x + (i * row_step - centre_row) * dx - (j - centre_column) * dz,
/// centre_z + (i * row_step - centre_row) * dz + (j - centre_column) * dx): v points to the right of travel, as a box's does.
struct BandGrid {
    int32_t rows = 0;
    int32_t columns = 0;
    /// Nodes from row to row; columns are one node apart.
    double row_step = 1.0;
    double centre_row = 0.0;
    double centre_column = 0.0;
    double centre_x = 0.0;
    double centre_z = 0.0;
    double dx = 1.0;
    double dz = 0.0;
    /// First row held: of a whole march the last that land or a shallow does not change; all before read shift 0 and shelter 1.
    int32_t first_row = 0;
    /// Whether rows are held; else nothing is changed anywhere, and shift and shelter mean nothing.
    bool held = false;
    /// From first_row on, row-major, per point: phase shift in turns.
    std::vector<float> shift;
    /// Alike: the share of the open sea's height that reaches the point before it grows over the bottom: 1 in open water, 0 on land.
    std::vector<float> shelter;
    /// Where the shift may differ from 0 and the shelter from 1; spread. Rows count from first_row.
    static constexpr uint8_t shifts = 1;
    static constexpr uint8_t shelters = 2;
    TileMarks marks;
    /// Of shift and shelter in tiles of 16 rows (counted from row 0 of a whole march) and 16 columns, row-major: a march over changed land
    /// has other values only in tiles whose hash has changed (but for a chance of 2^-64).
    std::vector<uint64_t> tile_hashes;
    /// Columns whose slope across had to be cut to what nodes carry (60 turns a node).
    uint64_t cut_slopes = 0;
    uint64_t rows_marched = 0;

    /// Row and column coordinates of a node.
    double row_of(double x, double z) const {
        return ((x - centre_x) * dx + (z - centre_z) * dz + centre_row) / row_step;
    }
    double column_of(double x, double z) const {
        return (z - centre_z) * dx - (x - centre_x) * dz + centre_column;
    }
};

/// States of a march every few rows, so that it can be taken up again.
struct MarchCheckpoint {
    int32_t row = 0;
    std::vector<float> state;
};
inline constexpr int32_t checkpoint_rows = 64;

/// Tiles of BandGrid::tile_hashes across a grid.
inline size_t tiles_across(const BandGrid& grid) {
    return static_cast<size_t>((grid.columns - 1) / TileMarks::side) + 1;
}

/// The grid's frame over the area, or over the box (LandArea::corners) where that is less; nothing marched yet.
void set_frame(BandGrid& grid, const LandArea& area, const WaveBand& band, const LandSettings& settings);

/// Marches a framed band over the planes. `checkpoints` come from an earlier march and are good up to row `from`: the march goes on
/// from the last of them, and earlier rows' tile hashes stay as they are; with none it begins where the land does. Adds its own.
void march_band(BandGrid& grid, const LandArea& area, const NodePlanes& planes, const WaveBand& band,
                const DepthResponse& response, const LandSettings& settings,
                std::vector<MarchCheckpoint>& checkpoints);

}  // namespace trochoid
