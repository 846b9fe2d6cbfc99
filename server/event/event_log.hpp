#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <variant>
#include <vector>

#include "protocol/codec/codec.hpp"
#include "protocol/units/ids.hpp"

namespace trochoid {

/// The event is in the log and stays there.
struct Appended {
    LogPosition position;   ///< of the event: the number of events before it
    uint64_t log_hash = 0;  ///< rolling hash of the log up to and with it
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

/// An event as the log holds it.
struct StoredEvent {
    LogPosition position;
    uint64_t event_id = 0;
    uint64_t log_hash = 0;  ///< rolling hash of the log up to and with this event
    Bytes bytes;
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

    /// Adds an event where the log holds exactly `expected` events. An id that the log already holds adds nothing and
    /// answers with its position, whatever was expected and whatever the bytes. Ids are above 0.
    virtual AppendResult append(LogPosition expected, uint64_t event_id, std::span<const uint8_t> bytes) = 0;

    /// Events from a position onwards, in order, at most `limit`; fewer only where the log ends.
    virtual std::vector<StoredEvent> read(LogPosition from, size_t limit) const = 0;
};

/// An event log that lives as long as its process.
class InMemoryEventLog final : public EventLog {
public:
    AppendResult append(LogPosition expected, uint64_t event_id, std::span<const uint8_t> bytes) override;
    std::vector<StoredEvent> read(LogPosition from, size_t limit) const override;

private:
    std::vector<StoredEvent> events_;
    std::map<uint64_t, size_t> place_of_id_;
};

}  // namespace trochoid
