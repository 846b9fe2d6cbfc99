#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "protocol/model/sea_clock.hpp"
#include "protocol/model/terrain.hpp"
#include "server/event/event_log.hpp"
#include "server/event/scene.hpp"
#include "server/land/land_settings.hpp"

namespace trochoid {

/// Before anybody has changed it.
SeaClock clock_of_the_beginning();

/// What all nodes of a simulated world have in common: its log, its name, its land; and what has been promised in it.
class SimWorld {
public:
    /// `land`: with an island of half a kilometre, else the open sea.
    explicit SimWorld(bool land = false);
    SimWorld(const SimWorld&) = delete;
    SimWorld& operator=(const SimWorld&) = delete;

    InMemoryEventLog& log() { return log_; }
    const Scene& scene() const { return scene_; }
    const std::shared_ptr<const TerrainGrid>& terrain() const { return terrain_; }
    const LandSettings& land_settings() const { return settings_; }
    uint64_t events() const { return log_.read({0}, SIZE_MAX).size(); }

    /// Somebody says that all events from this position on take effect at the watermark or later.
    void promised(LogPosition position, SeaTime watermark);
    /// What breaks a promise; empty: nothing. A change of the clock takes hold at once and is promised by nobody.
    std::string broken_promise() const;

private:
    Scene scene_;
    std::shared_ptr<const TerrainGrid> terrain_;
    LandSettings settings_;
    InMemoryEventLog log_;
    std::vector<SeaTime> promises_;  // the latest for each position
};

}  // namespace trochoid
