#include "client/app/session_sea_source.hpp"

#include <utility>

namespace trochoid {

namespace {

TerrainExtent extent_of(const TerrainInfo& info) {
    return {info.origin_x, info.origin_z, info.spacing_log2, info.columns, info.rows, info.open_sea_depth};
}

SourceStatistics source_statistics(const SessionStatistics& s) {
    SourceStatistics out;
    out.connected = s.state == LinkState::live;
    out.state = s.sentence;
    out.server_version = s.server_version;
    out.bytes_received = s.bytes_received;
    out.bytes_per_second = s.bytes_per_second;
    out.clock_error_ms = static_cast<double>(s.clock_error_us) * 1e-3;
    out.fidelity = s.fidelity;
    out.deltas = static_cast<uint32_t>(s.store.results);
    out.resyncs = static_cast<uint32_t>(s.store.resyncs);
    out.desyncs = static_cast<uint32_t>(s.store.desyncs);
    out.log_position = s.log_position;
    out.error_in_force_px = s.error_in_force_px;
    return out;
}

std::shared_ptr<const WaveTrainBox> record_of(const StoreSnapshot& known, BoxId box) {
    const auto found = known.interest->boxes.find(box);
    return found == known.interest->boxes.end() ? nullptr : found->second;
}

}  // namespace

SessionSeaSource::SessionSeaSource(SessionOptions options) : session_(std::move(options)) {}

SceneInput SessionSeaSource::snapshot() {
    const std::shared_ptr<const StoreSnapshot> known = session_.snapshot();
    SceneInput input;
    // Results of an earlier session stay in the picture until the next one brings new ones.
    if (known->key != CullKey{}) {
        input.state = known->interest;
        input.sea = known->sea;
    }
    input.now = session_.sea_time_now();
    input.terrain = extent_of(known->terrain);
    if (known->tiles != tiles_of_) {
        tiles_of_ = known->tiles;
        tiles_.clear();
        for (const auto& [key, tile] : *tiles_of_) tiles_.push_back(tile);
    }
    input.tiles = tiles_;
    {
        const std::lock_guard lock(rays_->mutex);
        std::erase_if(rays_->boxes,
                      [&](const auto& entry) { return record_of(*known, entry.first) == nullptr; });
        for (const auto& [box, of_box] : rays_->boxes)
            input.rays.insert(input.rays.end(), of_box.rays.begin(), of_box.rays.end());
    }
    input.statistics = source_statistics(session_.statistics());
    input.statistics.known_until = input.now;
    return input;
}

void SessionSeaSource::set_view(const ViewState& view) { session_.set_view(view); }

SeaTime SessionSeaSource::sea_time_now() { return session_.sea_time_now(); }

void SessionSeaSource::request_rays(BoxId box) {
    const auto record = record_of(*session_.snapshot(), box);
    {
        const std::lock_guard lock(rays_->mutex);
        Rays::OfBox& of_box = rays_->boxes[box];
        if (record != nullptr && of_box.record == record) return;
        of_box.record = record;
    }
    session_.rays(box, [rays = rays_, box, record](const Result<RaysReply>& reply) {
        const std::lock_guard lock(rays->mutex);
        const auto waiting = rays->boxes.find(box);
        if (waiting == rays->boxes.end() || waiting->second.record != record) return;
        if (reply) {
            waiting->second.rays = reply->rays;
        } else {
            // Asked again when the viewer wants them again.
            waiting->second.record = nullptr;
        }
    });
}

}  // namespace trochoid
