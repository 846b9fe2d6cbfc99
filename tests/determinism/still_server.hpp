#pragma once
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "server/app/sea_authority.hpp"
#include "server/event/event_log.hpp"
#include "server/event/scene.hpp"
#include "server/land/land_settings.hpp"

namespace trochoid {

/// A director's command, with the earlier one whose box it is about.
struct LiveCommand {
    Command command;
    int box_of =
        -1;  ///< Steer and StopWind: the box in the reply to this command of the script; below 0: as the command says
};

/// What the authority made of a command, and the world after it: of its state no more than that, for each holds all land of its time.
struct LiveStep {
    CommandReply reply;
    LogPosition log_position;
    uint64_t log_hash = 0;
    uint64_t world_hash = 0;  ///< hash_of
};

/// The server's own world, log, land worker and authority over a scene, without sessions. Its sea time stands still at the scene's start,
/// so that commands take hold exactly when they ask to, on a slow machine too.
class StillServer {
public:
    /// Opens the scene, land on `threads` threads. Throws OperatorError for a scene that cannot be.
    StillServer(const Scene& scene, uint32_t threads);

    std::shared_ptr<const WorldState> state() const { return authority_.state(); }
    /// Hands over the commands one by one, each after the reply to the one before. Once.
    std::vector<LiveStep> play(std::span<const LiveCommand> script);
    /// All events so far.
    std::vector<StoredEvent> events() const;
    /// The world at log position 0, for a follower of the log, and the settings it traces with.
    std::unique_ptr<World> follower() const;
    const LandSettings& land() const { return land_; }

private:
    void next(std::span<const LiveCommand> script, std::vector<LiveStep>& steps);

    std::string name_;
    std::shared_ptr<const TerrainGrid> terrain_;
    SeaClock clock_;
    LandSettings land_;
    World world_;
    IoLoop loop_;
    InMemoryEventLog log_;
    LandWorker worker_;
    SeaAuthority authority_;
};

}  // namespace trochoid
