#include "tests/simulation/sim_client.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "client/app/session_link.hpp"
#include "client/net/client_stream.hpp"
#include "tests/simulation/virtual_time.hpp"

namespace trochoid {

namespace {

// Streams are dialled by endpoint alone: this is where they lead.
VirtualNet* the_net = nullptr;

/// A ClientStream over a simulated connection.
class SimStream final : public ClientStream, public std::enable_shared_from_this<SimStream> {
public:
    explicit SimStream(uint16_t port) : port_(port) {}

    void dial(Dialled done) override {
        the_net->connect(port_, [weak = weak_from_this(),
                                 done = std::move(done)](std::unique_ptr<VirtualEnd> end) {
            const auto self = weak.lock();
            if (!self || self->closed_) return;
            self->end_ = std::move(end);
            done(self->end_ ? Result<Done>(Done{}) : Result<Done>(Error{ErrorCode::none, "nothing listens"}));
        });
    }
    const char* awaits() const override { return "nothing answered"; }
    void read(Arrived done) override {
        end_->when_readable([weak = weak_from_this(), done = std::move(done)] {
            const auto self = weak.lock();
            if (!self || self->closed_) return;
            const auto moved = self->end_->read(self->chunk_);
            if (moved.closed) return done(Error{ErrorCode::none, "the connection is gone"});
            if (moved.bytes == 0) return self->read(done);
            done(std::span<const uint8_t>(self->chunk_).first(moved.bytes));
        });
    }
    void write(std::span<const uint8_t> bytes, Written done) override {
        go_on(bytes, bytes.size(), std::move(done));
    }
    void shut() override {
        if (end_) end_->finish();
    }
    void close() override {
        closed_ = true;
        if (end_) end_->close();
    }

private:
    void go_on(std::span<const uint8_t> rest, size_t size, Written done) {
        end_->when_writable([weak = weak_from_this(), rest, size, done = std::move(done)] {
            const auto self = weak.lock();
            if (!self || self->closed_) return;
            const auto moved = self->end_->write(rest);
            const auto left = rest.subspan(moved.bytes);
            if (moved.closed || left.empty()) return done(size - left.size());
            self->go_on(left, size, done);
        });
    }

    uint16_t port_;
    std::unique_ptr<VirtualEnd> end_;
    std::array<uint8_t, 16384> chunk_{};
    bool closed_ = false;
};

}  // namespace

std::shared_ptr<ClientStream> stream_to(NetLoop&, const Endpoint& endpoint) {
    return std::make_shared<SimStream>(endpoint.port);
}

struct SimClient::Impl {
    Impl(VirtualNet& net, uint16_t port, const ViewState& view, std::vector<SyncRegion> regions) {
        the_net = &net;
        options.server = {"sim", port};
        options.software = "simulated";
        board.view = options.view = view;
        board.regions = options.regions = std::move(regions);
        loop.post([this] { link.connect(); });
        watch();
    }
    void watch() {
        loop.after(std::chrono::milliseconds(50), [this] {
            look_at_board();
            watch();
        });
    }
    // Sessions that were resumed can be told by their hello alone.
    void look_at_board() {
        if (board.hello && board.hello->session != seen) {
            seen = board.hello->session;
            resumed += board.hello->resumed ? 1U : 0U;
        }
        const bool live = board.state == LinkState::live;
        if (was_live && !live) ends.push_back(board.reason);
        was_live = live;
        const StoreSnapshot& now = *board.snapshot;
        if (now.log_position >= held->log_position)
            watermark_fell_us = std::max(watermark_fell_us, held->watermark - now.watermark);
        held = board.snapshot;
    }
    SessionOptions options;
    mutable SessionBoard board;
    NetLoop loop;
    SessionLink link{loop, board, options};
    std::shared_ptr<const StoreSnapshot> held = board.snapshot;
    std::vector<std::string> ends;
    bool was_live = false;
    int64_t watermark_fell_us = 0;
    uint64_t seen = 0;
    uint32_t resumed = 0;
};

SimClient::SimClient(VirtualNet& net, uint16_t port, const ViewState& view, std::vector<SyncRegion> regions)
    : impl_(std::make_unique<Impl>(net, port, view, std::move(regions))) {}
SimClient::~SimClient() { impl_->loop.stop(); }

void SimClient::look(const ViewState& view) {
    impl_->board.view = view;
    impl_->loop.post([my = impl_.get()] { my->link.view_changed(); });
}
void SimClient::ask_regions(std::vector<SyncRegion> regions) {
    impl_->board.regions = std::move(regions);
    impl_->loop.post([my = impl_.get()] { my->link.regions_changed(); });
}
bool SimClient::rot() {
    auto& boxes = const_cast<InterestState&>(*impl_->board.snapshot->interest).boxes;
    const auto box =
        std::find_if(boxes.begin(), boxes.end(), [](const auto& b) { return !b.second->trains.empty(); });
    if (box == boxes.end()) return false;
    WaveTrainBox other = *box->second;
    other.trains.front().phase ^= 1U << 29;
    box->second = std::make_shared<const WaveTrainBox>(std::move(other));
    return true;
}
void SimClient::leave() {
    impl_->loop.post([my = impl_.get()] { my->link.end(); });
}

bool SimClient::live() const { return impl_->board.state == LinkState::live; }
bool SimClient::ended() const { return impl_->board.state == LinkState::ended; }
std::string SimClient::sentence() const {
    return sentence_of(impl_->board, impl_->options.server, client_monotonic_us());
}
uint32_t SimClient::connections() const { return impl_->board.connections; }
uint32_t SimClient::resumed() const { return impl_->resumed; }
uint64_t SimClient::results() const { return impl_->board.counters.results; }
const StoreCounters& SimClient::counters() const { return impl_->board.counters; }
const std::vector<std::string>& SimClient::ends() const { return impl_->ends; }
LogPosition SimClient::position() const { return impl_->board.snapshot->log_position; }
SeaTime SimClient::watermark() const { return impl_->board.snapshot->watermark; }
int64_t SimClient::watermark_fell_us() const { return impl_->watermark_fell_us; }
const CullKey& SimClient::key() const { return impl_->board.snapshot->key; }
uint64_t SimClient::state() const {
    return impl_->board.snapshot->result == 0 ? 0 : hash_of(*impl_->board.snapshot->interest);
}
std::string SimClient::holdings() const {
    const InterestState& held = *impl_->board.snapshot->interest;
    const StoreCounters& counted = counters();
    return fmt::format(
        "{} boxes, {} land blocks, {} patches; {} results in {} pieces, {} resyncs, {} desyncs",
        held.boxes.size(), held.blocks.size(), held.patches.size(), counted.results, counted.pieces,
        counted.resyncs, counted.desyncs);
}
const std::vector<SyncRegion>& SimClient::regions() const { return impl_->board.snapshot->regions; }

std::vector<SurfaceSample> SimClient::samples(SeaTime time, std::span<const LatticePoint> points) const {
    const SeaInstant instant(impl_->board.snapshot->sea, time);
    std::vector<SurfaceSample> found;
    for (const LatticePoint& point : points) found.push_back(instant.evaluate(point));
    return found;
}

int64_t SimClient::clock_error_us(SeaTime truth) const {
    return std::abs(impl_->board.clock.sea_time(client_monotonic_us()) - truth);
}
int64_t SimClient::clock_bound_us() const { return impl_->board.clock.error_bound_us(client_monotonic_us()); }

}  // namespace trochoid
