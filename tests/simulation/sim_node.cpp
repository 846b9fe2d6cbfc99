#include "tests/simulation/sim_node.hpp"

#include <spdlog/spdlog.h>

#include <utility>

#include "protocol/model/sea.hpp"
#include "protocol/units/assert.hpp"
#include "server/app/replay.hpp"
#include "server/app/sea_authority.hpp"
#include "server/app/sea_service.hpp"
#include "server/interest/cull.hpp"
#include "server/interest/cull_key.hpp"
#include "server/net/monotonic.hpp"
#include "server/net/session_server.hpp"
#include "tests/simulation/sim_world.hpp"
#include "tests/simulation/virtual_time.hpp"

namespace trochoid {

namespace {

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

struct SimNode::Impl {
    Impl(VirtualNet& n, uint16_t p, SimWorld& w, const NodeKind& k)
        : net(n),
          port(p),
          shared(w),
          kind(k),
          world(w.scene().name, w.terrain(), clock_of_the_beginning()),
          worker(loop, w.terrain(), w.land_settings()),
          door(TokenKeys(), the_ticket_key(), ViewerTokens::never, virtual_unix),
          authority(loop, replayed(), w.log(), worker, 500, k.number),
          sea(authority, the_instance(), door),
          sessions(loop, sea, k.limits),
          following(loop) {}

    World& replayed() {
        const auto events = shared.log().read({0}, SIZE_MAX);
        const auto done = replay(world, events, shared.land_settings());
        TROCHOID_ASSERT(done.has_value(), "the log does not replay: {}", done.error().message);
        return world;
    }
    void follow() {
        authority.follow();
        promise();
        following.start(kind.look_every, [this] { follow(); });
    }
    void promise() { shared.promised(authority.state()->log_position, authority.watermark()); }

    // The worker's thread is waited for, so that what it takes is virtual time.
    void await_worker(int64_t takes_us) {
        if (awaiting || unanswered == 0) return;
        awaiting = true;
        VirtualTime& time = VirtualTime::current();
        time.at(time.now_us() + takes_us,
                [this, takes_us, still = std::weak_ptr<int>(alive), traced = time.handed_in()] {
                    if (still.expired()) return;
                    awaiting = false;
                    traced();
                    await_worker(takes_us);
                });
    }

    VirtualNet& net;
    uint16_t port;
    SimWorld& shared;
    NodeKind kind;
    IoLoop loop;
    World world;
    LandWorker worker;
    TokenDoor door;
    SeaAuthority authority;
    SeaService sea;
    SessionServer sessions;
    LoopTimer following;
    size_t unanswered = 0;  // commands
    bool awaiting = false;
    std::shared_ptr<int> alive = std::make_shared<int>();
};

SimNode::SimNode(VirtualNet& net, uint16_t port, SimWorld& world, const NodeKind& kind)
    : impl_(std::make_unique<Impl>(net, port, world, kind)) {
    Impl& my = *impl_;
    my.authority.on_change([&my] {
        my.promise();
        my.sessions.sea_changed();
    });
    my.follow();
    net.listen(port, [&my](std::unique_ptr<VirtualEnd> end) {
        my.sessions.accept(std::make_unique<VirtualTransport>(std::move(end)));
    });
}

SimNode::~SimNode() { impl_->net.deaf(impl_->port); }

void SimNode::command(decltype(Command::action) action, int64_t tracing_us) {
    Command command;
    command.sequence = 1;
    command.action = std::move(action);
    ++impl_->unanswered;
    impl_->authority.command(command, [my = impl_.get()](const CommandReply&) { --my->unanswered; });
    impl_->await_worker(tracing_us);
}

std::vector<BoxId> SimNode::boxes() const {
    std::vector<BoxId> ids;
    for (const auto& [id, box] : impl_->authority.state()->boxes) ids.push_back(id);
    return ids;
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
uint32_t SimNode::rate_q16() const { return impl_->authority.state()->clock.rate_q16; }
uint64_t SimNode::world_hash() const { return hash_of(*impl_->authority.state()); }

bool SimNode::resumes(const CullKey& key, uint64_t state_hash) const {
    ResumeState claim;
    claim.instance = the_instance();
    claim.key = key;
    claim.state_hash = state_hash;
    claim.log_position = impl_->authority.state()->log_position;
    claim.log_hash = impl_->authority.state()->log_hash;
    return impl_->sea.resume(claim).verdict == ResumeVerdict::resumed;
}

SimCounts SimNode::counts() const {
    const ServerStats& stats = impl_->sessions.stats();
    SimCounts counts{
        stats.connections, stats.sessions_started, stats.sessions_now, 0, 0, stats.resyncs, 0, {}};
    for (const auto& [kind, count] : stats.desyncs) counts.desyncs += count;
    for (const auto& [verdict, count] : stats.resumes) counts.resumes[std::string(name_of(verdict))] = count;
    for (const auto& [code, count] : stats.ended) {
        counts.ended += count;
        if (code == ErrorCode::none) counts.ended_without_code += count;
    }
    return counts;
}

}  // namespace trochoid
