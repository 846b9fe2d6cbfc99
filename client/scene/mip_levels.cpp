#include "client/scene/mip_levels.hpp"

#include <cstddef>
#include <utility>

namespace trochoid {

namespace {

MipLevel halved(const MipLevel& fine, uint32_t side) {
    MipLevel coarse(size_t{side / 2} * (side / 2));
    for (uint32_t z = 0; z < side / 2; ++z)
        for (uint32_t x = 0; x < side / 2; ++x)
            for (size_t c = 0; c < 4; ++c) {
                const auto at = [&](uint32_t i, uint32_t j) {
                    return fine[(2 * z + j) * side + 2 * x + i][c];
                };
                coarse[z * (side / 2) + x][c] = 0.25F * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1));
            }
    return coarse;
}

}  // namespace

std::vector<MipLevel> with_coarser_levels(MipLevel finest, uint32_t side) {
    std::vector<MipLevel> levels;
    levels.push_back(std::move(finest));
    for (uint32_t s = side; s > 1; s /= 2) levels.push_back(halved(levels.back(), s));
    return levels;
}

}  // namespace trochoid
