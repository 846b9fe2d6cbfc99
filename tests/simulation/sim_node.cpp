#include "tests/simulation/sim_node.hpp"

#include <spdlog/spdlog.h>

#include <utility>

#include "protocol/model/sea.hpp"
#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"
#include "server/app/opening.hpp"
#include "server/app/replay.hpp"
#include "server/app/sea_authority.hpp"
#include "server/app/sea_service.hpp"
#include "server/interest/cull.hpp"
#include "server/interest/cull_key.hpp"
#include "server/net/monotonic.hpp"
#include "server/net/session_server.hpp"
#include "tests/simulation/virtual_time.hpp"

namespace trochoid {

namespace {

constexpr int64_t world_began_us = 900'000'000;
constexpr std::chrono::milliseconds follow_interval{50};

class VirtualTransport final : public Transport {
public:
    explicit VirtualTransport(std::unique_ptr<VirtualEnd> end) : end_(std::move(end)) {}
    const std::string& peer() const override { return peer_; }
    void when_readable(std::function<void()> ready) override { end_->when_readable(std::move(ready)); }
    void when_writable(std::function<void()> ready) override { end_->when_writable(std::move(ready)); }
    Moved read(std::span<uint8_t> into) override {
        const auto moved = end_->read(into);
        return {moved.bytes, moved.closed};
    }
    Moved write(std::span<const uint8_t> bytes) override {
        const auto moved = end_->write(bytes);
        return {moved.bytes, moved.closed};
    }
    void finish(ErrorCode) override { end_->finish(); }
    void close() override { end_->close(); }

private:
    std::unique_ptr<VirtualEnd> end_;
    std::string peer_ = "127.0.0.1:40000";
};

SeaClock the_clock() {
    SeaClock clock;
    clock.monotonic_start_us = world_began_us;
    return clock;
}

Scene the_scene() {
    Scene scene;
    scene.name = "simulated";
    StartWind wind;
    wind.speed = 9.0F;
    wind.towards_degrees = 90.0F;
    wind.origin = {to_lattice(-20000), 0};
    wind.fetch = to_lattice(60000);
    wind.width = to_lattice(40000);
    wind.trains = 4;
    wind.seed = 5;
    scene.winds.push_back({"old wind", wind, {-7200 * microseconds_per_second}, {}});
    return scene;
}

TicketKey the_ticket_key() {
    return *TicketKey::from_hex("000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f");
}

WorldInstance the_instance() {
    WorldInstance instance;
    instance.bytes[0] = 42;
    return instance;
}

UnixSeconds virtual_unix() {
    return UnixSeconds{1'700'000'000 + static_cast<uint64_t>(monotonic_us() / 1'000'000)};
}

}  // namespace

void keep_quiet() { spdlog::set_level(spdlog::level::off); }

SimWorld::SimWorld() : log_(std::make_unique<InMemoryEventLog>()) {
    // The scene's own events, by somebody who is no node.
    IoLoop loop;
    const Scene scene = the_scene();
    World world(scene.name, nullptr, the_clock());
    LandWorker worker(loop, nullptr, land_settings_of(scene.land));
    SeaAuthority(loop, world, *log_, worker, 500).open(scene);
}

SimWorld::~SimWorld() = default;

uint64_t SimWorld::events() const { return log_->read({0}, SIZE_MAX).size(); }

struct SimNode::Impl {
    Impl(VirtualNet& n, uint16_t p, SimWorld& shared, uint32_t number)
        : net(n),
          port(p),
          settings(land_settings_of(the_scene().land)),
          world(the_scene().name, nullptr, the_clock()),
          worker(loop, nullptr, settings),
          door(TokenKeys(), the_ticket_key(), ViewerTokens::never, virtual_unix),
          authority(loop, replayed(shared), shared.log(), worker, 500, number),
          sea(authority, the_instance(), door),
          sessions(loop, sea, Limits{}),
          following(loop) {}

    World& replayed(SimWorld& shared) {
        const auto events = shared.log().read({0}, SIZE_MAX);
        const auto done = replay(world, events, settings);
        TROCHOID_ASSERT(done.has_value(), "the log does not replay: {}", done.error().message);
        return world;
    }
    void follow() {
        authority.follow();
        following.start(follow_interval, [this] { follow(); });
    }

    VirtualNet& net;
    uint16_t port;
    LandSettings settings;
    IoLoop loop;
    World world;
    LandWorker worker;
    TokenDoor door;
    SeaAuthority authority;
    SeaService sea;
    SessionServer sessions;
    LoopTimer following;
};

SimNode::SimNode(VirtualNet& net, uint16_t port, SimWorld& world, uint32_t number)
    : impl_(std::make_unique<Impl>(net, port, world, number)) {
    Impl& my = *impl_;
    my.authority.on_change([&my] { my.sessions.sea_changed(); });
    my.follow();
    net.listen(port, [&my](std::unique_ptr<VirtualEnd> end) {
        my.sessions.accept(std::make_unique<VirtualTransport>(std::move(end)));
    });
}

SimNode::~SimNode() { impl_->net.deaf(impl_->port); }

bool SimNode::change_sea(uint64_t dice) {
    Command command;
    command.sequence = 1;
    const auto& boxes = impl_->authority.state()->boxes;
    if (dice % 3 == 0 && boxes.size() > 1) {
        auto box = boxes.begin();
        std::advance(box, static_cast<std::ptrdiff_t>((dice >> 8) % boxes.size()));
        command.action = StopWind{box->first};
    } else {
        StartWind wind;
        wind.speed = 6.0F + static_cast<float>((dice >> 8) % 8);
        wind.towards_degrees = static_cast<float>((dice >> 16) % 360);
        wind.origin = {to_lattice(static_cast<double>((dice >> 24) % 2000) - 1000.0),
                       to_lattice(static_cast<double>((dice >> 40) % 2000) - 1000.0)};
        wind.fetch = to_lattice(20000);
        wind.width = to_lattice(20000);
        wind.trains = 3;
        wind.seed = 1 + (dice >> 32);
        command.action = wind;
    }
    bool done = false;
    impl_->authority.command(command,
                             [&done](const CommandReply& reply) { done = reply.code == ErrorCode::none; });
    return done;
}

void SimNode::drain() {
    impl_->net.deaf(impl_->port);
    impl_->sessions.drain([] {});
}

uint64_t SimNode::state_of(const CullKey& key) const {
    const auto index = impl_->authority.index();
    if (index->log_position() != key.log_position) return 0;
    return hash_of(cull(*index, key).state);
}

bool SimNode::serves(const CullKey& key, const ViewState& view) const {
    const SeaTime at = now();
    return within_anchor(key, view, 1.0) && key.from <= at && at <= key.until &&
           key.log_position == impl_->authority.state()->log_position;
}

std::vector<SurfaceSample> SimNode::samples(SeaTime time, std::span<const LatticePoint> points) const {
    const SeaInstant instant(impl_->authority.state()->sea, time);
    std::vector<SurfaceSample> found;
    for (const LatticePoint& point : points) found.push_back(instant.evaluate(point));
    return found;
}

SeaTime SimNode::now() const { return impl_->authority.now(); }

SimCounts SimNode::counts() const {
    const ServerStats& stats = impl_->sessions.stats();
    SimCounts counts{stats.connections, stats.sessions_started, stats.sessions_now, 0, 0, stats.resyncs, {}};
    for (const auto& [verdict, count] : stats.resumes) counts.resumes[std::string(name_of(verdict))] = count;
    for (const auto& [code, count] : stats.ended) {
        counts.ended += count;
        if (code == ErrorCode::none) counts.ended_without_code += count;
    }
    return counts;
}

}  // namespace trochoid
