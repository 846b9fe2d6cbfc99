#include "server/event/event_log.hpp"

#include <algorithm>

#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {

uint64_t chain_hash(uint64_t previous, std::span<const uint8_t> bytes) {
    return Hash64{}.u64(previous).u64(bytes.size()).bytes(bytes).value();
}

AppendResult EventLog::append(LogPosition expected, uint64_t event_id, std::span<const uint8_t> bytes) {
    const NewEvent event{event_id, Bytes(bytes.begin(), bytes.end())};
    return append(expected, std::span(&event, 1));
}

std::optional<uint64_t> EventLog::hash_at(LogPosition position) const {
    if (position.value == 0) return empty_log_hash;
    const auto last = read({position.value - 1}, 1);
    if (last.empty()) return std::nullopt;
    return last.front().log_hash;
}

AppendResult InMemoryEventLog::append(LogPosition expected, std::span<const NewEvent> events) {
    TROCHOID_ASSERT(!events.empty(), "nothing to append at position {}", expected.value);
    if (const auto known = place_of_id_.find(events.front().id); known != place_of_id_.end())
        return Appended{events_[known->second.first].position, events_[known->second.last].log_hash};
    if (expected.value != events_.size()) return Conflict{LogPosition{events_.size()}};
    const size_t last = events_.size() + events.size() - 1;
    for (const NewEvent& event : events) {
        TROCHOID_ASSERT(event.id != 0, "an event without an id at position {}", events_.size());
        const bool fresh = place_of_id_.emplace(event.id, Place{events_.size(), last}).second;
        TROCHOID_ASSERT(fresh, "event {} a second time, beside others", event.id);
        const uint64_t previous = events_.empty() ? empty_log_hash : events_.back().log_hash;
        events_.push_back({LogPosition{events_.size()}, event.id, chain_hash(previous, event.bytes),
                           event.bytes, events_.size() == last});
    }
    return Appended{expected, events_.back().log_hash};
}

std::vector<StoredEvent> InMemoryEventLog::read(LogPosition from, size_t limit) const {
    if (from.value >= events_.size()) return {};
    const auto first = events_.begin() + static_cast<std::ptrdiff_t>(from.value);
    const size_t count = std::min(limit, events_.size() - static_cast<size_t>(from.value));
    return {first, first + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace trochoid
