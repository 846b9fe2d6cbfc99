#include "tests/simulation/story.hpp"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "protocol/units/hash.hpp"
#include "tests/simulation/sim_client.hpp"
#include "tests/simulation/sim_node.hpp"
#include "tests/simulation/virtual_time.hpp"

namespace trochoid {

namespace {

constexpr int64_t second = 1'000'000;
// Ports: the balancer in front of the nodes that fail, and the node that never does.
constexpr uint16_t balancer = 1;
constexpr std::array<uint16_t, 2> failing{11, 12};
constexpr uint16_t steady = 20;
// A client that has lost its server without being told needs 10 s to see it, and waits 12.5 s at most before it tries again.
constexpr int64_t calm_us = 32 * second;
constexpr int64_t last_word_us = 6 * second;

class Dice {
public:
    explicit Dice(uint64_t seed) : state_(splitmix64(seed)) {}
    uint64_t next() { return state_ = splitmix64(state_); }
    uint64_t below(uint64_t end) { return next() % end; }
    int64_t between(int64_t least, int64_t most) {
        return least + static_cast<int64_t>(below(static_cast<uint64_t>(most - least + 1)));
    }

private:
    uint64_t state_;
};

const std::vector<SyncRegion>& the_regions() {
    static const std::vector<SyncRegion> regions{
        {{to_lattice(20), to_lattice(-40)}, static_cast<uint32_t>(to_lattice(60))}};
    return regions;
}

ViewState first_view() {
    ViewState view;
    view.altitude = 15 * lattice_per_metre;
    view.accepted_error_px = 20.0F;
    view.patch_budget = 320;
    view.viewport_width = 320;
    view.viewport_height = 180;
    return view;
}

std::vector<LatticePoint> points_in_region() {
    std::vector<LatticePoint> points;
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j) points.push_back({to_lattice(20 + 25 * i), to_lattice(-40 + 25 * j)});
    return points;
}

/// Whether the client holds what the node's sea is for it; else what is wrong.
std::string verdict(const SimClient& client, const SimNode& node, const ViewState& view) {
    if (!client.live()) return "is not connected: " + client.sentence();
    if (client.state() != node.state_of(client.key())) return "holds another state than its key stands for";
    if (!node.serves(client.key(), view))
        return "has a key that is not for its view, the time or the sea of now";
    if (client.regions() != the_regions()) return "has other sync regions than it asked for";
    const auto points = points_in_region();
    for (const int64_t later : {-second, int64_t{0}, 5 * second})
        if (client.samples(node.now() + later, points) != node.samples(node.now() + later, points))
            return fmt::format("computes another sea at now {:+} us", later);
    if (client.clock_error_us(node.now()) > client.clock_bound_us())
        return fmt::format("is wrong about sea time by {} us, more than the bound of {} us that it states",
                           client.clock_error_us(node.now()), client.clock_bound_us());
    if (client.resyncs() != 0)
        return fmt::format("had to start again {} times after a wrong hash", client.resyncs());
    return {};
}

std::string verdict(const SimCounts& counts, bool at_end) {
    if (counts.ended_without_code != 0)
        return fmt::format("{} sessions ended without a code", counts.ended_without_code);
    if (counts.resyncs != 0) return fmt::format("{} resyncs", counts.resyncs);
    if (counts.started > counts.connections) return "more sessions than connections";
    if (counts.ended + counts.open < counts.connections)
        return fmt::format("{} connections, but {} ended and {} are open", counts.connections, counts.ended,
                           counts.open);
    if (at_end && counts.open != 0)
        return fmt::format("{} sessions are open after all have left", counts.open);
    return {};
}

/// One life; its members go from the last to the first.
class Story {
public:
    Story(uint64_t seed, bool trace) : trace_(trace), dice_(seed), net_(seed) {}

    StoryEnd tell() {
        prepare();
        const int64_t until = time_.now_us() + dice_.between(8 * second, 20 * second);
        while (end_.failure.empty() && time_.now_us() < until) {
            time_.run_until(time_.now_us() + dice_.between(1000, 1'500'000));
            happen();
        }
        calm();
        time_.run_until(time_.now_us() + calm_us);
        // A last word, so that nobody is right by having heard nothing.
        if (dice_.below(2) == 0) move(true);
        say(fmt::format("last change of the sea: {}", steady_->change_sea(dice_.next())));
        time_.run_until(time_.now_us() + last_word_us);
        judge();
        leave();
        end_.connections = net_.connections();
        end_.events = world_.events();
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

    void note(const std::string& who, const SimNode& node, bool at_end) {
        const SimCounts counts = node.counts();
        fail(who, verdict(counts, at_end));
        for (const auto& [verdict, count] : counts.resumes) end_.resumes[verdict] += count;
    }

    void prepare() {
        schedule_.seed = dice_.next();
        schedule_.cuts = static_cast<uint32_t>(dice_.between(300, 900));
        schedule_.stalls = static_cast<uint32_t>(dice_.between(0, 500));
        schedule_.delays = 700;
        schedule_.within = uint64_t{1} << dice_.between(8, 15);
        schedule_.longest_stall_us = dice_.between(10'000, 9 * second);
        schedule_.longest_delay_us = dice_.between(0, 400'000);
        schedule_.always.up.jitter_us = schedule_.always.down.jitter_us = dice_.between(0, 30'000);
        net_.plan = [this](uint64_t number, uint16_t port) { return plan(number, port); };
        steady_ = std::make_unique<SimNode>(net_, steady, world_, next_life_++);
        for (size_t i = 0; i < failing.size(); ++i) rise(i);
        view_ = first_view();
        // Results of several pieces, which a cut may part; else few patches, and 40 are too few for the coarsest.
        const bool fine = dice_.below(4) == 0;
        if (fine) view_.viewport_width = 1280;
        if (fine) view_.viewport_height = 720;
        view_.accepted_error_px = fine ? 1.0F : 20.0F;
        view_.patch_budget = fine ? 512U : 40U << dice_.below(4);
        client_ = std::make_unique<SimClient>(net_, balancer, view_, the_regions());
        twin_ = std::make_unique<SimClient>(net_, steady, view_, the_regions());
    }

    VirtualNet::Plan plan(uint64_t number, uint16_t port) {
        if (port == steady) return {{}, steady};
        VirtualNet::Plan made{calm_ ? ConnectionFaults{} : faults_of(schedule_, number),
                              failing[dice_.below(2)]};
        if (trace_) {
            std::string text = fmt::format("connection {} to node {}", number, made.port);
            for (const auto& [name, link] :
                 {std::pair("up", &made.faults.up), std::pair("down", &made.faults.down)}) {
                if (link->cut)
                    text += fmt::format(", {} cut at {} by {}", name, link->cut->at,
                                        static_cast<int>(link->cut->kind));
                if (link->stall)
                    text += fmt::format(", {} stalls at {} for {} ms", name, link->stall->at,
                                        link->stall->for_us / 1000);
                if (link->delay_us > 0)
                    text += fmt::format(", {} late by {} ms", name, link->delay_us / 1000);
            }
            say(text);
        }
        return made;
    }

    void happen() {
        switch (dice_.below(10)) {
            case 0:
            case 1:
            case 2: return move(dice_.below(3) == 0);
            case 3:
            case 4: return change();
            case 5: {
                const auto kind = static_cast<CutKind>(dice_.below(3));
                say(fmt::format("all connections of the balancer are cut by {}", static_cast<int>(kind)));
                for (size_t i = 0; i < net_.wires().size(); ++i)
                    if (i != twins_connection()) net_.wires()[i]->cut(kind);
                return;
            }
            case 6:
            case 7: return restart(dice_.below(2));
            default: return;
        }
    }
    // The twin dials second, and never again.
    static size_t twins_connection() { return 1; }

    void move(bool far) {
        const int64_t reach = far ? 3000 : 12;
        view_.position.x += to_lattice(static_cast<double>(dice_.between(-reach, reach)));
        view_.position.z += to_lattice(static_cast<double>(dice_.between(-reach, reach)));
        say(fmt::format("the camera moves to {}, {}", view_.position.x >> 10, view_.position.z >> 10));
        client_->look(view_);
        twin_->look(view_);
    }
    void change() {
        const uint64_t dice = dice_.next();
        SimNode* node = dice_.below(3) == 0 ? steady_.get() : nodes_[dice_.below(2)].get();
        if (node != nullptr) say(fmt::format("the sea changes: {}", node->change_sea(dice)));
    }
    void rise(size_t i) {
        say(fmt::format("node {} comes up", failing[i]));
        nodes_[i] = std::make_unique<SimNode>(net_, failing[i], world_, next_life_++);
    }
    void restart(size_t i) {
        if (!nodes_[i]) return rise(i);
        ++end_.restarts;
        const bool gently = dice_.below(2) == 0;
        say(fmt::format("node {} is {}", failing[i], gently ? "drained" : "killed"));
        if (gently) {
            nodes_[i]->drain();
            time_.run_until(time_.now_us() + 4 * second);
        }
        note(fmt::format("node {}", failing[i]), *nodes_[i], gently);
        nodes_[i].reset();
    }
    void calm() {
        calm_ = true;
        for (size_t i = 0; i < nodes_.size(); ++i)
            if (!nodes_[i]) rise(i);
        say("calm from here on");
        net_.heal_all();
    }

    void judge() {
        fail("the client that was never cut", verdict(*twin_, *steady_, view_));
        fail("the client", verdict(*client_, *steady_, view_));
        if (twin_->connections() != 1) fail("the client that was never cut", "was cut");
        end_.sessions = client_->connections();
        end_.resumed = client_->resumed();
        end_.results = client_->results();
        for (const auto& wire : net_.wires()) end_.cuts += wire->was_cut() ? 1U : 0U;
    }
    void leave() {
        client_->leave();
        twin_->leave();
        time_.run_until(time_.now_us() + second);
        for (const auto& node : nodes_) node->drain();
        steady_->drain();
        time_.run_until(time_.now_us() + 4 * second);
        if (!client_->ended()) fail("the client", "has not ended: " + client_->sentence());
        for (size_t i = 0; i < nodes_.size(); ++i) note(fmt::format("node {}", failing[i]), *nodes_[i], true);
        note("the steady node", *steady_, true);
    }

    bool trace_;
    Dice dice_;
    VirtualTime time_;
    VirtualNet net_;
    SimWorld world_;
    ChaosSchedule schedule_;
    bool calm_ = false;
    uint32_t next_life_ = 1;
    std::unique_ptr<SimNode> steady_;
    std::array<std::unique_ptr<SimNode>, 2> nodes_;
    ViewState view_;
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
    SimNode node(net, steady, world, 1);
    net.plan = [&](uint64_t number, uint16_t) {
        VirtualNet::Plan plan{{}, steady};
        plan.faults.up.delay_us = plan.faults.down.delay_us = 20'000;
        if (number == 0) (up ? plan.faults.up : plan.faults.down).cut = Cut{at, kind};
        return plan;
    };
    ViewState narrow = first_view();  // so that a first result is small
    narrow.tan_half_width = 0.15F;
    narrow.tan_half_height = 0.1F;
    SimClient client(net, steady, narrow, the_regions());
    // A silent server is given up after 8 s without a word, seen at the next clock request, said goodbye to for a second.
    time.run_until(time.now_us() + (kind == CutKind::silence ? 20 : 3) * second);
    end.failure = verdict(client, node, narrow);
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
