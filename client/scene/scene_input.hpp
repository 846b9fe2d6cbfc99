#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/model/interest_state.hpp"
#include "protocol/model/sea.hpp"
#include "protocol/model/terrain.hpp"
#include "protocol/model/wave_ray.hpp"
#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// Where the terrain's height raster lies; columns 0 means open sea everywhere.
struct TerrainExtent {
    int64_t origin_x = 0;  ///< lattice units of sample [0][0]
    int64_t origin_z = 0;
    uint32_t spacing_log2 = 15;  ///< sample spacing = 2^spacing_log2 lattice units
    uint32_t columns = 0;
    uint32_t rows = 0;
    int32_t open_sea_depth = 0;  ///< bed level far outside, lattice units, negative
    bool operator==(const TerrainExtent&) const = default;
};

/// Whether this client computes the same sea as the server, as the known-answer challenge said.
enum class Fidelity : uint8_t { unknown, exact, approximate };
const char* name_of(Fidelity fidelity);

/// What the connection tells about itself, for the overlay and the summary.
struct SourceStatistics {
    bool connected = false;
    std::string state;           ///< one sentence for people: "connected", "server gone, trying again in 2 s"
    std::string server_version;  ///< software and version as the hello named it
    uint64_t bytes_received = 0;    ///< since the start, on the socket
    double bytes_per_second = 0.0;  ///< received, over the last seconds
    double clock_error_ms = 0.0;    ///< bound of the sea clock's error
    Fidelity fidelity = Fidelity::unknown;
    uint32_t deltas = 0;   ///< results applied
    uint32_t resyncs = 0;  ///< results whose hash did not match
    uint32_t desyncs = 0;  ///< probes that found another sea than the server's
    uint64_t log_position = 0;
    float error_in_force_px = 1.0F;  ///< height error that the server culls by, pixels
    SeaTime known_until =
        end_of_time;  ///< later events may still change the sea: pictures of later times have to wait
    bool operator==(const SourceStatistics&) const = default;
};

/// All that a picture is made from. Values; the shared ones are immutable, so a pointer that did not change is a value
/// that did not change.
struct SceneInput {
    std::shared_ptr<const InterestState>
        state;  ///< boxes, land blocks, patches; null before the first result
    /// The same boxes, prepared with their land; none where the source has not prepared them.
    std::optional<Sea> sea;
    SeaTime now;
    TerrainExtent terrain;
    std::vector<std::shared_ptr<const TerrainTile>> tiles;  ///< any order, one per key
    std::vector<WaveRay> rays;
    SourceStatistics statistics;
};

}  // namespace trochoid
