#pragma once
#include <filesystem>
#include <memory>

#include "server/world/world_state.hpp"

namespace trochoid {

/// A scene as a server holds it when its doors open, and the sea time at which they do.
struct FoldedScene {
    std::shared_ptr<const WorldState> state;
    SeaTime opens;
};

/// Reads, plans, traces and folds a scene, everything derived on this machine; land on `threads` threads (at least 1). Throws
/// OperatorError for a scene that cannot be.
FoldedScene fold_scene(const std::filesystem::path& file, uint32_t threads);

}  // namespace trochoid
