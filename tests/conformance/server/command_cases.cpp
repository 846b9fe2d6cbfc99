#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "tests/conformance/server/refusals.hpp"

// R-143 and the commands of chapter 7, each at a place of its own far from the scene.
namespace trochoid::conformance::server {

namespace {

/// Open water where no other case is: 100 km from place to place.
LatticePoint remote(int64_t number) {
    constexpr int64_t step = 100'000 * lattice_per_metre;
    return {-(world_bound / 2) + number * step, world_bound / 2};
}

template <class Action>
Command command(const Action& action, SeaTime at = {}, bool refuse_if_late = false) {
    Command asked;
    asked.at = at;
    asked.refuse_if_late = refuse_if_late;
    asked.action = action;
    return asked;
}

StartWind wind_at(int64_t number) {
    StartWind wind;
    wind.origin = remote(number);
    wind.fetch = 20'000 * lattice_per_metre;
    wind.width = 10'000 * lattice_per_metre;
    wind.trains = 8;
    wind.seed = 7;
    return wind;
}

CommandReply succeed(ServerPeer& peer, const Command& asked) {
    CommandReply reply = peer.ask(asked);
    if (reply.code != ErrorCode::none)
        throw Failed{fmt::format("the command was refused with code {} ({})",
                                 static_cast<unsigned>(reply.code), reply.message)};
    return reply;
}

void refuse(ServerPeer& peer, const Command& asked, ErrorCode code) {
    const CommandReply reply = peer.ask(asked);
    if (reply.code != code)
        throw Failed{fmt::format("the reply has code {} ({}), not {}", static_cast<unsigned>(reply.code),
                                 reply.message, static_cast<unsigned>(code))};
    if (reply.message.empty()) throw Failed{"the refusal has no sentence that says what to do"};
    peer.expect_service();
}

/// A director's session, its clock known; Skipped where time stands still.
ServerPeer& direct(ServerTrial& trial, ClientHello hello = ServerPeer::usual_hello()) {
    return trial.log_in_as(Role::director, hello);
}

int64_t lead_us(const ServerPeer& peer, const SeaClock& clock) {
    return int64_t{peer.target().hello.limits.command_lead_ms} * 1000 * int64_t{clock.rate_q16} / 65536;
}

void add_effect(Catalogue& all) {
    all.push_back(
        server_case("R-143/as-soon-as-possible",
                    "A command for the past takes hold a lead after its coming, and is told before",
                    [](ServerTrial& trial) {
                        ServerPeer& peer = direct(trial);
                        const ClockReply before = peer.ask_clock();
                        const CommandReply reply = succeed(peer, command(wind_at(0)));
                        const ClockReply after = peer.ask_clock();
                        const SeaTime came = sea_time_at(before.clock, before.server_sent_us);
                        trial.note(fmt::format("effective {} us of sea time after the last clock reply",
                                               reply.effective - came));
                        if (before.clock.epoch == after.clock.epoch) {
                            if (reply.effective < came + lead_us(peer, before.clock))
                                throw Failed{"it takes hold earlier than the lead after its coming"};
                            if (before.clock.rate_q16 > 0 &&
                                reply.effective < sea_time_at(before.clock, after.server_received_us))
                                throw Failed{"it took hold before it was told"};
                        }
                        if (reply.effective < before.watermark)
                            throw Failed{"R-144: it takes hold before a watermark told before"};
                        succeed(peer, command(StopWind{reply.box}));
                    }));
    all.push_back(server_case("R-143/asked-time", "A command for later takes hold then, to the microsecond",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = direct(trial);
                                  const ClockReply clock = peer.ask_clock();
                                  const SeaTime asked = sea_time_at(clock.clock, clock.server_sent_us) +
                                                        20 * microseconds_per_second;
                                  for (const bool refuse_if_late : {false, true}) {
                                      const CommandReply reply =
                                          succeed(peer, command(wind_at(1), asked, refuse_if_late));
                                      if (reply.effective != asked)
                                          throw Failed{fmt::format("it takes hold at {} us, asked was {} us",
                                                                   reply.effective.us, asked.us)};
                                      succeed(peer, command(StopWind{reply.box}));
                                  }
                              }));
    all.push_back(server_case(
        "R-143/refuse-if-late", "A command that must not be late is refused where it would be",
        [](ServerTrial& trial) {
            ServerPeer& peer = direct(trial);
            const ClockReply clock = peer.ask_clock();
            refuse(peer, command(wind_at(2), sea_time_at(clock.clock, clock.server_sent_us), true),
                   ErrorCode::too_late);
            refuse(peer, command(wind_at(2), {0}, true), ErrorCode::too_late);
        }));
    all.push_back(server_case("R-143/log",
                              "A command's reply names the log position after it, and all are told it",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = direct(trial);
                                  ServerPeer& other = trial.log_in();
                                  const ClockReply before = peer.ask_clock();
                                  const CommandReply reply = succeed(peer, command(wind_at(3)));
                                  const ClockReply after = peer.ask_clock();
                                  if (reply.log_position <= before.log_position)
                                      throw Failed{"the log did not grow"};
                                  if (after.log_position < reply.log_position)
                                      throw Failed{"a later clock reply has an earlier log position"};
                                  if (after.log_hash == before.log_hash)
                                      throw Failed{"R-144: the log's hash stayed although the log grew"};
                                  if (other.ask_clock().log_position < reply.log_position)
                                      throw Failed{"another session is told an earlier log position"};
                                  succeed(peer, command(StopWind{reply.box}));
                              }));
    all.back().connections = 2;
    all.push_back(server_case(
        "R-143/watermark", "What is told later takes hold after the watermarks told before, to whomever",
        [](ServerTrial& trial) {
            ServerPeer& other = trial.log_in();
            ServerPeer& peer = direct(trial);
            for (int i = 0; i < 5; ++i) {
                const ClockReply told = other.ask_clock();
                const CommandReply reply = succeed(peer, command(wind_at(4)));
                const CommandReply stop = succeed(peer, command(StopWind{reply.box}));
                if (reply.effective < told.watermark || stop.effective < told.watermark)
                    throw Failed{"R-144: an effect lies before a watermark told before"};
            }
        }));
    all.back().connections = 2;
    all.push_back(
        server_case("R-143/never-before", "A new wind changes no water before its time, and does afterwards",
                    [](ServerTrial& trial) {
                        ClientHello hello = ServerPeer::usual_hello();
                        hello.regions = {{remote(5), 300 * 1024}};
                        ServerPeer& peer = direct(trial, hello);
                        peer.await_result(0);
                        StartWind wind = wind_at(5);
                        wind.origin.z += 5'000 * lattice_per_metre;
                        std::vector<LatticePoint> points;
                        for (int64_t i = 0; i < 60; ++i)
                            points.push_back({remote(5).x + i * 3000, remote(5).z + i * 1000});
                        const ClockReply clock = peer.ask_clock();
                        const SeaTime soon =
                            sea_time_at(clock.clock, clock.server_sent_us) + lead_us(peer, clock.clock) / 2;
                        const SampleReply before = peer.ask_samples(soon, points);
                        const CommandReply reply = succeed(peer, command(wind));
                        const SampleReply after = peer.ask_samples(soon, points);
                        if (before.samples != after.samples)
                            throw Failed{"the water before its time is another than before the command"};
                        if (reply.effective <= soon) throw Failed{"it takes hold at once"};
                        succeed(peer, command(StopWind{reply.box}));
                    }));
}

void add_winds(Catalogue& all) {
    all.push_back(server_case(
        "R-143/wind-in-results", "A new wind comes to whoever has a region in it, before its time",
        [](ServerTrial& trial) {
            ServerPeer& director = direct(trial);
            ClientHello hello = ServerPeer::usual_hello();
            hello.regions = {{remote(10), 1024 * 1024}};
            ServerPeer& peer = trial.log_in(hello);
            peer.await_result(0);
            StartWind wind = wind_at(10);
            wind.life_us = 60 * microseconds_per_second;
            const CommandReply reply = succeed(director, command(wind));
            const Deadline deadline(trial.target().patience);
            while (!peer.held().state().boxes.contains(reply.box) && !deadline.passed())
                peer.receive(deadline.left());
            if (!peer.held().state().boxes.contains(reply.box))
                throw Failed{"no result with the new box came"};
            const WaveTrainBox& box = *peer.held().state().boxes.at(reply.box);
            if (box.begin != reply.effective)
                throw Failed{"the box begins at another time than the reply says"};
            if (box.trains.size() != wind.trains)
                throw Failed{fmt::format("the box has {} trains, not {}", box.trains.size(), wind.trains)};
            const CommandReply stop = succeed(director, command(StopWind{reply.box}));
            while (peer.held().state().boxes.contains(reply.box) &&
                   peer.held().state().boxes.at(reply.box)->end != stop.effective && !deadline.passed())
                peer.receive(deadline.left());
            if (peer.held().state().boxes.contains(reply.box) &&
                peer.held().state().boxes.at(reply.box)->end != stop.effective)
                throw Failed{"the box does not end when the reply to the stop says"};
        }));
    all.back().connections = 2;
    all.push_back(
        server_case("R-143/listed", "A new wind is listed, with what was asked for", [](ServerTrial& trial) {
            ServerPeer& peer = direct(trial);
            const CommandReply reply = succeed(peer, command(wind_at(11)));
            const BoxList list = peer.ask_boxes();
            const auto found = std::find_if(list.boxes.begin(), list.boxes.end(),
                                            [&](const BoxSummary& line) { return line.box == reply.box; });
            if (found == list.boxes.end()) throw Failed{"the new box is not in the list"};
            if (found->trains != 8 || found->kind != BoxKind::wind || found->begin != reply.effective)
                throw Failed{"its line has other figures than the command"};
            succeed(peer, command(StopWind{reply.box}));
        }));
    all.push_back(server_case(
        "R-143/ids-not-reused", "Boxes one after the other get ids that ascend", [](ServerTrial& trial) {
            ServerPeer& peer = direct(trial);
            BoxId before;
            for (int i = 0; i < 3; ++i) {
                const CommandReply reply = succeed(peer, command(wind_at(12)));
                if (reply.box <= before)
                    throw Failed{
                        fmt::format("R-129: box {} was made after box {}", reply.box.value, before.value)};
                before = reply.box;
                succeed(peer, command(StopWind{reply.box}));
            }
        }));
    all.push_back(
        server_case("R-143/stop-unknown", "Stopping a box that there is not", [](ServerTrial& trial) {
            ServerPeer& peer = direct(trial);
            refuse(peer, command(StopWind{{UINT32_MAX}}), ErrorCode::unknown_box);
            refuse(peer, command(StopWind{{0}}), ErrorCode::unknown_box);
        }));
    all.push_back(
        server_case("R-143/stop-twice", "Stopping a box that is ending already", [](ServerTrial& trial) {
            ServerPeer& peer = direct(trial);
            const CommandReply reply = succeed(peer, command(wind_at(13)));
            succeed(peer, command(StopWind{reply.box}));
            refuse(peer, command(StopWind{reply.box}), ErrorCode::already_ending);
        }));
    all.push_back(
        server_case("R-143/steer-standing", "Steering a wind that does not move", [](ServerTrial& trial) {
            ServerPeer& peer = direct(trial);
            const CommandReply reply = succeed(peer, command(wind_at(14)));
            refuse(peer, command(Steer{reply.box, 90.0F, 5.0F}), ErrorCode::not_moving);
            refuse(peer, command(Steer{{UINT32_MAX}, 90.0F, 5.0F}), ErrorCode::unknown_box);
            succeed(peer, command(StopWind{reply.box}));
        }));
    all.push_back(server_case(
        "R-143/steer-moving", "A wind that moves takes new legs, under the same id", [](ServerTrial& trial) {
            ClientHello hello = ServerPeer::usual_hello();
            hello.regions = {{remote(15), 1024 * 1024}};
            ServerPeer& peer = direct(trial, hello);
            StartWind storm = wind_at(15);
            storm.vx = 10.0F;
            const CommandReply reply = succeed(peer, command(storm));
            const CommandReply turn = succeed(peer, command(Steer{reply.box, 180.0F, 20.0F}));
            const Deadline deadline(trial.target().patience);
            const auto turned = [&] {
                const auto found = peer.held().state().boxes.find(reply.box);
                if (found == peer.held().state().boxes.end()) return false;
                const std::vector<CourseLeg>& course = found->second->course;
                return std::any_of(course.begin(), course.end(),
                                   [&](const CourseLeg& leg) { return leg.from == turn.effective; });
            };
            while (!turned() && !deadline.passed()) peer.receive(deadline.left());
            if (!turned()) throw Failed{"no result with a leg that begins when the reply says came"};
            succeed(peer, command(StopWind{reply.box}));
        }));
    all.push_back(
        server_case("R-143/too-many-legs", "A course of 64 legs takes no more", [](ServerTrial& trial) {
            ServerPeer& peer = direct(trial);
            StartWind storm = wind_at(16);
            storm.vx = 10.0F;
            const CommandReply reply = succeed(peer, command(storm));
            const uint32_t rate = std::max(1U, peer.hello().limits.commands_per_second);
            CommandReply last;
            int legs = 1;
            for (int i = 0; i < 400 && legs <= 65; ++i) {
                last = peer.ask(command(Steer{reply.box, static_cast<float>(i % 360), 10.0F}));
                if (last.code == ErrorCode::rate_limited)
                    std::this_thread::sleep_for(Milliseconds(2000 / rate));
                else if (last.code == ErrorCode::none)
                    ++legs;
                else
                    break;
            }
            trial.note(fmt::format("{} legs were taken", legs));
            if (last.code != ErrorCode::too_many_legs)
                throw Failed{fmt::format("after {} legs the reply has code {}, not 409", legs,
                                         static_cast<unsigned>(last.code))};
            if (legs != 64) throw Failed{fmt::format("{} legs were taken, not 64", legs)};
            std::this_thread::sleep_for(Milliseconds(2000 / rate));
            peer.ask(command(StopWind{reply.box}));
        }));
    all.back().course = Course::waiting;
}

void add_ships(Catalogue& all) {
    const auto ship_at = [](int64_t number) {
        StartShip ship;
        ship.at = remote(number);
        ship.name = fmt::format("MS Seam {}", number);
        return ship;
    };
    all.push_back(server_case(
        "R-143/ship", "A ship sails, is listed by her name, and is taken out", [=](ServerTrial& trial) {
            ServerPeer& peer = direct(trial);
            const CommandReply reply = succeed(peer, command(ship_at(20)));
            const BoxList list = peer.ask_boxes();
            const auto found = std::find_if(list.boxes.begin(), list.boxes.end(),
                                            [&](const BoxSummary& line) { return line.box == reply.box; });
            if (found == list.boxes.end() || found->name != "MS Seam 20" || found->kind != BoxKind::ship)
                throw Failed{"she is not listed by her name as a ship"};
            succeed(peer, command(StopWind{reply.box}));
            refuse(peer, command(StopWind{reply.box}), ErrorCode::already_ending);
        }));
    all.push_back(
        server_case("R-143/ship-steered", "A ship's new course is a new box, which the reply names",
                    [=](ServerTrial& trial) {
                        ServerPeer& peer = direct(trial);
                        const CommandReply reply = succeed(peer, command(ship_at(21)));
                        const CommandReply turn = succeed(peer, command(Steer{reply.box, 90.0F, 8.0F}));
                        if (turn.box == reply.box || turn.box == BoxId{})
                            throw Failed{"the reply names no new box"};
                        succeed(peer, command(StopWind{turn.box}));
                    }));
    all.push_back(
        server_case("R-143/ship-lies-still",
                    "A ship at speed 0 lies still; then she may sail on, but not lie still again",
                    [=](ServerTrial& trial) {
                        ServerPeer& peer = direct(trial);
                        const CommandReply reply = succeed(peer, command(ship_at(22)));
                        const CommandReply still = succeed(peer, command(Steer{reply.box, 0.0F, 0.0F}));
                        refuse(peer, command(Steer{still.box, 0.0F, 0.0F}), ErrorCode::not_moving);
                        const CommandReply on = succeed(peer, command(Steer{still.box, 45.0F, 5.0F}));
                        succeed(peer, command(StopWind{on.box}));
                    }));
    all.push_back(server_case(
        "R-143/ship-too-fast", "A ship above 30 m/s is refused in the reply", [=](ServerTrial& trial) {
            ServerPeer& peer = direct(trial);
            const CommandReply reply = succeed(peer, command(ship_at(23)));
            refuse(peer, command(Steer{reply.box, 0.0F, 31.0F}), ErrorCode::value_out_of_range);
            succeed(peer, command(StopWind{reply.box}));
        }));
}

void add_land(Catalogue& all) {
    const auto mole_at = [](LatticePoint at) {
        return ChangeLand{{at, {at.x + 30 * 1024, at.z}}, 10.0F, 2.0F, false};
    };
    all.push_back(server_case("R-143/land-without-terrain", "Changing the land of a world without terrain",
                              [=](ServerTrial& trial) {
                                  if (trial.target().hello.terrain.columns > 0)
                                      throw Skipped{"the scene has terrain"};
                                  refuse(direct(trial), command(mole_at({0, 0})), ErrorCode::no_terrain);
                              }));
    all.push_back(server_case(
        "R-143/land-far-ahead", "A change of the land more than a minute ahead", [=](ServerTrial& trial) {
            if (trial.target().hello.terrain.columns == 0) throw Skipped{"the scene has no terrain"};
            ServerPeer& peer = direct(trial);
            const ClockReply clock = peer.ask_clock();
            const SeaTime later =
                sea_time_at(clock.clock, clock.server_sent_us) + 3600 * microseconds_per_second;
            refuse(peer, command(mole_at(trial.target().place), later), ErrorCode::value_out_of_range);
        }));
    all.push_back(
        server_case("R-143/questions", "Rays of a box that there is not, and of all that there are",
                    [](ServerTrial& trial) {
                        ServerPeer& peer = trial.log_in();
                        peer.send(RaysRequest{peer.next_sequence(), {UINT32_MAX}});
                        if (peer.await<CommandReply>("reply").code != ErrorCode::unknown_box)
                            throw Failed{"rays of an unknown box are not refused with 602"};
                        for (size_t i = 0; i < std::min<size_t>(4, trial.target().boxes.size()); ++i) {
                            const uint32_t number = peer.next_sequence();
                            peer.send(RaysRequest{number, trial.target().boxes[i].box});
                            for (bool last = false; !last;) {
                                const auto piece = peer.await<RaysReply>(
                                    "rays", [&](const RaysReply& r) { return r.sequence == number; });
                                if (piece.box != trial.target().boxes[i].box)
                                    throw Failed{"the reply is about another box"};
                                last = piece.last;
                            }
                        }
                    }));
}

// ---- alone: they change the clock that all see ----

void add_clock(Catalogue& all) {
    all.push_back(server_case(
        "R-143/rate", "A new rate is a new epoch; sea time goes on from where it is", [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in_as(Role::admin);
            const ClockReply before = peer.ask_clock();
            const uint32_t other_rate = before.clock.rate_q16 == 2U << 16 ? 1U << 16 : 2U << 16;
            const auto settle_at = [&](uint32_t rate) {
                succeed(peer, command(SetRate{rate}));
                const Deadline deadline(trial.target().patience);
                ClockReply now = peer.ask_clock();
                while (now.clock.rate_q16 != rate && !deadline.passed()) {
                    std::this_thread::sleep_for(Milliseconds(50));
                    now = peer.ask_clock();
                }
                if (now.clock.rate_q16 != rate) throw Failed{"the new rate does not take hold"};
                return now;
            };
            const ClockReply faster = settle_at(other_rate);
            if (faster.clock.epoch <= before.clock.epoch)
                throw Failed{"R-142: the new rate has no new epoch"};
            if (sea_time_at(faster.clock, faster.server_sent_us) <
                sea_time_at(before.clock, before.server_sent_us))
                throw Failed{"R-142: sea time stepped back"};
            const ClockReply again = settle_at(before.clock.rate_q16);
            if (sea_time_at(again.clock, again.server_sent_us) <
                sea_time_at(faster.clock, faster.server_sent_us))
                throw Failed{"R-142: sea time stepped back"};
        }));
    all.push_back(server_case("R-143/skip", "Skipped time is a new epoch, later by what was asked at least",
                              [](ServerTrial& trial) {
                                  constexpr int64_t forward = 3600 * microseconds_per_second;
                                  ServerPeer& peer = trial.log_in_as(Role::admin);
                                  const ClockReply before = peer.ask_clock();
                                  succeed(peer, command(SkipTime{forward}));
                                  const Deadline deadline(trial.target().patience);
                                  ClockReply after = peer.ask_clock();
                                  while (after.clock.epoch == before.clock.epoch && !deadline.passed()) {
                                      std::this_thread::sleep_for(Milliseconds(50));
                                      after = peer.ask_clock();
                                  }
                                  if (after.clock.epoch <= before.clock.epoch)
                                      throw Failed{"R-142: skipped time has no new epoch"};
                                  if (sea_time_at(after.clock, after.server_sent_us) <
                                      sea_time_at(before.clock, before.server_sent_us) + forward)
                                      throw Failed{"sea time went on by less than was asked"};
                                  if (after.clock.rate_q16 != before.clock.rate_q16)
                                      throw Failed{"skipping time changed its rate"};
                              }));
    for (size_t i = all.size() - 2; i < all.size(); ++i) all[i].course = Course::alone;
}

}  // namespace

void add_command_cases(Catalogue& all) {
    add_effect(all);
    add_winds(all);
    add_ships(all);
    add_land(all);
    add_clock(all);
}

}  // namespace trochoid::conformance::server
