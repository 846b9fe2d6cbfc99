#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/codec/messages.hpp"
#include "protocol/units/result.hpp"
#include "server/net/resume_verdict.hpp"

namespace trochoid {

/// What a server hello says about the world.
struct HelloFacts {
    std::string world;
    WorldInstance instance;
    LogPosition log_position;
    SeaClock clock;
    std::string projection;
    double origin_lon = 0.0;
    double origin_lat = 0.0;
    TerrainInfo terrain;
};

/// What a clock reply says about the world.
struct ClockFacts {
    SeaClock clock;
    SeaTime watermark;  ///< nothing more takes effect before it
    LogPosition log_position;
    uint64_t log_hash = 0;
};

/// What a session asks a result for.
struct ResultRequest {
    const ViewState& view;
    const std::vector<SyncRegion>& regions;
    const CullKey* previous = nullptr;  ///< key of the last result written; nullptr: the client holds nothing
    int64_t round_trip_us = 0;          ///< from a result's last byte to its ack; 0: not known yet
    double turn = 0.0;                  ///< rad/s, how fast the camera turns
};

struct MadeResult {
    CullKey key;
    std::shared_ptr<const InterestState> state;
    SeaTime watermark;
    /// Monotonic time (microseconds) at which the key's span of sea time has to be replaced; INT64_MAX: never.
    int64_t refresh_at_us = INT64_MAX;
};

/// How a hello came in.
struct LoginDecision {
    Role role = Role::viewer;
    uint64_t last_session = 0;  ///< the session that the hello's ticket is of; 0: no ticket decided
    bool operator==(const LoginDecision&) const = default;
};

/// For the next hello of whoever gets it.
struct IssuedTicket {
    std::vector<uint8_t> ticket;  ///< at most longest_ticket bytes; empty: none
    uint32_t life_ms = 0;
};

struct Resumption {
    ResumeVerdict verdict = ResumeVerdict::too_old;
    MadeResult held;  ///< what the client holds; only where resumed
};

/// All that sessions need of the world; server/app implements it, tests fake it. Every call happens on the io thread and
/// returns within a few milliseconds; what takes longer answers through a callback, on the io thread too.
class SeaProvider {
public:
    SeaProvider() = default;
    SeaProvider(const SeaProvider&) = delete;
    SeaProvider& operator=(const SeaProvider&) = delete;
    virtual ~SeaProvider() = default;

    virtual HelloFacts hello_facts() const = 0;
    virtual ClockFacts clock_facts() const = 0;
    /// The role that a hello's ticket or token gives, or why none (token_required, token_refused). Both are good once: this
    /// call uses them up. `loopback`: the peer is on this machine.
    virtual Result<LoginDecision> login(const ClientHello& hello, bool loopback) = 0;
    /// What lets this session's client come back as what it is.
    virtual IssuedTicket new_ticket(uint64_t session, Role role) = 0;

    /// nullopt: the previous result still holds. Never nullopt without a previous one.
    virtual std::optional<MadeResult> make_result(const ResultRequest& request) = 0;
    /// The same for who holds nothing yet or asks for much: may be computed where it holds up nobody. Calls back once, on the io thread,
    /// maybe before this returns; what the request refers to need not last.
    virtual void make_result_aside(const ResultRequest& request,
                                   const std::function<void(std::optional<MadeResult>)>& done) {
        done(make_result(request));
    }
    /// Checks what a client says it holds; whatever it says, at most one result is computed.
    virtual Resumption resume(const ResumeState& claim) = 0;
    /// The sums at a probe's points as this state has them; only the first points where their parts would be too many.
    virtual ProbeReply probe(const InterestState& state, const Probe& probe) const = 0;
    /// What leads from one state to another, the patches in the order of priority under the key.
    virtual InterestDelta change(const InterestState& base, const InterestState& target,
                                 const CullKey& key) const = 0;

    /// Terrain that the view calls for, what it needs most first, coarse before fine.
    virtual std::vector<TerrainTileKey> tiles_for(const ViewState& view) = 0;
    /// Changes whenever the tile does: a client that was sent another revision has it again.
    virtual uint32_t tile_revision(TerrainTileKey key) const = 0;
    virtual TerrainTile tile(TerrainTileKey key) = 0;

    /// Everything but ListBoxes. The callback comes once, maybe much later (land has to be traced), maybe before this
    /// returns; the reply's sequence is the command's. `session`: the number of the one that asks.
    virtual void command(const Command& command, Role role, uint64_t session,
                         std::function<void(CommandReply)> reply) = 0;
    /// A session has ended: what it has asked for and was not begun is dropped without a reply.
    virtual void session_over(uint64_t session) = 0;
    virtual BoxList list_boxes() const = 0;
    virtual Result<SampleReply> sample(const SampleRequest& request) const = 0;
    virtual Result<RaysReply> rays(const RaysRequest& request) const = 0;
};

}  // namespace trochoid
