#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "protocol/units/result.hpp"

namespace trochoid {

using Bytes = std::vector<uint8_t>;

/// One FlatBuffer with its file identifier ("TRCC" client to server, "TRCS" server to client, "TRLE" log event), no frame
/// header. Encoding the same value gives the same bytes on every machine. Values are not validated: what breaks a range is
/// refused by the decoder of the other side. Sentences (Goodbye and CommandReply messages) are cut to 512 bytes and their
/// control characters made blanks.
Bytes encode(const ClientMessage& message);
Bytes encode(const ServerMessage& message);
Bytes encode(const LogEvent& event);

/// Checks in this order: length, file identifier, verifier (depth and table limits), no trailing bytes, known message, then
/// field by field (present, finite, in range, known enums, unit quaternions): protocol/README.md, "Order of checks". Every
/// refusal has a code and a sentence. `data` must be 8-byte aligned. Sequence rules and rates belong to the session.
Result<ClientMessage> decode_client(std::span<const uint8_t> data);
Result<ServerMessage> decode_server(std::span<const uint8_t> data);
Result<LogEvent> decode_event(std::span<const uint8_t> data);

/// FNV-1a over the schema's text as compiled in: for the hello and logs.
uint64_t schema_hash();

/// Splits a change into deltas whose encoding stays within max_bytes each, in order: boxes, then patches nearest first
/// each after the land blocks under it, then removals; every piece applies alone (as planes, a piece's own patches are in their
/// keys' order). `header` gives result, base, hashes, key, watermark and the patches' form; the state's hash goes into the last piece only. max_bytes must hold the key with its regions and any
/// single entry (15 KiB do: 256 trains, each with a field and its overlay, and 64 legs take 13.3 KiB).
std::vector<Delta> split(const Delta& header, const InterestDelta& change, size_t max_bytes);

}  // namespace trochoid
