#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <thread>

#include "protocol/units/error_code.hpp"
#include "protocol/units/version.hpp"
#include "protocol/wire/requirements.hpp"
#include "tests/conformance/server/refusals.hpp"

// who may send what when, versions, order, rates and patience.
namespace trochoid::conformance::server {

namespace {

Bytes bytes_of(const ClientMessage& message) { return encode(message); }

template <class Action>
Command command(const Action& action, uint32_t sequence = 1) {
    Command asked;
    asked.sequence = sequence;
    asked.action = action;
    return asked;
}

void add_order(Catalogue& all) {
    constexpr Answer unexpected{ErrorCode::unexpected_message, requirement::hello_first};
    const std::pair<const char*, ClientMessage> others[] = {
        {"view", ViewUpdate{1, view_of_sky()}},
        {"regions", SyncRegions{1, {}}},
        {"clock", ClockRequest{1, 5}},
        {"ack", Ack{1, 0, 0, {}}},
        {"list", command(ListBoxes{})},
        {"wind", command(StartWind{})},
        {"samples", SampleRequest{1, {}, {{}}}},
        {"rays", RaysRequest{1, {1}}},
        {"probe", Probe{1, 1, {}, {{}}}},
        {"desync", Desync{.sequence = 1, .result = 1, .time = {}, .at = {}, .patch = {}, .box = {}}},
    };
    for (const auto& [name, message] : others)
        all.push_back(refused_first(fmt::format("R-121/first-{}", name),
                                    fmt::format("A first message that is no hello: {}", name),
                                    bytes_of(message), unexpected));
    all.push_back(
        refused("R-121/second-hello", "A second hello", bytes_of(ServerPeer::usual_hello()), unexpected));
    all.push_back(server_case("R-121/server-hello-first", "The server's first message is its hello",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.connect();
                                  peer.send_magic();
                                  peer.send(ServerPeer::usual_hello());
                                  const auto first = peer.receive(trial.target().patience);
                                  if (!first || !std::holds_alternative<ServerHello>(*first))
                                      throw Failed{"the first message is no hello"};
                              }));
    all.push_back(server_case("R-121/server-waits", "The server says nothing before the client's hello",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.connect();
                                  peer.send_magic();
                                  if (peer.receive(Milliseconds(300)))
                                      throw Failed{"a message came before the client's hello"};
                                  peer.send(ServerPeer::usual_hello());
                                  peer.await<ServerHello>("hello");
                              }));
    all.push_back(server_case("R-121/goodbye-first", "A goodbye instead of a hello ends the connection",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.connect();
                                  peer.send_magic();
                                  peer.send(Goodbye{.message = "changed my mind"});
                                  peer.expect_silent_end();
                              }));
    for (const ErrorCode code : {ErrorCode::none, ErrorCode::client_closed, ErrorCode::verification_failed})
        all.push_back(server_case(fmt::format("R-121/goodbye-{}", static_cast<unsigned>(code)),
                                  "The client's goodbye ends the session; the server closes",
                                  [code](ServerTrial& trial) {
                                      ServerPeer& peer = trial.log_in();
                                      peer.settle(Milliseconds(50));
                                      peer.send(Goodbye{.code = code, .message = "done"});
                                      peer.expect_silent_end();
                                  }));
    all.push_back(server_case("R-121/after-goodbye", "What follows the client's goodbye is not answered",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.log_in();
                                  peer.settle(Milliseconds(50));
                                  peer.send(Goodbye{.message = "done"});
                                  peer.send(ClockRequest{1, monotonic_us()});
                                  peer.watch([](const ServerMessage& message, int64_t) {
                                      if (std::holds_alternative<ClockReply>(message))
                                          throw Failed{"the server answered after the client's goodbye"};
                                  });
                                  peer.expect_silent_end();
                              }));
    all.push_back(server_case("R-121/end-without-goodbye", "A client that just closes is let go",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.log_in();
                                  peer.settle(Milliseconds(50));
                                  peer.stream().finish();
                                  peer.expect_silent_end();
                              }));
    all.push_back(server_case("R-121/reset", "A client that resets is let go",
                              [](ServerTrial& trial) { trial.log_in().stream().abort(); }));
    all.push_back(server_case("R-121/many-sessions",
                              "Eight sessions of one client, each with a number of its own",
                              [](ServerTrial& trial) {
                                  std::vector<uint64_t> numbers;
                                  for (int i = 0; i < 8; ++i)
                                      numbers.push_back(trial.log_in().hello().session);
                                  std::sort(numbers.begin(), numbers.end());
                                  if (std::adjacent_find(numbers.begin(), numbers.end()) != numbers.end())
                                      throw Failed{"two sessions have one number"};
                              }));
    all.back().connections = 8;
}

// ---- R-122 ----

/// Skipped where the server's patience is longer than ours.
Milliseconds hello_deadline(const Target& target) {
    const Milliseconds deadline(target.hello.limits.hello_deadline_ms);
    if (deadline > target.longest_wait)
        throw Skipped{fmt::format("the hello's deadline is {} ms: --longest-wait", deadline.count())};
    return deadline;
}

Case deadline_case(std::string id, std::string title, std::function<void(ServerPeer&)> begin) {
    Case made = server_case(std::move(id), std::move(title), [begin = std::move(begin)](ServerTrial& trial) {
        const Milliseconds deadline = hello_deadline(trial.target());
        const int64_t begun_us = monotonic_us();
        ServerPeer& peer = trial.connect();
        begin(peer);
        peer.receive(deadline + trial.target().patience);
        const Goodbye goodbye = peer.expect_goodbye(ErrorCode::hello_deadline);
        const auto took = Milliseconds((monotonic_us() - begun_us) / 1000);
        trial.note(fmt::format("closed {} ms after connecting; the deadline is {} ms", took.count(),
                               deadline.count()));
        if (took < deadline - Milliseconds(100)) throw Failed{"the server did not wait until the deadline"};
        if (took > deadline + Milliseconds(2000))
            throw Failed{"the server waited two seconds and more beyond the deadline"};
        if (!goodbye.retry) throw Failed{"the goodbye does not say that trying again can help (chapter 12)"};
    });
    made.course = Course::waiting;
    return made;
}

void add_deadlines(Catalogue& all) {
    all.push_back(deadline_case("R-122/silent", "A client that says nothing", [](ServerPeer&) {}));
    all.push_back(deadline_case("R-122/magic-only", "A client that sends the magic alone",
                                [](ServerPeer& peer) { peer.send_magic(); }));
    all.push_back(
        deadline_case("R-122/half-header", "A client that sends half a header", [](ServerPeer& peer) {
            peer.send_magic();
            peer.send_bytes(std::array<uint8_t, 4>{64, 0, 0, 0});
        }));
    all.push_back(deadline_case(
        "R-122/drip", "A client that sends its hello byte by byte, 20 a second", [](ServerPeer& peer) {
            peer.send_magic();
            const Bytes hello = frame(encode(ClientMessage{ServerPeer::usual_hello()}));
            const Deadline deadline(Milliseconds(peer.target().hello.limits.hello_deadline_ms));
            for (size_t i = 0; i + 1 < hello.size() && !deadline.passed(); ++i) {
                peer.send_bytes(std::span(hello).subspan(i, 1));
                std::this_thread::sleep_for(Milliseconds(50));
            }
        }));
    Case slow = server_case(
        "R-122/slow-hello", "A hello in three pieces within the deadline is taken", [](ServerTrial& trial) {
            const Milliseconds deadline = hello_deadline(trial.target());
            ServerPeer& peer = trial.connect();
            peer.send_magic();
            const Bytes hello = frame(encode(ClientMessage{ServerPeer::usual_hello()}));
            const size_t third = hello.size() / 3;
            for (size_t i = 0; i < 3; ++i) {
                std::this_thread::sleep_for(deadline / 5);
                peer.send_bytes(std::span(hello).subspan(i * third, i == 2 ? std::dynamic_extent : third));
            }
            peer.await<ServerHello>("hello");
        });
    slow.course = Course::waiting;
    all.push_back(std::move(slow));
}

// ---- R-141 ----

void add_versions(Catalogue& all) {
    const auto hello = [](auto change) {
        ClientHello changed = ServerPeer::usual_hello();
        change(changed);
        return encode(ClientMessage{changed});
    };
    const auto versions = [&](uint16_t least, uint16_t most) {
        return hello([=](ClientHello& h) { h.protocol_min = least, h.protocol_max = most; });
    };
    constexpr Answer version{ErrorCode::protocol_version, requirement::version_range};
    all.push_back(refused_first("R-123/too-old", "A client of version 1 alone", versions(1, 1), version));
    all.push_back(refused_first("R-123/version-0", "A client of version 0", versions(0, 0), version));
    all.push_back(refused_first("R-123/too-new", "A client of versions 60,000 and up", versions(60000, 65535),
                                version));
    all.push_back(
        refused_first("R-123/newest", "A client of version 65,535 alone", versions(65535, 65535), version));
    const auto agreed = [&](const char* id, const char* title, uint16_t least, uint16_t most) {
        all.push_back(server_case(id, title, [=](ServerTrial& trial) {
            ClientHello wide = ServerPeer::usual_hello();
            wide.protocol_min = least;
            wide.protocol_max = most;
            ServerPeer& peer = trial.log_in(wide);
            const uint16_t highest = std::min(most, trial.target().hello.protocol);
            if (peer.hello().protocol != highest)
                throw Failed{fmt::format("the server took version {}, not {}, the highest that both speak",
                                         peer.hello().protocol, highest)};
            peer.expect_service();
        }));
    };
    agreed("R-123/wide", "A client of all versions gets the highest", 0, 65535);
    agreed("R-123/from-1", "A client of versions 1 to 2 gets version 2", 1, 2);
    for (uint16_t one = protocol_version_min; one <= protocol_version_max; ++one)
        agreed(fmt::format("R-123/only-{}", one).c_str(), "A client of one version alone gets it", one, one);
    constexpr Answer model{ErrorCode::model_version, requirement::model_version};
    for (const uint16_t other :
         {uint16_t{0}, uint16_t{model_version - 1}, uint16_t{model_version + 1}, uint16_t{65535}})
        all.push_back(refused_first(fmt::format("R-141/model-{}", other),
                                    fmt::format("A client of model version {}", other),
                                    hello([=](ClientHello& h) { h.model = other; }), model));
    all.push_back(server_case("R-141/told", "The hello tells the model's version", [](ServerTrial& trial) {
        if (trial.log_in().hello().model != model_version)
            throw Failed{"the server's hello has another version of the model"};
    }));

    static constexpr Answer world{ErrorCode::wrong_world, requirement::world_name};
    const auto other_world = [&](const char* id, const char* title,
                                 const std::function<std::string(const std::string&)>& name) {
        all.push_back(server_case(id, title, [name](ServerTrial& trial) {
            ClientHello wrong = ServerPeer::usual_hello();
            wrong.world = name(trial.target().hello.world);
            ServerPeer& peer = trial.connect();
            peer.send_magic();
            peer.send(wrong);
            peer.expect_goodbye(world.code, world.requirement);
        }));
    };
    other_world("R-124/other", "Another world's name",
                [](const std::string& name) { return name + " of others"; });
    other_world("R-124/beginning", "The beginning of the world's name", [](const std::string& name) {
        return name.size() < 2 ? "?" : name.substr(0, name.size() - 1);
    });
    other_world("R-124/blank", "A blank before the world's name",
                [](const std::string& name) { return " " + name; });
    all.push_back(server_case("R-124/right", "The world's own name", [](ServerTrial& trial) {
        ClientHello named = ServerPeer::usual_hello();
        named.world = trial.target().hello.world;
        trial.log_in(named).expect_service();
    }));
    for (const uint64_t hash : {uint64_t{0}, UINT64_MAX})
        all.push_back(taken_first(fmt::format("R-124/schema-hash-{:x}", hash),
                                  "A strange schema hash is no reason to refuse",
                                  hello([=](ClientHello& h) { h.schema_hash = hash; })));
}

// ---- R-125 ----

using Numbered = std::function<ClientMessage(uint32_t sequence)>;

void add_sequences(Catalogue& all) {
    const std::pair<const char*, Numbered> kinds[] = {
        {"view",
         [](uint32_t n) {
             return ViewUpdate{n, view_of_sky()};
         }},
        {"regions",
         [](uint32_t n) {
             return SyncRegions{n, {}};
         }},
        {"clock",
         [](uint32_t n) {
             return ClockRequest{n, 1};
         }},
        {"command", [](uint32_t n) { return command(ListBoxes{}, n); }},
        {"samples",
         [](uint32_t n) {
             return SampleRequest{n, {}, {{}}};
         }},
        {"rays",
         [](uint32_t n) {
             return RaysRequest{n, {1}};
         }},
    };
    for (const auto& [name, make] : kinds) {
        const auto broken = [&all, type = name, build = make](const char* kind, const char* title,
                                                              const std::vector<uint32_t>& numbers) {
            all.push_back(
                server_case(fmt::format("R-125/{}-{}", type, kind), fmt::format("{}: {}", type, title),
                            [build, numbers](ServerTrial& trial) {
                                ServerPeer& peer = trial.log_in();
                                for (const uint32_t number : numbers) peer.send(build(number));
                                const Goodbye goodbye = peer.expect_goodbye(ErrorCode::sequence_not_monotone);
                                if (goodbye.offending_sequence != numbers.back())
                                    throw Failed{fmt::format("the goodbye names sequence {}, not {}",
                                                             goodbye.offending_sequence, numbers.back())};
                            }));
        };
        broken("repeated", "a number comes twice", {1, 2, 2});
        broken("back", "numbers go back", {5, 4});
        broken("zero", "the first number is 0", {0});
        broken("wrapped", "after 2³² - 1 comes 1", {UINT32_MAX, 1});
        all.push_back(
            server_case(fmt::format("R-125/{}-gaps", name), fmt::format("{}: gaps are allowed", name),
                        [build = make](ServerTrial& trial) {
                            ServerPeer& peer = trial.log_in();
                            for (const uint32_t number : {1U, 3U, 1000U, UINT32_MAX})
                                peer.send(build(number));
                            peer.send(Ack{});
                            peer.settle(Milliseconds(60));
                            if (peer.goodbye())
                                throw Failed{fmt::format("gaps were refused with code {}",
                                                         static_cast<unsigned>(peer.goodbye()->code))};
                        }));
    }
    all.push_back(
        server_case("R-125/types-apart", "Each type of message counts for itself", [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            peer.send(ViewUpdate{100, view_of_sky()});
            peer.send(SyncRegions{50, {}});
            peer.send(SampleRequest{7, {}, {{}}});
            peer.send(command(ListBoxes{}, 2));
            peer.send(ClockRequest{1, monotonic_us()});
            peer.await<ClockReply>("clock reply");
        }));
}

// ---- R-126, R-127 ----

void add_rates(Catalogue& all) {
    const auto flood = [&](const char* id, const char* title, Numbered make) {
        all.push_back(server_case(id, title, [make = std::move(make)](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            const uint32_t limit = peer.hello().limits.views_per_second;
            if (limit > 500) throw Skipped{fmt::format("views may come {} times a second", limit)};
            for (uint32_t i = 1; i <= 3 * limit + 3; ++i) peer.send(make(i));
            const Goodbye goodbye = peer.expect_goodbye(ErrorCode::rate_limited);
            if (!goodbye.retry)
                throw Failed{"the goodbye does not say that trying again can help (chapter 12)"};
        }));
    };
    flood("R-126/views", "Three times as many views a second as allowed", [](uint32_t n) {
        return ViewUpdate{n, view_of_sky()};
    });
    flood("R-126/regions", "Three times as many messages of regions as allowed", [](uint32_t n) {
        return SyncRegions{n, {}};
    });
    flood("R-126/views-and-regions", "Views and regions count together", [](uint32_t n) -> ClientMessage {
        if (n % 2 == 0) return SyncRegions{n, {}};
        return ViewUpdate{n, view_of_sky()};
    });
    all.push_back(server_case("R-126/messages", "20,000 acknowledgements in one go", [](ServerTrial& trial) {
        ServerPeer& peer = trial.log_in();
        peer.await_result(0);
        const Bytes again =
            frame(encode(ClientMessage{Ack{peer.held().result(), peer.held().hash(), 0, {}}}));
        Bytes many;
        for (int i = 0; i < 20000; ++i) many.insert(many.end(), again.begin(), again.end());
        peer.send_bytes(many);
        peer.expect_goodbye(ErrorCode::rate_limited);
    }));
    all.push_back(server_case(
        "R-126/views-allowed", "As many views as a second allows, at once", [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            for (uint32_t i = 1; i <= std::min(peer.hello().limits.views_per_second, 500U); ++i)
                peer.send(ViewUpdate{i, view_of_sky()});
            peer.expect_service();
        }));
    all.push_back(server_case(
        "R-126/commands", "Commands beyond the rate are refused, and the session goes on",
        [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            const uint32_t limit = peer.hello().limits.commands_per_second;
            if (limit > 100) throw Skipped{fmt::format("commands may come {} times a second", limit)};
            const uint32_t count = limit + 20;
            Bytes together;
            for (uint32_t i = 1; i <= count; ++i) {
                const Bytes framed = frame(encode(ClientMessage{command(StopWind{{1}}, i)}));
                together.insert(together.end(), framed.begin(), framed.end());
            }
            peer.send_bytes(together);
            uint32_t refusals = 0;
            for (uint32_t answered = 0; answered < count; ++answered)
                refusals += peer.await<CommandReply>("reply to a command").code == ErrorCode::rate_limited;
            trial.note(fmt::format("{} of {} commands were refused for their rate", refusals, count));
            if (refusals == 0) throw Failed{"no command was refused for its rate"};
            if (refusals > count - limit) throw Failed{"commands within the rate were refused"};
            peer.expect_service();
        }));
}

template <class Action>
Case needs_role(std::string id, std::string title, Role role, const Action& action) {
    return server_case(std::move(id), std::move(title), [=](ServerTrial& trial) {
        ServerPeer& peer = role == Role::viewer ? trial.log_in() : trial.log_in_as(role);
        if (peer.hello().role != role) throw Skipped{"the token gives another role: --sign-with"};
        const CommandReply reply = peer.ask(command(action));
        if (reply.code != ErrorCode::token_required)
            throw Failed{fmt::format("the reply has code {} ({}), not 301", static_cast<unsigned>(reply.code),
                                     reply.message)};
        if (reply.message.empty()) throw Failed{"the reply has no sentence that says what to do"};
        peer.expect_service();
    });
}

void add_roles(Catalogue& all) {
    const ChangeLand mole{{{0, 0}, {1024, 0}}, 20.0F, 3.0F, false};
    all.push_back(needs_role("R-127/viewer-wind", "A viewer starts a wind", Role::viewer, StartWind{}));
    all.push_back(needs_role("R-127/viewer-stop", "A viewer stops a wind", Role::viewer, StopWind{{1}}));
    all.push_back(needs_role("R-127/viewer-ship", "A viewer starts a ship", Role::viewer, StartShip{}));
    all.push_back(needs_role("R-127/viewer-steer", "A viewer steers", Role::viewer, Steer{{1}, 0.0F, 1.0F}));
    all.push_back(needs_role("R-127/viewer-land", "A viewer changes the land", Role::viewer, mole));
    all.push_back(
        needs_role("R-127/viewer-rate", "A viewer sets the rate of time", Role::viewer, SetRate{1U << 16}));
    all.push_back(needs_role("R-127/viewer-skip", "A viewer skips time", Role::viewer, SkipTime{1000000}));
    all.push_back(needs_role("R-151/director-rate", "A director sets the rate of time, as only admins may",
                             Role::director, SetRate{1U << 16}));
    all.push_back(needs_role("R-151/director-skip", "A director skips time, as only admins may",
                             Role::director, SkipTime{1000000}));
    all.push_back(server_case("R-127/viewer-list", "A viewer lists the boxes", [](ServerTrial& trial) {
        const BoxList list = trial.log_in().ask_boxes();
        for (size_t i = 1; i < list.boxes.size(); ++i)
            if (list.boxes[i].box <= list.boxes[i - 1].box)
                throw Failed{"the lines of the list do not ascend by box"};
    }));
    all.push_back(
        server_case("R-127/viewer-role", "Without a token the role is viewer", [](ServerTrial& trial) {
            if (trial.log_in().hello().role != Role::viewer)
                throw Failed{"a client without a token is no viewer"};
        }));
}

// ---- R-128 ----

void add_progress(Catalogue& all) {
    Case silent =
        server_case("R-128/silent", "A session that says nothing any more is closed", [](ServerTrial& trial) {
            const Milliseconds patience(trial.target().hello.limits.no_progress_ms);
            if (patience > trial.target().longest_wait)
                throw Skipped{fmt::format("the server waits {} s: --longest-wait", patience.count() / 1000)};
            ServerPeer& peer = trial.log_in();
            peer.acknowledge_by_itself(false);
            const Deadline deadline(patience + trial.target().patience);
            while (!deadline.passed() && !peer.goodbye() && peer.stream().state() == Stream::State::open)
                peer.receive(deadline.left());
            peer.expect_goodbye(ErrorCode::no_progress);
        });
    silent.course = Course::waiting;
    all.push_back(std::move(silent));
}

}  // namespace

void add_session_cases(Catalogue& all) {
    add_order(all);
    add_deadlines(all);
    add_versions(all);
    add_sequences(all);
    add_rates(all);
    add_roles(all);
    add_progress(all);
}

}  // namespace trochoid::conformance::server
