// What other nodes append to the log that this one shares with them, and what was published before.
#include <algorithm>
#include <utility>

#include "protocol/codec/codec.hpp"
#include "protocol/model/terrain_file.hpp"
#include "protocol/units/assert.hpp"
#include "server/app/sea_authority.hpp"
#include "server/net/monotonic.hpp"
#include "server/world/effective_time.hpp"

namespace trochoid {

namespace {

// Indices that are kept for clients that come back, and how long after another took their place: they hold their land.
constexpr size_t most_past = 8;
constexpr int64_t past_kept_us = 600 * microseconds_per_second;
constexpr size_t events_a_read = 64;

}  // namespace

// Of a world that was replayed: its land as it is now, the numbers that this node has given its events in earlier lives, and what this
// node and others may have promised before the clock changed.
void SeaAuthority::learn_from_log() {
    if (state_->terrain && state_->log_position > LogPosition{})
        worker_.take_terrain(state_->terrain, terrain_hash(*state_->terrain));
    SeaClock old;
    old.rate_q16 = largest_rate_q16;  // the log does not tell the first: none is faster
    LogPosition at;
    while (at < state_->log_position) {
        const auto events = log_.read(at, std::min(events_a_read, state_->log_position.value - at.value));
        TROCHOID_ASSERT(!events.empty(), "the world is at position {} of a log that ends at {}",
                        state_->log_position.value, at.value);
        for (const StoredEvent& stored : events) {
            count_own(stored.event_id);
            const auto event = decode_event(stored.bytes);
            TROCHOID_ASSERT(event.has_value(), "event {} of the log: {}", stored.position.value,
                            event.error().message);
            const auto* changed = std::get_if<ClockChanged>(&event->what);
            if (changed == nullptr) continue;
            // Sea time goes on where the new rate begins, or later.
            floor_ = std::max(floor_, changed->clock.start + lead_in_sea_time(old, lead_ms_));
            old = changed->clock;
        }
        at.value += events.size();
    }
}

void SeaAuthority::count_own(uint64_t event_id) {
    if (event_id >> event_number_bits != node_) return;
    next_event_ = std::max(next_event_, (event_id & ((uint64_t{1} << event_number_bits) - 1)) + 1);
}

// A node promises as much as it knows to be complete: all that others append after this node's last look at the log is stamped a lead
// after that look, or later.
SeaTime SeaAuthority::watermark() {
    loop_.assert_here();
    if (node_ == 0) promised_ = std::max(promised_, now() + lead_in_sea_time(state_->clock, lead_ms_));
    return promised_;
}

// The earliest sea time at which something new may take effect: not before what this node has promised, nor any other.
SeaTime SeaAuthority::earliest() {
    const SeaTime led = now() + lead_in_sea_time(state_->clock, lead_ms_);
    return std::max({watermark(), floor_, led});
}

// Until it hears of a new clock another node promises by the old one.
void SeaAuthority::clock_changes(const SeaClock& next) {
    if (node_ == 0) return;
    const SeaClock& old = world_.state()->clock;
    floor_ = std::max(floor_, sea_time_at(old, next.monotonic_start_us) + lead_in_sea_time(old, lead_ms_));
}

void SeaAuthority::follow() {
    loop_.assert_here();
    if (node_ == 0) return;
    const int64_t looked_us = monotonic_us();
    const bool news = take_in();
    const SeaClock& clock = state_->clock;
    promised_ = std::max(promised_, sea_time_at(clock, looked_us) + lead_in_sea_time(clock, lead_ms_));
    if (news && changed_) changed_();
}

// Each command's events are published alone, as on the node that wrote them: so every node knows the same positions.
bool SeaAuthority::take_in() {
    bool news = false;
    while (true) {
        const auto events = log_.read(world_.state()->log_position, events_a_read);
        if (events.empty()) return news;
        for (const StoredEvent& stored : events) {
            fold_foreign(stored);
            if (!stored.closes) continue;
            renew();
            news = true;
        }
    }
}

// Our own events are in the world before anybody reads the log: what is read is foreign, or from an earlier life of this node.
void SeaAuthority::fold_foreign(const StoredEvent& stored) {
    const auto before = world_.state();
    TROCHOID_ASSERT(stored.position == before->log_position &&
                        stored.log_hash == chain_hash(before->log_hash, stored.bytes),
                    "event {} of the log does not follow on position {} of the world", stored.position.value,
                    before->log_position.value);
    const auto event = decode_event(stored.bytes);
    TROCHOID_ASSERT(event.has_value(), "event {} of the log: {}", stored.position.value,
                    event.error().message);
    count_own(stored.event_id);
    Derived derived;
    if (const auto* started = std::get_if<BoxStarted>(&event->what)) {
        // No land acts on wakes, nor on ships that lie still.
        if (before->terrain && !is_ship(started->box))
            derived.lands.push_back(worker_.trace_and_wait(started->box, {before->next_field}));
    } else if (const auto* changed = std::get_if<LandChanged>(&event->what)) {
        LandTask task{before, changes_of(*changed), boxes_on_land(*before, event->effective), choice_,
                      before == state_ ? index_ : nullptr};
        const LandAnswer answer = worker_.change_and_wait(std::move(task));
        TROCHOID_ASSERT(answer.changed != nullptr,
                        "the log's change of the land at position {} comes to nothing",
                        stored.position.value);
        derived = derived_from(answer.changed->outcome);
        take_land(*answer.changed);
    } else if (const auto* clock = std::get_if<ClockChanged>(&event->what)) {
        clock_changes(clock->clock);
    }
    world_.apply(*event, stored.bytes, std::move(derived));
}

void SeaAuthority::renew() {
    const int64_t now_us = monotonic_us();
    if (index_->log_position() != world_.state()->log_position) past_.push_back({index_, now_us});
    while (!past_.empty() && (past_.size() > most_past || now_us - past_.front().until_us > past_kept_us))
        past_.pop_front();
    state_ = world_.state();
    index_ = std::make_shared<const InterestIndex>(*state_, index_.get(), std::exchange(indexed_, {}));
}

std::shared_ptr<const InterestIndex> SeaAuthority::index_at(LogPosition position) const {
    if (index_->log_position() == position) return index_;
    const auto past = std::find_if(past_.begin(), past_.end(),
                                   [&](const Past& p) { return p.index->log_position() == position; });
    return past == past_.end() ? nullptr : past->index;
}

std::optional<uint64_t> SeaAuthority::log_hash_at(LogPosition position) const {
    if (position > state_->log_position) return std::nullopt;
    return log_.hash_at(position);
}

}  // namespace trochoid
