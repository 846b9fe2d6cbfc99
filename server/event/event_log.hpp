#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "protocol/codec/codec.hpp"
#include "protocol/units/ids.hpp"

namespace trochoid {

/// The events are in the log and stay there.
struct Appended {
    LogPosition position;   ///< of the first of them: the number of events before it
    uint64_t log_hash = 0;  ///< rolling hash of the log up to and with the last of them
    bool operator==(const Appended&) const = default;
};

/// Somebody else appended first: read from the expected position, plan again.
struct Conflict {
    LogPosition current;  ///< number of events in the log
    bool operator==(const Conflict&) const = default;
};

/// It cannot be said whether the event is in the log (a broken connection, say): append it again under the same id.
struct Unknown {
    bool operator==(const Unknown&) const = default;
};

using AppendResult = std::variant<Appended, Conflict, Unknown>;

/// An event that is to be appended.
struct NewEvent {
    uint64_t id = 0;  ///< above 0, never used for another one
    Bytes bytes;
    bool operator==(const NewEvent&) const = default;
};

/// An event as the log holds it.
struct StoredEvent {
    LogPosition position;
    uint64_t event_id = 0;
    uint64_t log_hash = 0;  ///< rolling hash of the log up to and with this event
    Bytes bytes;
    /// The last of those that were appended together: readers see all of them or none.
    bool closes = true;
    bool operator==(const StoredEvent&) const = default;
};

/// Rolling hash of an empty log.
inline constexpr uint64_t empty_log_hash = 0;

/// One step of the rolling hash: FNV-1a over the previous hash, the length of the bytes (both u64, little-endian) and the
/// bytes. Two nodes with equal hashes hold equal logs.
uint64_t chain_hash(uint64_t previous, std::span<const uint8_t> bytes);

/// What happened to the world, in order, as the bytes that a journal stores. Every call belongs on one strand, the
/// owner's: nothing here locks.
class EventLog {
public:
    EventLog() = default;
    EventLog(const EventLog&) = delete;
    EventLog& operator=(const EventLog&) = delete;
    virtual ~EventLog() = default;

    /// Adds events, at least one, where the log holds exactly `expected` events: all of them or, whatever breaks meanwhile, none; a
    /// journal writes them as one record. A first id that the log already holds adds nothing and answers with its position,
    /// whatever was expected and whatever the bytes: the events that went with it are there too. Ids are above 0.
    virtual AppendResult append(LogPosition expected, std::span<const NewEvent> events) = 0;
    /// The same for one event.
    AppendResult append(LogPosition expected, uint64_t event_id, std::span<const uint8_t> bytes);

    /// Events from a position onwards, in order, at most `limit`; fewer only where the log ends.
    virtual std::vector<StoredEvent> read(LogPosition from, size_t limit) const = 0;
    /// Rolling hash of the first `position` events; none where the log has fewer.
    std::optional<uint64_t> hash_at(LogPosition position) const;
};

/// An event log that lives as long as its process.
class InMemoryEventLog final : public EventLog {
public:
    using EventLog::append;
    AppendResult append(LogPosition expected, std::span<const NewEvent> events) override;
    std::vector<StoredEvent> read(LogPosition from, size_t limit) const override;

private:
    std::vector<StoredEvent> events_;
    struct Place {
        size_t first = 0;
        size_t last = 0;  ///< of those appended with it
    };
    std::map<uint64_t, Place> place_of_id_;
};

}  // namespace trochoid
