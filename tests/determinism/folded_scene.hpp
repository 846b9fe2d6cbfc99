#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "tests/determinism/still_server.hpp"

namespace trochoid {

/// A scene as a server holds it when its doors open, and what became of it by the commands of live_script.
struct FoldedScene {
    std::shared_ptr<const WorldState> state;
    SeaTime opens;
    std::vector<LiveStep> live;               ///< empty for a scene without commands
    std::shared_ptr<const WorldState> lived;  ///< after the last command; null without commands
    /// hash_of the world that a second server has, which heard of nothing but the log's bytes; 0 without commands.
    uint64_t followed = 0;
};

/// Reads, plans, traces and folds a scene through the server's authority (server/app), everything derived on this machine; land on
/// `threads` threads (at least 1), coarse: its fields' nodes twice as far apart as the scene says. Throws OperatorError for a scene that cannot be.
FoldedScene fold_scene(const std::filesystem::path& file, uint32_t threads, bool coarse_land = false);

}  // namespace trochoid
