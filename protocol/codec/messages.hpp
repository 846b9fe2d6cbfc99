#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "protocol/model/interest_state.hpp"
#include "protocol/model/sea.hpp"
#include "protocol/model/sea_clock.hpp"
#include "protocol/model/terrain.hpp"
#include "protocol/model/wave_ray.hpp"
#include "protocol/units/error_code.hpp"

// The messages as values; codec.hpp turns them into bytes and back. The standard is protocol/README.md.
namespace trochoid {

enum class Role : uint8_t { viewer = 0, director = 1 };

/// Limits in force, stated in the server hello (protocol/README.md, "Limits").
struct Limits {
    uint32_t frame_before_login = 4096;  ///< bytes, client to server
    uint32_t frame_after_login = 65536;  ///< bytes, client to server
    uint32_t frame_to_client = 16384;    ///< bytes, server to client
    uint32_t hello_deadline_ms = 5000;
    uint32_t views_per_second = 30;
    uint32_t sync_regions = 32;
    uint32_t sync_radius = 2048U * 1024U;  ///< lattice units, 2 km
    uint32_t patches = 1024;
    uint32_t trains_per_box = 64;
    uint32_t boxes = 1024;
    uint32_t commands_per_second = 20;
    uint32_t sample_points = 240;
    uint32_t sessions = 4096;
    uint32_t control_messages = 64;
    uint32_t no_progress_ms = 120000;
    uint32_t command_lead_ms = 500;
    bool operator==(const Limits&) const = default;
};

// ---- client to server ----

struct ClientHello {
    uint16_t protocol_min = 0;
    uint16_t protocol_max = 0;
    uint16_t model = 0;
    uint64_t schema_hash = 0;  ///< for logs, never a reason to refuse
    std::string software;
    std::string world;  ///< empty: whichever the server has
    std::string token;  ///< empty: viewer
    ViewState view;
    std::vector<SyncRegion> regions;
    int64_t clock_stamp_us = 0;  ///< client's monotonic clock at sending
    bool operator==(const ClientHello&) const = default;
};

struct ViewUpdate {
    uint32_t sequence = 0;
    ViewState view;
    bool operator==(const ViewUpdate&) const = default;
};

struct SyncRegions {
    uint32_t sequence = 0;
    std::vector<SyncRegion> regions;
    bool operator==(const SyncRegions&) const = default;
};

struct ClockRequest {
    uint32_t sequence = 0;
    int64_t client_sent_us = 0;
    bool operator==(const ClockRequest&) const = default;
};

struct Ack {
    uint32_t result = 0;                   ///< the last result applied whole
    uint64_t state_hash = 0;               ///< hash of the client's interest state after it
    uint32_t patches_per_second = 0;       ///< how fast the client takes patches, 0 = unknown
    std::optional<uint64_t> known_answer;  ///< with the first ack: answer to the hello's challenge
    bool operator==(const Ack&) const = default;
};

/// Wind as a director asks for it (row A2).
struct StartWind {
    float speed = 10.0F;           ///< m/s at 19.5 m, 1 to 40
    float towards_degrees = 0.0F;  ///< heading that the waves travel towards, clockwise from north, [0, 360)
    LatticePoint origin;           ///< middle of the rear edge
    int64_t fetch = 0;             ///< lattice units along travel
    int64_t width = 0;             ///< lattice units across
    int64_t life_us = 0;           ///< until decay starts; 0 = until stopped
    uint16_t trains = 16;          ///< 1 to 64
    uint64_t seed = 0;             ///< phases and directions; 0 = the server chooses
    bool operator==(const StartWind&) const = default;
};
struct StopWind {
    BoxId box;
    bool operator==(const StopWind&) const = default;
};
struct ListBoxes {
    bool operator==(const ListBoxes&) const = default;
};
struct SetRate {
    uint32_t rate_q16 = 1U << 16;
    bool operator==(const SetRate&) const = default;
};
struct Command {
    uint32_t sequence = 0;
    SeaTime at;                   ///< asked effective time; the past means "as soon as possible"
    bool refuse_if_late = false;  ///< refuse instead of deferring when `at` cannot be met
    std::variant<StartWind, StopWind, ListBoxes, SetRate> action;
    bool operator==(const Command&) const = default;
};

/// Asks the server for its own answer at rest points (conformance, debugging). At most Limits::sample_points.
struct SampleRequest {
    uint32_t sequence = 0;
    SeaTime time;
    std::vector<LatticePoint> points;
    bool operator==(const SampleRequest&) const = default;
};

/// Asks for a box's traced wave rays (debug views).
struct RaysRequest {
    uint32_t sequence = 0;
    BoxId box;
    bool operator==(const RaysRequest&) const = default;
};

// ---- both ways ----

struct Goodbye {
    ErrorCode code = ErrorCode::none;
    std::string message;  ///< one sentence that says what to do
    bool retry = false;
    uint32_t retry_after_ms = 0;
    uint32_t offending_sequence = 0;
    uint16_t requirement = 0;  ///< number of the requirement in the standard that was broken, 0 = none
    bool operator==(const Goodbye&) const = default;
};

// ---- server to client ----

/// The terrain that the tiles come from.
struct TerrainInfo {
    int64_t origin_x = 0;
    int64_t origin_z = 0;
    uint32_t spacing_log2 = 15;
    uint32_t columns = 0;  ///< 0: no terrain, open sea everywhere
    uint32_t rows = 0;
    int32_t height_step_log2 = 5;
    int32_t open_sea_depth = 0;  ///< height of the bottom outside, lattice units, negative
    bool operator==(const TerrainInfo&) const = default;
};

struct ServerHello {
    uint16_t protocol = 0;
    uint16_t model = 0;
    uint64_t schema_hash = 0;
    std::string software;
    uint64_t session = 0;
    std::string world;
    WorldInstance instance;
    Role role = Role::viewer;
    LogPosition log_position;
    SeaClock clock;
    int64_t client_stamp_us = 0;  ///< echoed first clock stamp
    int64_t server_now_us = 0;    ///< server's monotonic clock at sending
    Limits limits;
    uint64_t challenge_seed = 0;  ///< known-answer challenge: reference_hash(seed, count)
    uint32_t challenge_count = 0;
    std::string projection;   ///< PROJ string of the world frame; empty without terrain
    double origin_lon = 0.0;  ///< degrees, of x = z = 0
    double origin_lat = 0.0;
    TerrainInfo terrain;
    bool operator==(const ServerHello&) const = default;
};

/// The server's verdict on a client's known answer: whether both compute the same sea.
enum class Verdict : uint8_t { pending = 0, exact = 1, approximate = 2 };

struct ClockReply {
    uint32_t sequence = 0;
    int64_t client_sent_us = 0;
    int64_t server_received_us = 0;
    int64_t server_sent_us = 0;
    SeaClock clock;
    SeaTime watermark;  ///< nothing more takes effect before it
    LogPosition log_position;
    uint64_t log_hash = 0;  ///< rolling hash of the log's bytes
    Verdict verdict = Verdict::pending;
    bool operator==(const ClockReply&) const = default;
};

/// One piece of a result. Every piece applies alone; the last one carries the state's hash.
struct Delta {
    uint32_t result = 0;  ///< number of the result, ascending by 1
    uint16_t piece = 0;   ///< 0, 1, …
    bool last = false;
    uint32_t base = 0;  ///< result that it builds on; 0 = nothing (snapshot: drop all first)
    uint64_t base_hash = 0;
    uint64_t state_hash = 0;  ///< in the last piece: hash_of(InterestState) after it
    CullKey key;
    SeaTime watermark;
    InterestDelta change;
};

struct TerrainTiles {
    std::vector<TerrainTile> tiles;  ///< one tile a message in practice (8.5 KB)
    bool operator==(const TerrainTiles&) const = default;
};

struct CommandReply {
    uint32_t sequence = 0;
    ErrorCode code = ErrorCode::none;
    std::string message;
    SeaTime effective;         ///< when it takes hold
    LogPosition log_position;  ///< after the event
    BoxId box;                 ///< started or stopped box
    bool operator==(const CommandReply&) const = default;
};

/// A line of `trochoid-ctl list`.
struct BoxSummary {
    BoxId box;
    std::string name;  ///< as in the scene file, or "wind N"
    SeaTime begin;
    SeaTime end;  ///< start of the decay
    int64_t decay_us = 0;
    uint16_t trains = 0;
    float significant_height = 0.0F;  ///< m, fully grown, open water
    float wind_speed = 0.0F;          ///< m/s
    float towards_degrees = 0.0F;
    float gain_now = 0.0F;  ///< time part of the envelope at the reply's sea time
    bool operator==(const BoxSummary&) const = default;
};
struct BoxList {
    uint32_t sequence = 0;
    SeaTime now;
    std::vector<BoxSummary> boxes;
    bool last = true;  ///< false: more follow under the same sequence
    bool operator==(const BoxList&) const = default;
};

struct SampleReply {
    uint32_t sequence = 0;
    SeaTime time;
    LogPosition log_position;
    std::vector<SurfaceSample> samples;
    bool operator==(const SampleReply&) const = default;
};

struct RaysReply {
    uint32_t sequence = 0;
    BoxId box;
    std::vector<WaveRay> rays;
    bool last = true;
    bool operator==(const RaysReply&) const = default;
};

using ClientMessage = std::variant<ClientHello, ViewUpdate, SyncRegions, ClockRequest, Ack, Command,
                                   SampleRequest, RaysRequest, Goodbye>;
using ServerMessage = std::variant<ServerHello, ClockReply, Delta, TerrainTiles, CommandReply, BoxList,
                                   SampleReply, RaysReply, Goodbye>;

// ---- the event log: the bytes that the journal stores ----

/// A wind has started: its box exactly as quantised. The land fields are derived by each node from terrain and box.
struct BoxStarted {
    WaveTrainBox box;
    std::string name;
    StartWind wind;
    bool operator==(const BoxStarted&) const = default;
};
/// A wind has ended: the box's decay starts at `end`.
struct BoxEnding {
    BoxId box;
    SeaTime end;
    bool operator==(const BoxEnding&) const = default;
};
/// Rate or jump: a new time epoch. monotonic_start_us is of the node that wrote it; another node substitutes its own.
struct ClockChanged {
    SeaClock clock;
    bool operator==(const ClockChanged&) const = default;
};
struct LogEvent {
    uint64_t event_id = 0;  ///< unique; the same id again is the same event
    SeaTime effective;
    std::variant<BoxStarted, BoxEnding, ClockChanged> what;
    bool operator==(const LogEvent&) const = default;
};

}  // namespace trochoid
