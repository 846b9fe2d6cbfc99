#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "server/land/depth_response.hpp"
#include "server/land/land_area.hpp"
#include "server/land/land_settings.hpp"
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
    /// First row that land or a shallow changes; all before read shift 0 and shelter 1.
    int32_t first_row = 0;
    /// From first_row on, row-major: phase shift in turns, and the share of the open sea's height that reaches the
    /// point before it grows over the bottom: 1 in open water, 0 on land.
    std::vector<float> shift;
    std::vector<float> shelter;
    /// Columns whose slope across had to be cut to what nodes carry (60 turns a node).
    uint64_t cut_slopes = 0;

    /// Bilinear at node coordinates; points outside read the nearest.
    struct Value {
        double shift;
        double shelter;
    };
    Value at(double x, double z) const;
};

/// Marches the band over the area. `depths` are node_depths.
BandGrid march_band(const LandArea& area, std::span<const float> depths, const WaveBand& band,
                    const DepthResponse& response, const LandSettings& settings);

/// Depths limited to [shallowest, deep] and averaged over about a quarter wave length (binomial passes at node scale), so that
/// a noisy shore does not scatter phases between nodes; deep stays exactly deep away from shallows.
std::vector<float> phase_depths(const LandArea& area, std::span<const float> depths, const WaveBand& band,
                                const DepthResponse& response);

}  // namespace trochoid
