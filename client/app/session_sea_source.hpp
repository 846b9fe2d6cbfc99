#pragma once
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include "client/app/ocean_session.hpp"
#include "client/scene/sea_source.hpp"

namespace trochoid {

/// The viewer's sea from a session with a server.
class SessionSeaSource : public SeaSource {
public:
    explicit SessionSeaSource(SessionOptions options);

    SceneInput snapshot() override;
    void set_view(const ViewState& view) override;
    SeaTime sea_time_now() override;
    /// A box whose rays are known or under way is not asked for again until its record changes.
    void request_rays(BoxId box) override;

    OceanSession& session() { return session_; }

private:
    /// Filled on the network thread.
    struct Rays {
        struct OfBox {
            std::vector<WaveRay> rays;
            std::shared_ptr<const WaveTrainBox> record;  ///< that they were traced for, as known when asked
        };
        std::mutex mutex;
        std::map<BoxId, OfBox> boxes;
    };

    std::shared_ptr<Rays> rays_ = std::make_shared<Rays>();
    std::shared_ptr<const TerrainTileMap> tiles_of_;
    std::vector<std::shared_ptr<const TerrainTile>> tiles_;
    OceanSession session_;
};

}  // namespace trochoid
