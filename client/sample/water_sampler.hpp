#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "client/store/client_store.hpp"
#include "protocol/model/point_query.hpp"

namespace trochoid {

/// How far an answer can be trusted.
enum class Trust : uint8_t {
    exact,    ///< inside a sync region, not long past: the sea of these layers, bit for bit
    bounded,  ///< inside a delivered patch, authoritative layers: off by at most `height_error`
    unknown,  ///< outside everything that the server has told us of
};

struct WaterAnswer {
    WaterPoint water;
    Trust trust = Trust::unknown;
    bool confirmed = false;     ///< the time lies before the watermark: no event can change it any more
    float height_error = 0.0F;  ///< m; 0 where exact, the patch's H where bounded
    bool operator==(const WaterAnswer&) const = default;
};

/// Reads one snapshot at one sea time; many points share the work per time. Physics takes the authoritative layers;
/// what has to lie on the water that is seen takes displayed_layers (without the fading by distance).
class WaterSampler {
public:
    WaterSampler(std::shared_ptr<const StoreSnapshot> snapshot, SeaTime t,
                 Layers layers = authoritative_layers);
    /// The water at a fixed horizontal place.
    WaterAnswer water(LatticePoint place) const;
    /// The same at many places, in their order and to the bit, some twenty times as fast; near ones are best given next to each other.
    std::vector<WaterAnswer> water(std::span<const LatticePoint> places) const;
    /// The surface's own sample at a rest point.
    SurfaceSample surface(LatticePoint rest) const { return instant_.evaluate(rest); }
    std::vector<SurfaceSample> surface(std::span<const LatticePoint> rests) const;
    /// Of what is told of this place. In a sync region it holds for events up to now: `confirmed` says whether one may come.
    Trust trust(LatticePoint place) const;

private:
    WaterAnswer answer(LatticePoint place, const WaterPoint& water) const;
    const PatchDescriptor* patch_at(LatticePoint place) const;
    std::shared_ptr<const StoreSnapshot> snapshot_;
    SeaInstant instant_;
};

/// True where the place lies in the disc (closed).
bool contains(const SyncRegion& region, LatticePoint place);

}  // namespace trochoid
