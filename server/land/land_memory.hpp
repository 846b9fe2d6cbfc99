#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/model/land_field.hpp"
#include "server/land/band_march.hpp"
#include "server/land/land_area.hpp"
#include "server/land/land_settings.hpp"
#include "server/land/wave_bands.hpp"

namespace trochoid {

/// What a band's trace leaves for the next one.
struct BandMemory {
    std::vector<MarchCheckpoint> checkpoints;
    /// BandGrid::tile_hashes.
    std::vector<uint64_t> tile_hashes;
    /// BandGrowth::squared.
    std::vector<float> growth;
};

/// What a trace keeps so that a later one over changed land need not start anew. It never decides a result: with other bands,
/// another area or other settings it is not used.
struct LandMemory {
    LandArea area;
    LandSettings settings;
    double height = 0.0;
    std::vector<WaveBand> bands;
    /// One a band.
    std::vector<std::shared_ptr<const BandMemory>> marches;
    /// The field that counts for the band, with its bases; null: open water.
    std::vector<std::shared_ptr<const LandField>> fields;
};

}  // namespace trochoid
