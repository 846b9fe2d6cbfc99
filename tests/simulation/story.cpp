#include "tests/simulation/story.hpp"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "tests/simulation/happenings.hpp"
#include "tests/simulation/sim_client.hpp"
#include "tests/simulation/sim_node.hpp"
#include "tests/simulation/sim_world.hpp"
#include "tests/simulation/verdicts.hpp"
#include "tests/simulation/virtual_time.hpp"

namespace trochoid {

namespace {

constexpr int64_t second = 1'000'000;
// Ports: the balancer in front of the nodes that fail, and the node that never does.
constexpr uint16_t balancer = 1;
constexpr std::array<uint16_t, 2> failing{11, 12};
constexpr uint16_t steady = 20;
// A client that has lost its server without being told needs 10 s to see it, and waits 12.5 s at most before it tries again. What rots
// is found within 30 s.
constexpr int64_t calm_us = 34 * second;
constexpr int64_t last_word_us = 6 * second;
// Pauses between tries: 0.5 s doubling up to 10 s, each a quarter less or more.
constexpr int64_t least_pause_us = 370'000;
constexpr uint64_t most_dials_in_20_s = 8;

ViewState first_view() {
    ViewState view;
    view.altitude = 15 * lattice_per_metre;
    view.accepted_error_px = 20.0F;
    view.patch_budget = 320;
    view.viewport_width = 320;
    view.viewport_height = 180;
    return view;
}

const std::vector<SyncRegion>& first_regions() {
    static const std::vector<SyncRegion> regions{
        {{to_lattice(20), to_lattice(-40)}, static_cast<uint32_t>(to_lattice(60))}};
    return regions;
}

/// One life; its members go from the last to the first.
class Story {
public:
    Story(uint64_t seed, bool trace) : trace_(trace), dice_(seed), time_(seed), net_(seed) {}

    StoryEnd tell() {
        prepare();
        const int64_t until = time_.now_us() + dice_.between(8 * second, 20 * second);
        while (end_.failure.empty() && time_.now_us() < until) {
            pass(dice_.between(1000, 1'500'000));
            happen();
        }
        calm();
        pass(calm_us);
        // A last word, so that nobody is right by having heard nothing. Said twice, the second comes while the first is under way.
        if (dice_.one_in(2)) move(dice_.one_in(2));
        last_word();
        if (dice_.one_in(2)) {
            pass(dice_.between(1, 60'000));
            last_word();
        }
        pass(last_word_us);
        judge();
        leave();
        end_.connections = net_.connections();
        end_.events = world_->events();
        return std::move(end_);
    }

private:
    void say(const std::string& what) const {
        if (trace_)
            fmt::print("{:>10.3f} s  {}\n", static_cast<double>(time_.now_us()) * 1e-6 - 1000.0, what);
    }
    void fail(const std::string& who, const std::string& what) {
        if (what.empty() || !end_.failure.empty()) return;
        end_.failure = who + " " + what;
        say("FAILED: " + end_.failure);
    }
    void pass(int64_t us) { time_.run_until(time_.now_us() + us); }
    // What clients show as confirmed counts as promised.
    void watch() {
        time_.at(time_.now_us() + 50'000, [this] {
            for (const auto* client : {client_.get(), twin_.get()})
                world_->promised(client->position(), client->watermark());
            watch();
        });
    }

    void note(const std::string& who, const SimNode& node, bool at_end) {
        const SimCounts counts = node.counts();
        fail(who, verdict(counts, at_end));
        if (!rotten_ && counts.resyncs + counts.desyncs != 0)
            fail(who, fmt::format("saw {} resyncs and {} desyncs", counts.resyncs, counts.desyncs));
        for (const auto& [verdict, count] : counts.resumes) end_.resumes[verdict] += count;
    }

    void prepare() {
        land_ = dice_.one_in(6);
        world_ = std::make_unique<SimWorld>(land_);
        draw_schedule();
        net_.plan = [this](uint64_t number, uint16_t port) { return plan(number, port); };
        // Results in many pieces, in most lives. A land block takes 3.4 kB at most, a probe's answer less than 2 kB.
        limits_.frame_to_client = dice_.one_in(3) ? 16384 : land_ ? 4096 : 2048;
        steady_ = std::make_unique<SimNode>(net_, steady, *world_, a_node());
        for (size_t i = 0; i < failing.size(); ++i) rise(i);
        view_ = first_view();
        // 40 patches are too few for the coarsest.
        const bool fine = dice_.one_in(5);
        if (fine) view_.viewport_width = 1280;
        if (fine) view_.viewport_height = 720;
        view_.accepted_error_px = fine ? 1.0F : 20.0F;
        view_.patch_budget = fine ? 512U : 40U << dice_.below(4);
        client_ = std::make_unique<SimClient>(net_, balancer, view_, regions_);
        twin_ = std::make_unique<SimClient>(net_, steady, view_, regions_);
        watch();
    }
    void draw_schedule() {
        schedule_.seed = dice_.next();
        schedule_.cuts = static_cast<uint32_t>(dice_.between(300, 900));
        schedule_.stalls = static_cast<uint32_t>(dice_.between(0, 500));
        schedule_.delays = 700;
        schedule_.within = uint64_t{1} << dice_.between(8, 15);
        schedule_.longest_stall_us = dice_.between(10'000, 9 * second);
        schedule_.longest_delay_us = dice_.between(0, 400'000);
        schedule_.always.up.jitter_us = schedule_.always.down.jitter_us = dice_.between(0, 30'000);
        // A slow line, which fills socket and window.
        if (dice_.one_in(2))
            schedule_.always.down.bytes_per_second = static_cast<uint64_t>(dice_.between(10'000, 100'000));
    }
    NodeKind a_node() {
        const int64_t look_ms = dice_.one_in(3) ? dice_.between(200, 1500) : 50;
        return {next_life_++, limits_, std::chrono::milliseconds(look_ms)};
    }

    VirtualNet::Plan plan(uint64_t number, uint16_t port) {
        if (port == steady) return {{}, steady};
        if (time_.now_us() - last_dial_us_ < least_pause_us)
            fail("the client",
                 fmt::format("tries again after {} ms", (time_.now_us() - last_dial_us_) / 1000));
        last_dial_us_ = time_.now_us();
        VirtualNet::Plan made{faults_of(schedule_, number), failing[dice_.below(2)]};
        if (calm_) made.faults = {};
        if (calm_) made.faults.up.delay_us = made.faults.down.delay_us = dice_.between(0, 200'000);
        at_node_ = made.port;
        harmless_ =
            !made.faults.up.cut && !made.faults.down.cut && !made.faults.up.stall && !made.faults.down.stall;
        move_in_handshake(made.faults);
        if (trace_) say(text_of(number, made));
        return made;
    }
    // A hello tells how the client looks; what changes until it is answered has to be told after it.
    void move_in_handshake(const ConnectionFaults& faults) {
        if (!dice_.one_in(2)) return;
        const int64_t round_trip = faults.up.delay_us + faults.down.delay_us;
        time_.at(time_.now_us() + round_trip + dice_.between(0, round_trip + 5000),
                 [this] { dice_.one_in(3) ? ask_regions() : move(dice_.one_in(2)); });
    }
    static std::string text_of(uint64_t number, const VirtualNet::Plan& made) {
        std::string text = fmt::format("connection {} to node {}", number, made.port);
        for (const auto& [name, link] :
             {std::pair("up", &made.faults.up), std::pair("down", &made.faults.down)}) {
            if (link->cut)
                text += fmt::format(", {} cut at {} by {}", name, link->cut->at,
                                    static_cast<int>(link->cut->kind));
            if (link->stall)
                text += fmt::format(", {} stalls at {} for {} ms", name, link->stall->at,
                                    link->stall->for_us / 1000);
            if (link->delay_us > 0) text += fmt::format(", {} late by {} ms", name, link->delay_us / 1000);
        }
        return text;
    }

    void happen() {
        switch (dice_.below(16)) {
            case 0:
            case 1:
            case 2: return move(dice_.one_in(3));
            case 3: return pan();
            case 4: return ask_regions();
            case 5:
            case 6:
            case 7:
            case 8: return change();
            case 9: return cut(static_cast<CutKind>(dice_.below(3)));
            case 10:
            case 11: return there_and_back();
            case 12:
            case 13: return restart(dice_.below(2));
            case 14:
                if (dice_.one_in(3)) return outage();
                if (!rotten_ && dice_.one_in(4)) return rot();
                return;
            default: return;
        }
    }
    // The twin dials second, and never again.
    static size_t twins_connection() { return 1; }
    void cut(CutKind kind) {
        say(fmt::format("all connections of the balancer are cut by {}", static_cast<int>(kind)));
        for (size_t i = 0; i < net_.wires().size(); ++i)
            if (i != twins_connection()) net_.wires()[i]->cut(kind);
        harmless_ = false;
    }

    void look(const ViewState& view) {
        view_ = view;
        say(fmt::format("the camera moves to {}, {}", view_.position.x >> 10, view_.position.z >> 10));
        client_->look(view_);
        twin_->look(view_);
    }
    void move(bool far) {
        // Far: to somewhere else, or to where the land is.
        const int64_t reach = !far ? 12 : dice_.one_in(2) ? 3000 : 250;
        ViewState view = view_;
        if (far) view.position = {};
        view.position.x += to_lattice(static_cast<double>(dice_.between(-reach, reach)));
        view.position.z += to_lattice(static_cast<double>(dice_.between(-reach, reach)));
        look(view);
    }
    void pan() {
        for (int i = 0; i < 5; ++i) {
            move(false);
            pass(dice_.between(1000, 60'000));
        }
    }
    void ask_regions() {
        regions_ = some_regions(dice_);
        say(fmt::format("{} sync regions are asked for", regions_.size()));
        client_->ask_regions(regions_);
        twin_->ask_regions(regions_);
    }
    // What is on its way when the connection is cut is not asked for any more when the next one stands.
    void there_and_back() {
        const ViewState before = view_;
        const std::vector<SyncRegion> regions = regions_;
        move(true);
        if (dice_.one_in(2)) ask_regions();
        pass(dice_.between(1000, 700'000));
        cut(static_cast<CutKind>(dice_.below(2)));
        pass(dice_.between(0, 20'000));
        look(before);
        regions_ = regions;
        client_->ask_regions(regions_);
        twin_->ask_regions(regions_);
    }
    void change() {
        SimNode* node = dice_.one_in(3) ? steady_.get() : nodes_[dice_.below(2)].get();
        if (node == nullptr) return;
        auto action = some_command(dice_, node->boxes(), land_);
        say(fmt::format("a command of kind {}", action.index()));
        node->command(std::move(action), dice_.between(0, 800'000));
    }
    void last_word() {
        StartWind wind;
        wind.trains = 3;
        wind.seed = 1 + dice_.below(1000);
        say("a last wind");
        steady_->command(wind, 0);
    }
    void rot() {
        rotten_ = client_->rot();
        if (rotten_) say("a bit turns over in what the client holds");
    }
    void rise(size_t i) {
        say(fmt::format("node {} comes up", failing[i]));
        nodes_[i] = std::make_unique<SimNode>(net_, failing[i], *world_, a_node());
    }
    void restart(size_t i) {
        if (!nodes_[i]) return rise(i);
        ++end_.restarts;
        const bool gently = dice_.one_in(2);
        say(fmt::format("node {} is {}", failing[i], gently ? "drained" : "killed"));
        if (gently) drain(i);
        note(fmt::format("node {}", failing[i]), *nodes_[i], gently);
        nodes_[i].reset();
    }
    void drain(size_t i) {
        // Live long enough to have been looked at.
        bool hears = client_->live();
        pass(60'000);
        hears = hears && harmless_ && client_->live() && at_node_ == failing[i];
        const size_t ends = client_->ends().size();
        nodes_[i]->drain();
        pass(4 * second);
        if (!hears) return;
        if (client_->ends().size() == ends)
            fail("the client", "has not heard that its server shuts down");
        else if (client_->ends()[ends].find("the server says: this server is shutting down") != 0)
            fail("the client", "takes the end of its server for: " + client_->ends()[ends]);
    }
    // Nobody listens for a while, and the client does not press on.
    void outage() {
        for (size_t i = 0; i < nodes_.size(); ++i)
            if (nodes_[i]) restart(i);
        const uint64_t before = net_.connections();
        pass(20 * second);
        if (const uint64_t dials = net_.connections() - before; dials > most_dials_in_20_s)
            fail("the client", fmt::format("has dialled {} times in 20 s", dials));
        if (dice_.one_in(2)) move(true);
        for (size_t i = 0; i < nodes_.size(); ++i) rise(i);
    }
    void calm() {
        calm_ = true;
        for (size_t i = 0; i < nodes_.size(); ++i)
            if (!nodes_[i]) rise(i);
        say("calm from here on");
        if (dice_.one_in(3)) cut(CutKind::reset);
        net_.heal_all();
    }

    void judge() {
        say("the client holds " + client_->holdings());
        fail("the client that was never cut", verdict(*twin_, *steady_, view_, regions_));
        fail("the client that was never cut", untroubled(*twin_));
        fail("the client", verdict(*client_, *steady_, view_, regions_));
        if (!rotten_) fail("the client", untroubled(*client_));
        if (twin_->connections() != 1) fail("the client that was never cut", "was cut");
        for (const auto* client : {client_.get(), twin_.get()})
            if (client->watermark_fell_us() > 0)
                fail("the client",
                     fmt::format("saw its watermark fall by {} us", client->watermark_fell_us()));
        fail("the log:", world_->broken_promise());
        for (size_t i = 0; i < nodes_.size(); ++i)
            if (nodes_[i]->world_hash() != steady_->world_hash())
                fail(fmt::format("node {}", failing[i]), "has another world than the steady one");
        end_.sessions = client_->connections();
        end_.resumed = client_->resumed();
        end_.results = client_->results();
        end_.pieces = client_->counters().pieces;
        end_.troubles = client_->counters().resyncs + client_->counters().desyncs;
        for (const auto& wire : net_.wires()) end_.cuts += wire->was_cut() ? 1U : 0U;
    }
    void leave() {
        client_->leave();
        twin_->leave();
        pass(second);
        for (const auto& node : nodes_) node->drain();
        steady_->drain();
        pass(4 * second);
        if (!client_->ended()) fail("the client", "has not ended: " + client_->sentence());
        for (size_t i = 0; i < nodes_.size(); ++i) note(fmt::format("node {}", failing[i]), *nodes_[i], true);
        note("the steady node", *steady_, true);
    }

    bool trace_;
    Dice dice_;
    VirtualTime time_;
    VirtualNet net_;
    std::unique_ptr<SimWorld> world_;
    ChaosSchedule schedule_;
    Limits limits_;
    bool land_ = false;
    bool calm_ = false;
    bool rotten_ = false;
    uint32_t next_life_ = 1;
    // Of the client's last connection.
    int64_t last_dial_us_ = 0;
    uint16_t at_node_ = 0;
    bool harmless_ = false;
    std::unique_ptr<SimNode> steady_;
    std::array<std::unique_ptr<SimNode>, 2> nodes_;
    ViewState view_;
    std::vector<SyncRegion> regions_ = first_regions();
    std::unique_ptr<SimClient> client_;
    std::unique_ptr<SimClient> twin_;
    StoryEnd end_;
};

}  // namespace

StoryEnd seeded_story(uint64_t seed, bool trace) { return Story(seed, trace).tell(); }

StoryEnd cut_story(bool up, uint64_t at, CutKind kind) {
    StoryEnd end;
    VirtualTime time;
    VirtualNet net(1);
    SimWorld world;
    SimNode node(net, steady, world, {});
    net.plan = [&](uint64_t number, uint16_t) {
        VirtualNet::Plan plan{{}, steady};
        plan.faults.up.delay_us = plan.faults.down.delay_us = 20'000;
        if (number == 0) (up ? plan.faults.up : plan.faults.down).cut = Cut{at, kind};
        return plan;
    };
    ViewState narrow = first_view();  // so that a first result is small
    narrow.tan_half_width = 0.15F;
    narrow.tan_half_height = 0.1F;
    SimClient client(net, steady, narrow, first_regions());
    // A silent server is given up after 8 s without a word, seen at the next clock request, said goodbye to for a second.
    time.run_until(time.now_us() + (kind == CutKind::silence ? 20 : 3) * second);
    end.failure = verdict(client, node, narrow, first_regions());
    if (end.failure.empty()) end.failure = untroubled(client);
    if (end.failure.empty()) end.failure = verdict(node.counts(), false);
    const bool was_cut = net.wires()[0]->was_cut().has_value();
    if (end.failure.empty() && net.connections() != (was_cut ? 2U : 1U))
        end.failure = fmt::format("it took {} connections", net.connections());
    end.first_up = net.wires()[0]->delivered(0);
    end.first_down = net.wires()[0]->delivered(1);
    end.connections = net.connections();
    end.sessions = client.connections();
    end.resumed = client.resumed();
    return end;
}

}  // namespace trochoid
