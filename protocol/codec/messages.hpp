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

/// Each may all that those before it may. Only an admin moves time (SetRate, SkipTime).
enum class Role : uint8_t { viewer = 0, director = 1, admin = 2 };

/// What an end of a session can do beyond protocol version 2; the bits of both hellos.
inline constexpr uint64_t capability_probes = 1;
inline constexpr uint64_t capability_resume = 2;
inline constexpr size_t longest_ticket = 512;  ///< bytes
inline constexpr size_t most_probe_points = 16;
/// Of all points of a reply together: 14 KiB.
inline constexpr size_t most_probe_parts = 896;

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
    uint32_t trains_per_box = 256;
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

/// What a client still holds from an earlier session, of whichever node of the world.
struct ResumeState {
    WorldInstance instance;
    CullKey key;               ///< of the last result applied whole
    uint64_t state_hash = 0;   ///< of what the client holds
    LogPosition log_position;  ///< the last that a server told, and
    uint64_t log_hash = 0;     ///< the rolling hash there
    bool operator==(const ResumeState&) const = default;
};

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
    uint64_t capabilities = 0;
    std::vector<uint8_t> ticket;  ///< of an earlier session, in place of a token; empty: none
    std::optional<ResumeState> resume;
    ErrorCode last_code = ErrorCode::none;  ///< how the client's last session ended
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

/// Ranges of what a director asks for, beside those at the fields.
inline constexpr float fastest_wind_box = 100.0F;     ///< m/s: a storm that moves
inline constexpr float shallowest_reference = 1.0F;   ///< m
inline constexpr float deepest_reference = 12000.0F;  ///< m
inline constexpr float slowest_ship = 0.5F;           ///< m/s
inline constexpr float fastest_ship = 30.0F;
inline constexpr float longest_ship = longest_hull;  ///< m
inline constexpr size_t longest_ship_name = 64;      ///< bytes
inline constexpr size_t most_line_points = 64;

/// Spectrum that a wind's trains are drawn from (rows B1, C2); `automatic` takes JONSWAP where the fetch limits the sea, else
/// Pierson-Moskowitz.
enum class Spectrum : uint8_t { automatic = 0, pierson_moskowitz = 1, jonswap = 2, neumann = 3 };
/// How directions spread about the heading (row B1): cos^2, or Hasselmann, Dunckel and Ewing (1980).
enum class Spreading : uint8_t { automatic = 0, cosine_squared = 1, hasselmann = 2 };

/// Wind as a director asks for it (row A2).
struct StartWind {
    float speed = 10.0F;           ///< m/s at 19.5 m, 1 to 40
    float towards_degrees = 0.0F;  ///< heading that the waves travel towards, clockwise from north, [0, 360)
    LatticePoint origin;           ///< middle of the rear edge
    int64_t fetch = 0;             ///< lattice units along travel
    int64_t width = 0;             ///< lattice units across
    int64_t life_us = 0;           ///< until decay starts; 0 = until stopped
    uint16_t trains = 16;          ///< 1 to 256
    uint64_t seed = 0;             ///< phases and directions; 0 = the server chooses
    Spectrum spectrum = Spectrum::automatic;
    Spreading spreading = Spreading::automatic;
    /// Directions of each frequency (paper C's M x n partition: trains = M * directions); 0: every train has its own. A
    /// divisor of `trains`.
    uint16_t directions = 0;
    float reference_depth =
        0.0F;  ///< m, depth that the trains' frequencies are for (row B2): 0 = deep, or 1 to 12000
    float roundness = 0.0F;     ///< 0 to 1: round waves (eq. 10)
    float irregularity = 0.0F;  ///< 0 to 1: a/A of irregular heights (eq. 8)
    float noise = 0.0F;         ///< m, capillary noise that the wind adds to its water (eq. 9), 0 to 1
    float vx = 0.0F;            ///< m/s east: a storm that moves (row A12); length of (vx, vz) up to 100
    float vz = 0.0F;            ///< m/s south
    bool operator==(const StartWind&) const = default;
};
struct StopWind {
    BoxId box;
    bool operator==(const StopWind&) const = default;
};
/// A ship begins its course: a box with its Kelvin wake (rows A12, B11).
struct StartShip {
    LatticePoint at;
    float towards_degrees = 0.0F;  ///< course, clockwise from north, [0, 360)
    float speed = 5.0F;            ///< m/s, 0.5 to 30
    float length = 100.0F;         ///< m, of the hull at the water line, 1 to 500
    float beam = 0.0F;             ///< m, up to the length; 0: a seventh of it
    std::string name;              ///< up to 64 bytes; empty: "ship N"
    bool operator==(const StartShip&) const = default;
};
/// A moving wind's or ship's new course. A ship's old leg is left to decay and the reply names the new leg's box.
struct Steer {
    BoxId box;
    float towards_degrees = 0.0F;
    float speed = 0.0F;  ///< m/s: ships 0 (stops) to 30, winds 0 to 100
    bool operator==(const Steer&) const = default;
};
/// The bed is raised (or dug) to `crest` along a line: a breakwater, a mole, a channel (row A5: land that changes while running).
struct ChangeLand {
    std::vector<LatticePoint> line;  ///< 2 to 64 points
    float width = 20.0F;             ///< m of the crest, 1 to 2000
    float crest = 3.0F;              ///< m above still water, -200 to 200
    bool dig = false;                ///< lowers what is higher instead of raising what is lower
    bool operator==(const ChangeLand&) const = default;
};
struct ListBoxes {
    bool operator==(const ListBoxes&) const = default;
};
struct SetRate {
    uint32_t rate_q16 = 1U << 16;
    bool operator==(const SetRate&) const = default;
};
/// Sea time goes on from later: a new epoch. For admins.
inline constexpr int64_t longest_skip_us = int64_t{1} << 50;
struct SkipTime {
    int64_t forward_us = 1;  ///< 1 to longest_skip_us
    bool operator==(const SkipTime&) const = default;
};
struct Command {
    uint32_t sequence = 0;
    SeaTime at;                   ///< asked effective time; the past means "as soon as possible"
    bool refuse_if_late = false;  ///< refuse instead of deferring when `at` cannot be met
    std::variant<StartWind, StopWind, ListBoxes, SetRate, StartShip, Steer, ChangeLand, SkipTime> action;
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

/// Asks for the sums that the sea at these points is made of, from what the client holds after a result.
struct Probe {
    uint32_t sequence = 0;
    uint32_t result = 0;  ///< last one applied whole
    SeaTime time;
    std::vector<LatticePoint> points;  ///< 1 to most_probe_points
    bool operator==(const Probe&) const = default;
};

/// The first part of a sum in which client and server differ (protocol/README.md, "Probes").
struct Desync {
    uint32_t sequence = 0;
    uint32_t result = 0;
    SeaTime time;
    LatticePoint at;
    PatchKey patch;
    BoxId box;
    uint16_t part = 0;      ///< as in ProbeReply
    uint64_t expected = 0;  ///< by the server
    uint64_t actual = 0;    ///< by the client
    bool operator==(const Desync&) const = default;
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
    uint64_t capabilities = 0;
    bool resumed = false;         ///< what the client holds counts as result 1
    std::vector<uint8_t> ticket;  ///< for the next hello; empty: none
    uint32_t ticket_life_ms = 0;
    uint64_t last_session = 0;              ///< of the ticket that came, 0: none
    ErrorCode last_code = ErrorCode::none;  ///< how the server saw that session end
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

/// How a delta's patches travel: as lists, all that version 2 knows, or as planes, a third of the bytes.
enum class PatchForm : uint8_t { lists, planes };

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
    InterestDelta change;  ///< as planes: patches and removed patches each ascend by key (`split` sees to it)
    PatchForm patch_form = PatchForm::lists;
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

/// What a box is to a director: waves of the scene, a wind's, a ship's wake, or noise alone.
enum class BoxKind : uint8_t { waves = 0, wind = 1, ship = 2, noise = 3 };
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
    BoxKind kind = BoxKind::waves;
    LatticePoint
        at;  ///< at the reply's sea time: a ship's place, else the middle of the rear edge (the corner where unlimited)
    float vx = 0.0F;  ///< m/s at the reply's sea time; 0 where the box stands
    float vz = 0.0F;
    Hull hull;  ///< a ship's; none where it is not known
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

/// A part of the sum at a point: train `part` of the box, counted from 0, or what follows its trains.
struct ProbePart {
    BoxId box;
    uint16_t part = 0;
    uint64_t sum = 0;  ///< hash of the sums after it
    bool operator==(const ProbePart&) const = default;
};
struct ProbedPoint {
    uint64_t sample = 0;           ///< hash of the 15 floats
    std::vector<ProbePart> parts;  ///< in the order of the sum
    bool operator==(const ProbedPoint&) const = default;
};
struct ProbeReply {
    uint32_t sequence = 0;
    uint32_t result = 0;
    bool stale = false;  ///< another result counts by now: no points
    SeaTime time;
    std::vector<ProbedPoint> points;
    bool operator==(const ProbeReply&) const = default;
};

using ClientMessage = std::variant<ClientHello, ViewUpdate, SyncRegions, ClockRequest, Ack, Command,
                                   SampleRequest, RaysRequest, Goodbye, Probe, Desync>;
using ServerMessage = std::variant<ServerHello, ClockReply, Delta, TerrainTiles, CommandReply, BoxList,
                                   SampleReply, RaysReply, Goodbye, ProbeReply>;

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
/// A moving box takes a new leg.
struct BoxSteered {
    BoxId box;
    CourseLeg leg;
    bool operator==(const BoxSteered&) const = default;
};
/// A box goes on under another id from the moment on which its land is another: the predecessor's decay is the successor's fade.
struct BoxSucceeded {
    BoxId predecessor;
    WaveTrainBox box;
    bool operator==(const BoxSucceeded&) const = default;
};
/// Changes of the land beside the first that one event may carry.
inline constexpr size_t most_joined_changes = 63;
/// The bed has changed, and with it the boxes whose waves it touches. Each node derives the new land fields by itself.
struct LandChanged {
    ChangeLand change;
    std::vector<BoxSucceeded> boxes;  ///< ascending predecessor
    std::vector<ChangeLand>
        also{};  ///< further changes that take hold with it, in order; at most most_joined_changes
    bool operator==(const LandChanged&) const = default;
};
/// Rate or jump: a new time epoch. monotonic_start_us is of the node that wrote it; another node substitutes its own.
struct ClockChanged {
    SeaClock clock;
    bool operator==(const ClockChanged&) const = default;
};
struct LogEvent {
    uint64_t event_id = 0;  ///< unique; the same id again is the same event
    SeaTime effective;
    std::variant<BoxStarted, BoxEnding, ClockChanged, BoxSteered, LandChanged> what;
    /// The sea time at which it was planned: what falls still only later makes no room for it. end_of_time: not known.
    SeaTime present = end_of_time;
    bool operator==(const LogEvent&) const = default;
};

}  // namespace trochoid
