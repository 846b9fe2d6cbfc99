#include "server/event/event_log.hpp"

#include <algorithm>

#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {

uint64_t chain_hash(uint64_t previous, std::span<const uint8_t> bytes) {
    return Hash64{}.u64(previous).u64(bytes.size()).bytes(bytes).value();
}

AppendResult InMemoryEventLog::append(LogPosition expected, uint64_t event_id,
                                      std::span<const uint8_t> bytes) {
    TROCHOID_ASSERT(event_id != 0, "an event without an id at position {}", expected.value);
    if (const auto known = place_of_id_.find(event_id); known != place_of_id_.end()) {
        const StoredEvent& event = events_[known->second];
        return Appended{event.position, event.log_hash};
    }
    if (expected.value != events_.size()) return Conflict{LogPosition{events_.size()}};
    const uint64_t previous = events_.empty() ? empty_log_hash : events_.back().log_hash;
    place_of_id_.emplace(event_id, events_.size());
    events_.push_back({expected, event_id, chain_hash(previous, bytes), Bytes(bytes.begin(), bytes.end())});
    return Appended{expected, events_.back().log_hash};
}

std::vector<StoredEvent> InMemoryEventLog::read(LogPosition from, size_t limit) const {
    if (from.value >= events_.size()) return {};
    const auto first = events_.begin() + static_cast<std::ptrdiff_t>(from.value);
    const size_t count = std::min(limit, events_.size() - static_cast<size_t>(from.value));
    return {first, first + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace trochoid
