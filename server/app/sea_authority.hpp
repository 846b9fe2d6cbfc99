#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/app/land_queue.hpp"
#include "server/app/land_worker.hpp"
#include "server/app/terrain_choice.hpp"
#include "server/event/event_log.hpp"
#include "server/event/scene.hpp"
#include "server/interest/interest_index.hpp"
#include "server/net/io_loop.hpp"
#include "server/world/world.hpp"

namespace trochoid {

/// Owns the world, the event log and the clock. A command goes: accept → plan → stamp → append → apply → publish → reply. Where a
/// command makes several events (a ship's new course), they are logged and published together. Lives on the io thread.
///
/// Most commands are carried out and answered at once. Those for which land has to be traced (on the worker) queue: one trace goes on
/// at a time, and the command is planned and stamped again when it is done, since others have passed it meanwhile.
/// Neighbours in the queue that change the land to take hold at once are traced together and make one event.
/// A command that names a box which does not exist yet keeps its place behind those that may make it.
///
/// Several nodes may follow one log, each with its own world. Whoever appends first is first: the others take in what it wrote (tracing
/// land from the event by themselves) and plan again. Their sea times are one where their monotonic clocks are (one machine).
class SeaAuthority {
public:
    /// Events of one node are numbered in so many bits, and the node above.
    static constexpr int event_number_bits = 40;
    /// `node`: 0 where nobody else writes this log; else 1 to 2^23, another number for each node. `world` at position 0 or
    /// wherever it has been replayed to.
    SeaAuthority(IoLoop& loop, World& world, EventLog& log, LandWorker& worker, uint32_t lead_ms,
                 uint32_t node = 0);
    SeaAuthority(const SeaAuthority&) = delete;
    SeaAuthority& operator=(const SeaAuthority&) = delete;

    /// Appends the scene's breakwaters, winds, boxes and ships, in this order, before the loop runs. Throws OperatorError where one
    /// cannot be.
    void open(const Scene& scene);
    /// Called after every change, on the io thread.
    void on_change(std::function<void()> changed) { changed_ = std::move(changed); }

    using Reply = std::function<void(CommandReply)>;
    /// A director's command (not ListBoxes). The reply comes once, on the io thread; queue_overflow where too many wait. `session`:
    /// who asks, 0 for this process itself.
    void command(const Command& command, Reply reply, uint64_t session = 0);
    /// Takes in what other nodes have appended and publishes it. Without effect on a node that is alone; others call it often: how far
    /// the watermark gets depends on it. Waits for the land of what comes.
    void follow();
    /// A session is over: what it has left in the queue is dropped without a reply.
    void session_over(uint64_t session);

    std::shared_ptr<const WorldState> state() const { return state_; }
    std::shared_ptr<const InterestIndex> index() const { return index_; }
    /// The index as of a log position at which something was published; null where it is not kept any more, or not known yet.
    std::shared_ptr<const InterestIndex> index_at(LogPosition position) const;
    /// Rolling hash of the log up to a position; none where this node is not so far.
    std::optional<uint64_t> log_hash_at(LogPosition position) const;
    std::shared_ptr<const TerrainChoice> terrain_choice() const { return choice_; }
    SeaTime now() const;
    /// Nothing that is still to come takes effect before it. Never falls. With other nodes: a lead after this one read the log last.
    SeaTime watermark();

private:
    struct Planned {
        LogEvent event;
        Derived derived;
    };
    // sea_authority.cpp: the scene, and what is done at once.
    void open_breakwaters(const Scene& scene);
    void open_ship(const SceneShip& ship);
    void open_box(const std::string& name, const Result<BoxStarted>& planned);
    CommandReply carry_out(const Command& command);
    /// None: another node was first, and what it wrote is in; to be tried again.
    using Attempt = std::optional<CommandReply>;
    Attempt attempt(const StopWind& stop, const Command& command);
    Attempt attempt(const SetRate& rate, const Command& command);
    Attempt attempt(const SkipTime& skip, const Command& command);
    Attempt attempt(const StartShip& ship, const Command& command);
    Attempt attempt(const Steer& steer, const Command& command);
    std::optional<CommandReply> start_on_open_water(const StartWind& wind, const Command& command);
    std::optional<CommandReply> at_once(const Command& command);

    // sea_authority_land.cpp: what queues.
    void go_on();
    void begin(const StartWind& wind, WaitingCommand waiting);
    void trace_then_start(const BoxStarted& planned, const StartWind& wind, WaitingCommand waiting,
                          int attempt);
    void start_traced(const BoxStarted& planned, WaitingCommand waiting, TracedLand land,
                      IndexedLand indexed);
    using Together = std::vector<WaitingCommand>;  ///< changes of the land, in order, at least one
    void begin_land_change(WaitingCommand first);
    void trace_changes(Together changes, SeaTime expected, std::shared_ptr<const ChangedLand> earlier);
    void changes_traced(Together changes, const LandAnswer& answer);
    void change_land_with(const std::shared_ptr<const ChangedLand>& changed, Together changes);
    void one_by_one(Together changes, const Error& error);
    void answer(const WaitingCommand& waiting, CommandReply reply);

    // sea_authority_nodes.cpp: what other nodes write, and what was published before.
    void learn_from_log();
    void count_own(uint64_t event_id);
    bool take_in();
    void fold_foreign(const StoredEvent& stored);
    void clock_changes(const SeaClock& next);
    SeaTime earliest();

    Result<SeaTime> stamp(const Command& command);
    Result<SeaTime> stamp_land(const Command& command);
    Attempt commit(const Command& command, std::vector<Planned> planned, BoxId box,
                   const ChangedLand* land = nullptr);
    bool append(std::vector<Planned> planned);
    void append_to_own(std::vector<Planned> planned);
    static std::vector<Planned> single(LogEvent event, Derived derived);
    static std::vector<Planned> planned_of(const Steering& steering);
    void take_land(const ChangedLand& changed);
    void renew();
    void publish();
    static CommandReply refused(const Command& command, const Error& error);

    IoLoop& loop_;
    World& world_;
    EventLog& log_;
    LandWorker& worker_;
    uint32_t lead_ms_;
    uint32_t node_;
    std::shared_ptr<const WorldState> state_;
    std::shared_ptr<const InterestIndex> index_;
    std::shared_ptr<const TerrainChoice> choice_;
    IndexedLand indexed_;  // for the next index
    std::function<void()> changed_;
    LandQueue queue_;
    bool tracing_ = false;             // the command before the queue's first
    uint64_t next_event_ = 1;          // below the node's bits
    SeaTime promised_{INT64_MIN / 4};  // the highest watermark given out
    SeaTime floor_{INT64_MIN / 4};     // what other nodes may have promised before the clock changed
    /// Indices that others have taken the place of, and when (monotonic microseconds), the oldest first.
    struct Past {
        std::shared_ptr<const InterestIndex> index;
        int64_t until_us = 0;
    };
    std::deque<Past> past_;
};

}  // namespace trochoid
