#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/app/land_worker.hpp"
#include "server/app/terrain_choice.hpp"
#include "server/event/event_log.hpp"
#include "server/event/scene.hpp"
#include "server/interest/interest_index.hpp"
#include "server/net/io_loop.hpp"
#include "server/world/world.hpp"

namespace trochoid {

/// Owns the world, the event log and the clock. A command goes: accept → plan → trace the land of a new box, or of all boxes on
/// changed land (on the worker) → stamp → append → apply → publish → reply; one after the other, so that each is planned
/// on what it changes. Where a command makes several events (a ship's new course), they are logged and published together.
/// Lives on the io thread.
class SeaAuthority {
public:
    /// Commands that wait for the one in progress; more are refused with rate_limited.
    static constexpr size_t most_waiting = 64;

    SeaAuthority(IoLoop& loop, World& world, EventLog& log, LandWorker& worker, uint32_t lead_ms);
    SeaAuthority(const SeaAuthority&) = delete;
    SeaAuthority& operator=(const SeaAuthority&) = delete;

    /// Appends the scene's breakwaters, winds, boxes and ships, in this order, before the loop runs. Throws OperatorError where one
    /// cannot be.
    void open(const Scene& scene);
    /// Called after every change, on the io thread.
    void on_change(std::function<void()> changed) { changed_ = std::move(changed); }

    using Reply = std::function<void(CommandReply)>;
    /// A director's command (not ListBoxes). The reply comes once, on the io thread.
    void command(const Command& command, Reply reply);

    std::shared_ptr<const WorldState> state() const { return state_; }
    std::shared_ptr<const InterestIndex> index() const { return index_; }
    std::shared_ptr<const TerrainChoice> terrain_choice() const { return choice_; }
    SeaTime now() const;
    /// Nothing that is still to come takes effect before it. Never falls.
    SeaTime watermark();

private:
    struct Waiting {
        Command command;
        Reply reply;
    };
    struct Planned {
        LogEvent event;
        Derived derived;
    };
    void open_breakwaters(const Scene& scene);
    void open_ship(const SceneShip& ship);
    void open_box(const std::string& name, const Result<BoxStarted>& planned);
    void next();
    void execute(const StartWind& wind, const Waiting& waiting);
    void execute(const StopWind& stop, const Waiting& waiting);
    void execute(const SetRate& rate, const Waiting& waiting);
    void execute(const StartShip& ship, const Waiting& waiting);
    void execute(const Steer& steer, const Waiting& waiting);
    void execute(const ChangeLand& change, const Waiting& waiting);
    void execute(const ListBoxes&, const Waiting&);
    void trace_then_start(const BoxStarted& planned, StartWind wind, Waiting waiting, int attempt);
    void change_land_with(const ChangedLand& changed, const std::vector<BoxId>& traced,
                          const ChangeLand& change, const Waiting& waiting);
    Result<SeaTime> stamp(const Command& command);
    Result<SeaTime> stamp_land(const Command& command);
    CommandReply commit(const Command& command, std::vector<Planned> planned, BoxId box);
    void append(std::vector<Planned> planned);
    static std::vector<Planned> single(LogEvent event, Derived derived);
    static std::vector<Planned> planned_of(const Steering& steering);
    void take_land(const ChangedLand& changed);
    void publish();
    void finish(const Waiting& waiting, CommandReply reply);
    void finish_refused(const Waiting& waiting, const Error& error);

    IoLoop& loop_;
    World& world_;
    EventLog& log_;
    LandWorker& worker_;
    uint32_t lead_ms_;
    std::shared_ptr<const WorldState> state_;
    std::shared_ptr<const InterestIndex> index_;
    std::shared_ptr<const TerrainChoice> choice_;
    IndexedLand indexed_;  // for the next index
    std::function<void()> changed_;
    std::deque<Waiting> waiting_;
    bool busy_ = false;
    uint64_t next_event_ = 1;
    SeaTime promised_{INT64_MIN / 4};  // the highest watermark given out
};

}  // namespace trochoid
