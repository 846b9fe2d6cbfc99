#include "tests/determinism/still_server.hpp"

#include <limits>
#include <utility>

#include "server/app/opening.hpp"

namespace trochoid {
namespace {

LandSettings settings_of(const Scene& scene, uint32_t threads) {
    LandSettings settings = land_settings_of(scene.land);
    settings.threads = threads;
    return settings;
}

void aim(Command& command, BoxId box) {
    if (auto* steer = std::get_if<Steer>(&command.action)) steer->box = box;
    if (auto* stop = std::get_if<StopWind>(&command.action)) stop->box = box;
}

}  // namespace

StillServer::StillServer(const Scene& scene, uint32_t threads)
    : name_(scene.name),
      terrain_(load_terrain(scene.terrain)),
      clock_{1, scene.clock_start, 0, 0},
      land_(settings_of(scene, threads)),
      world_(name_, terrain_, clock_),
      worker_(loop_, terrain_, land_),
      authority_(loop_, world_, log_, worker_, 0) {
    authority_.open(scene);
}

std::vector<LiveStep> StillServer::play(std::span<const LiveCommand> script) {
    std::vector<LiveStep> steps;
    loop_.post([&] { next(script, steps); });
    loop_.run();
    return steps;
}

void StillServer::next(std::span<const LiveCommand> script, std::vector<LiveStep>& steps) {
    if (steps.size() == script.size()) return loop_.stop();
    const LiveCommand& live = script[steps.size()];
    Command command = live.command;
    command.sequence = static_cast<uint32_t>(steps.size() + 1);
    if (live.box_of >= 0) {
        BoxId box = steps[static_cast<size_t>(live.box_of)].reply.box;
        // Whoever asks knows which box took its place when the land changed; ids ascend.
        for (const auto& [id, other] : authority_.state()->boxes)
            if (other->predecessor == box) box = id;
        aim(command, box);
    }
    authority_.command(command, [this, script, &steps](CommandReply reply) {
        const auto after = authority_.state();
        steps.push_back({std::move(reply), after->log_position, after->log_hash, hash_of(*after)});
        loop_.post([this, script, &steps] { next(script, steps); });
    });
}

std::vector<StoredEvent> StillServer::events() const {
    return log_.read({0}, std::numeric_limits<size_t>::max());
}

std::unique_ptr<World> StillServer::follower() const {
    return std::make_unique<World>(name_, terrain_, clock_);
}

}  // namespace trochoid
