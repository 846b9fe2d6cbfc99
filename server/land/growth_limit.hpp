#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/land/land_area.hpp"
#include "server/land/node_field.hpp"
#include "server/land/wave_bands.hpp"

namespace trochoid {

/// How much steeper than in open water land makes a band: the largest gain * orbit * |k'| / k of a cell.
struct BandGrowth {
    /// Per block of the area, row-major: the largest of its cells, squared; 1 where the field is open water.
    std::vector<float> squared;
    /// Cells that were above the limit.
    uint64_t limited_cells = 0;
};

/// How much steeper each band may become, so that the box as a whole does not become steeper than growth_max times open water's:
/// the mean of the bands' allowances, weighted by their sum of A k, is growth_max, and each band's excess is in proportion to
/// what it would grow without a limit at the depth where the box's waves break. Every band then keeps its own, whatever the others do.
/// `unlimited`: that growth, at least 1, one a band.
std::vector<double> growth_allowances(std::span<const WaveBand> bands, std::span<const double> unlimited,
                                      double growth_max);

class GrowthLimiter;

/// Where shoaling and refraction make the band's waves steeper than `allowed` times open water's, they break: lowers the gains at the
/// nodes around; where flatter orbits do, lowers the orbits. Nodes in open water stay so, since their neighbours may have
/// no block. Looks at the blocks marked in `live` (row-major, one a block); all others count as open water.
class GrowthLimit {
public:
    GrowthLimit(NodeField& field, const LandArea& area, std::span<const uint8_t> live, const WaveBand& band,
                double allowed);
    ~GrowthLimit();
    GrowthLimit(const GrowthLimit&) = delete;
    GrowthLimit& operator=(const GrowthLimit&) = delete;

    /// Every row of blocks once, when its nodes are filled and its live blocks marked.
    void measure(int32_t bz);
    /// Lowers what is above the limit; after all rows were measured.
    BandGrowth limited();

private:
    const NodeField& field_;
    std::unique_ptr<GrowthLimiter> limiter_;
    float limit_square_;
    float largest_ = 1.0F;
    BandGrowth result_;
};

}  // namespace trochoid
