#include "client/store/client_store.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace trochoid {

namespace {

Error out_of_range(std::string sentence) { return {ErrorCode::value_out_of_range, std::move(sentence)}; }
/// More than this client holds; the server has broken nothing.
Error too_much(std::string sentence) { return {ErrorCode::too_much_land, std::move(sentence)}; }

/// Where the blocks of a field lie: its window of look-up slots.
struct Outline {
    uint8_t step_log2 = 0;
    BlockKey first;
    BlockKey last;

    double slots() const {
        return (static_cast<double>(last.x) - first.x + 1.0) * (static_cast<double>(last.z) - first.z + 1.0);
    }
};

/// Of every field. An error where the blocks of a field differ in their lattice step, or where the fields' windows take more than
/// `most_slots` together.
Result<std::map<FieldId, Outline>> outlines_of(const InterestState& state, size_t most_slots) {
    std::map<FieldId, Outline> outlines;
    for (const auto& [key, value] : state.blocks) {
        const auto [place, fresh] =
            outlines.try_emplace(key.field, Outline{value.step_log2, key.block, key.block});
        Outline& o = place->second;
        if (o.step_log2 != value.step_log2)
            return out_of_range(fmt::format("land field {} has two lattice steps", key.field.value));
        o.first = {std::min(o.first.x, key.block.x), std::min(o.first.z, key.block.z)};
        o.last = {std::max(o.last.x, key.block.x), std::max(o.last.z, key.block.z)};
    }
    double slots = 0.0;
    for (const auto& [id, outline] : outlines) slots += outline.slots();
    if (slots > static_cast<double>(most_slots))
        return too_much(fmt::format(
            "{} land fields spread over {:.0f} look-up slots, and this client holds {} at most: ask for fewer or smaller sync "
            "regions, or look at less of the coast",
            outlines.size(), slots, most_slots));
    return outlines;
}

/// Land fields of an interest state; fields that were not touched keep their object. Nothing is made before all is known to fit:
/// an error where outlines_of says so, or where the blocks of one field lie too far apart to be looked up.
Result<std::map<FieldId, std::shared_ptr<const LandField>>> fields_of(
    const InterestState& state, const std::set<FieldId>& touched,
    const std::map<FieldId, std::shared_ptr<const LandField>>& old, size_t most_slots) {
    const auto outlines = outlines_of(state, most_slots);
    if (!outlines) return outlines.error();
    std::map<FieldId, std::shared_ptr<LandField>> fresh;
    std::map<FieldId, std::shared_ptr<const LandField>> all;
    for (const auto& [id, outline] : *outlines) {
        const auto kept = old.find(id);
        if (kept != old.end() && !touched.contains(id)) {
            all.emplace(id, kept->second);
            continue;
        }
        auto field = std::make_shared<LandField>(id, outline.step_log2);
        field->make_room(outline.first, outline.first);
        if (!field->fits(outline.last))
            return too_much(
                fmt::format("land field {} spreads its blocks farther than this client can look up: ask for "
                            "sync regions that lie closer together",
                            id.value));
        field->make_room(outline.first, outline.last);
        fresh.emplace(id, std::move(field));
    }
    for (const auto& [key, value] : state.blocks)
        if (const auto field = fresh.find(key.field); field != fresh.end()) field->second->set(value.block);
    for (auto& [id, field] : fresh) all[id] = std::move(field);
    return all;
}

/// An error where a field and the one that it lies over have two lattice steps: their blocks do not cover each other.
Result<Done> overlays_fit(const WaveTrainBox& box,
                          const std::map<FieldId, std::shared_ptr<const LandField>>& fields) {
    for (const FieldOverlay& overlay : box.overlays) {
        const auto field = fields.find(overlay.field);
        const auto base = fields.find(overlay.base);
        if (field != fields.end() && base != fields.end() &&
            field->second->step_log2() != base->second->step_log2())
            return out_of_range(
                fmt::format("land fields {} and {}, one over the other, have two lattice steps",
                            overlay.field.value, overlay.base.value));
    }
    return Done{};
}

/// Whether the box reads one of the fields, through its overlays too.
bool reads_any_of(const WaveTrainBox& box, const std::set<FieldId>& fields) {
    return std::any_of(box.trains.begin(), box.trains.end(),
                       [&](const WaveTrain& train) { return fields.contains(train.field); }) ||
           std::any_of(box.overlays.begin(), box.overlays.end(),
                       [&](const FieldOverlay& overlay) { return fields.contains(overlay.base); });
}

/// The first sea time at which two records of a box may differ, as events change them; end_of_time where none does.
SeaTime differ_from(const WaveTrainBox& a, const WaveTrainBox& b) {
    SeaTime first = end_of_time;
    if (a.end != b.end) first = std::min(a.end, b.end);
    const auto [at, bt] = std::mismatch(a.course.begin(), a.course.end(), b.course.begin(), b.course.end());
    if (at != a.course.end()) first = std::min(first, at->from);
    if (bt != b.course.end()) first = std::min(first, bt->from);
    return first;
}

/// The grid that a hello's terrain names, without its heights: what tile keys are checked against.
TerrainGrid outline_of(const TerrainInfo& info) {
    TerrainGrid grid;
    grid.origin_x = info.origin_x;
    grid.origin_z = info.origin_z;
    grid.spacing_log2 = info.spacing_log2;
    grid.columns = info.columns;
    grid.rows = info.rows;
    grid.height_step_log2 = info.height_step_log2;
    return grid;
}

bool belongs_to(const TerrainTile& tile, const TerrainGrid& grid) {
    if (tile.key.level >= tile_levels(grid) || tile.key.x < 0 || tile.key.z < 0) return false;
    const int64_t cells = int64_t{terrain_tile_cells} << tile.key.level;
    return tile.key.x * cells < int64_t{grid.columns} - 1 && tile.key.z * cells < int64_t{grid.rows} - 1 &&
           tile.spacing_log2 == grid.spacing_log2 + tile.key.level &&
           tile.height_step_log2 == grid.height_step_log2 &&
           tile.origin_x == grid.origin_x + ((tile.key.x * cells) << grid.spacing_log2) &&
           tile.origin_z == grid.origin_z + ((tile.key.z * cells) << grid.spacing_log2);
}

}  // namespace

void ClientStore::begin(const ServerHello& hello) {
    const bool same_world = hello_ && hello_->instance == hello.instance;
    hello_ = hello;
    if (!same_world) whole_ = false;
    const bool resumed = hello.resumed && whole_;
    // Without resuming no delta can build on what an earlier session has left. A server that resumes what we do not hold is found out
    // by its next result.
    begun_ = hello.resumed ? 1 : 0;
    applied_ = resumed ? 1 : 0;
    base_ = 0;
    if (resumed) {
        ++counters_.resumed;
        // Of a result that was cut short nothing stays. Fields and boxes are still those of the last whole one, or none.
        state_ = *snapshot_->interest;
        state_hash_ = whole_hash_;
    }
    next_piece_ = 0;
    course_ = Course::apply;
    resync_asked_ = false;
    auto next = std::make_shared<StoreSnapshot>();
    if (same_world) *next = *snapshot_;
    next->result = applied_;
    next->terrain = hello.terrain;
    snapshot_ = std::move(next);
}

/// Results come by ascending number without gaps, each in pieces 0, 1, … on one base. Only a snapshot that follows our wish
/// for one may cut a result short.
Result<Done> ClientStore::take_turn(const Delta& piece) {
    const bool whole = next_piece_ == 0;
    const bool starts_anew =
        piece.piece == 0 && piece.result == begun_ + 1 && (whole || (resync_asked_ && piece.base == 0));
    const bool goes_on =
        !whole && piece.result == begun_ && piece.piece == next_piece_ && piece.base == base_;
    if (!starts_anew && !goes_on)
        return Error{
            ErrorCode::sequence_not_monotone,
            fmt::format("piece {} of result {} on {} came where {} was due", piece.piece, piece.result,
                        piece.base,
                        whole ? fmt::format("piece 0 of result {}", begun_ + 1)
                              : fmt::format("piece {} of result {} on {}", next_piece_, begun_, base_))};
    begun_ = piece.result;
    base_ = piece.base;
    next_piece_ = piece.last ? 0 : static_cast<uint16_t>(piece.piece + 1);
    return Done{};
}

/// Decides from its first piece what becomes of a result.
bool ClientStore::builds_on_ours(const Delta& first_piece) {
    touched_boxes_.clear();
    touched_fields_.clear();
    if (first_piece.base == 0) {
        state_ = {};
        fields_.clear();
        prepared_.clear();
        applied_ = 0;
        resync_asked_ = false;
        return true;
    }
    return !resync_asked_ && first_piece.base == applied_ && first_piece.base_hash == state_hash_;
}

std::optional<ResumeState> ClientStore::resume_state() const {
    if (!whole_) return std::nullopt;
    ResumeState claim;
    claim.instance = hello_->instance;
    claim.key = snapshot_->key;
    claim.state_hash = whole_hash_;
    return claim;
}

void ClientStore::distrust() {
    ++counters_.desyncs;
    whole_ = false;
    // The rest of a result that is coming builds on it.
    if (next_piece_ != 0) course_ = Course::pass_by;
    resync_asked_ = true;
    applied_ = 0;
}

std::optional<Ack> ClientStore::ask_resync(uint32_t result) {
    ++counters_.resyncs;
    resync_asked_ = true;
    applied_ = 0;
    return Ack{result, 0, 0, {}};
}

Result<std::optional<Ack>> ClientStore::apply(const Delta& delta) {
    if (!hello_) return Error{ErrorCode::unexpected_message, "a delta came before the server hello"};
    if (auto turn = take_turn(delta); !turn) return turn.error();
    ++counters_.pieces;
    if (delta.piece == 0)
        course_ =
            builds_on_ours(delta) ? Course::apply : (resync_asked_ ? Course::pass_by : Course::ask_resync);
    if (course_ != Course::apply) {
        ++counters_.passed_by;
        // A result is answered when it is whole: the server does not expect an ack before.
        if (delta.last && course_ == Course::ask_resync) return ask_resync(delta.result);
        return std::optional<Ack>{};
    }
    for (const auto& box : delta.change.boxes) touched_boxes_.insert(box->id);
    for (const FieldBlock& block : delta.change.blocks) touched_fields_.insert(block.field);
    for (const FieldBlockKey& block : delta.change.removed_blocks) touched_fields_.insert(block.field);
    trochoid::apply(state_, delta.change);
    if (auto ok = within_limits(delta.last); !ok) return ok.error();
    if (!delta.last) return std::optional<Ack>{};
    state_hash_ = hash_of(state_);
    if (state_hash_ != delta.state_hash) return ask_resync(delta.result);
    if (auto done = finish_result(delta); !done) return done.error();
    return std::optional<Ack>(Ack{delta.result, state_hash_, 0, {}});
}

/// Between its pieces a result may hold what goes beside what comes: twice as much.
Result<Done> ClientStore::within_limits(bool whole) const {
    const size_t times = whole ? 1 : 2;
    if (state_.boxes.size() > times * hello_->limits.boxes)
        return Error{ErrorCode::too_many_boxes,
                     fmt::format("{} boxes, more than the server's own limit of {}", state_.boxes.size(),
                                 hello_->limits.boxes)};
    if (state_.patches.size() > times * hello_->limits.patches)
        return out_of_range(fmt::format("{} patches, more than the server's own limit of {}",
                                        state_.patches.size(), hello_->limits.patches));
    if (state_.blocks.size() > times * limits_.land_blocks)
        return too_much(fmt::format(
            "{} land blocks, and this client holds {} at most: ask for fewer or smaller sync regions, or look at "
            "less of the coast",
            state_.blocks.size(), limits_.land_blocks));
    return Done{};
}

Result<Done> ClientStore::finish_result(const Delta& last_piece) {
    auto fields = fields_of(state_, touched_fields_, fields_, limits_.land_slots);
    if (!fields) return fields.error();
    for (const auto& [id, box] : state_.boxes)
        if (auto fit = overlays_fit(*box, *fields); !fit) return fit.error();
    applied_ = last_piece.result;
    whole_ = true;
    whole_hash_ = state_hash_;
    ++counters_.results;
    count_late_events(last_piece.key);

    auto next = std::make_shared<StoreSnapshot>(*snapshot_);
    prepared_ = prepare_boxes(*fields);
    fields_ = std::move(*fields);
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    boxes.reserve(prepared_.size());
    for (const auto& [id, box] : prepared_) boxes.push_back(box);
    next->result = applied_;
    if (hash_of(*next->interest) != state_hash_ || hulls_changed(*next->interest))
        next->interest = std::make_shared<InterestState>(state_);
    next->sea = Sea(std::move(boxes));
    next->regions = last_piece.key.regions;
    next->key = last_piece.key;
    // Another node of the world may be behind the one that we were at: what it has not read yet may take effect before that one's
    // watermark, and is not in this result.
    const bool went_back = last_piece.key.log_position < next->log_position;
    next->watermark = went_back ? last_piece.watermark : std::max(next->watermark, last_piece.watermark);
    next->log_position = last_piece.key.log_position;
    snapshot_ = std::move(next);
    return Done{};
}

/// The state's hash is that of the sea: hulls are not in it.
bool ClientStore::hulls_changed(const InterestState& before) const {
    return std::any_of(touched_boxes_.begin(), touched_boxes_.end(), [&](BoxId id) {
        const auto old = before.boxes.find(id);
        const auto now = state_.boxes.find(id);
        return old != before.boxes.end() && now != state_.boxes.end() &&
               old->second->hull != now->second->hull;
    });
}

/// Boxes whose record and fields were not touched keep their object.
ClientStore::PreparedBoxes ClientStore::prepare_boxes(const Fields& fields) const {
    std::vector<std::shared_ptr<const LandField>> all;
    all.reserve(fields.size());
    for (const auto& [id, field] : fields) all.push_back(field);
    PreparedBoxes prepared;
    for (const auto& [id, record] : state_.boxes) {
        const auto old = prepared_.find(id);
        const bool kept =
            old != prepared_.end() && !touched_boxes_.contains(id) && !reads_any_of(*record, touched_fields_);
        prepared[id] = kept ? old->second : prepare(*record, all);
    }
    return prepared;
}

/// Only results that differ from the last one by events alone can tell: another view brings boxes too, or another error or span.
void ClientStore::count_late_events(const CullKey& key) {
    const StoreSnapshot& before = *snapshot_;
    if (before.result == 0 || key.log_position == before.log_position) return;
    CullKey same = before.key;
    same.log_position = key.log_position;
    if (key != same) return;
    for (const BoxId id : touched_boxes_) {
        const auto now = state_.boxes.find(id);
        if (now == state_.boxes.end()) continue;
        const auto old = before.interest->boxes.find(id);
        const SeaTime changes = old == before.interest->boxes.end() ? now->second->begin
                                                                    : differ_from(*now->second, *old->second);
        if (changes < before.watermark) ++counters_.late_events;
    }
}

Result<Done> ClientStore::apply(const TerrainTiles& message) {
    if (!hello_ || hello_->terrain.columns == 0)
        return Error{ErrorCode::unexpected_message, "a terrain tile came though the hello names no terrain"};
    const TerrainGrid grid = outline_of(hello_->terrain);
    auto tiles = std::make_shared<TerrainTileMap>(*snapshot_->tiles);
    for (const TerrainTile& tile : message.tiles) {
        if (!belongs_to(tile, grid))
            return out_of_range(
                fmt::format("terrain tile {} {} {} is none of the terrain that the hello names",
                            tile.key.level, tile.key.x, tile.key.z));
        (*tiles)[tile.key] = std::make_shared<TerrainTile>(tile);
        ++counters_.tiles;
    }
    auto next = std::make_shared<StoreSnapshot>(*snapshot_);
    next->tiles = std::move(tiles);
    snapshot_ = std::move(next);
    return Done{};
}

void ClientStore::confirm(SeaTime watermark, LogPosition position) {
    if (watermark <= snapshot_->watermark) return;
    // Confirmed only as far as what we hold reflects the log: a reply may outrun the result that it speaks of.
    if (snapshot_->result == 0 || position > snapshot_->log_position) return;
    auto next = std::make_shared<StoreSnapshot>(*snapshot_);
    next->watermark = watermark;
    snapshot_ = std::move(next);
}

}  // namespace trochoid
