#include "tests/determinism/folded_scene.hpp"

#include "protocol/units/assert.hpp"
#include "server/app/replay.hpp"
#include "tests/determinism/fault.hpp"
#include "tests/determinism/live_script.hpp"

namespace trochoid {

FoldedScene fold_scene(const std::filesystem::path& file, uint32_t threads, bool coarse_land) {
    Scene scene = load_scene(file);
    if (coarse_land) ++scene.land.node_step_log2;
    StillServer server(scene, threads);
    FoldedScene folded{server.state(), scene.clock_start, {}, nullptr, 0};
    if (fault_in("world") || fault_in("land")) {
        const auto spoilt = server.follower();
        replay_spoiled(*spoilt, server.events(), server.land());
        folded.state = spoilt->state();
    }
    const auto script = live_script(scene.name, scene.clock_start);
    if (script.empty()) return folded;
    folded.live = server.play(script);
    folded.lived = server.state();
    const auto follower = server.follower();
    const auto followed = replay(*follower, server.events(), server.land());
    TROCHOID_ASSERT(followed.has_value(), "the log that was just written: {}", followed.error().message);
    folded.followed = hash_of(*follower->state());
    return folded;
}

}  // namespace trochoid
