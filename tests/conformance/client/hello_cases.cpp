#include <fmt/format.h>

#include <cmath>

#include "protocol/login/login_token.hpp"
#include "protocol/units/version.hpp"
#include "tests/conformance/client/refusals.hpp"

// What a client says first.
namespace trochoid::conformance::client {

namespace {

/// A case about the client's own hello.
Case about_hello(const char* id, const char* title,
                 std::function<void(const ClientHello&, ClientTrial&)> look) {
    return client_case(id, title, [look = std::move(look)](ClientTrial& trial) {
        ClientPeer& peer = trial.accept();
        look(peer.await_hello(), trial);
    });
}

void require(bool holds, std::string sentence) {
    if (!holds) throw Failed{std::move(sentence)};
}

/// A frame was read behind the magic.
void was_framed(const ClientHello&, ClientTrial& trial) {
    if (is_web(trial.target().transport)) throw Skipped{"a WebSocket has no magic: --transport tcp or tls"};
}

/// What our hello may say to theirs.
void add_answers(Catalogue& all) {
    for (const uint16_t version : {uint16_t{2}, uint16_t{3}})
        all.push_back(client_case(fmt::format("R-123/version-{}", version),
                                  fmt::format("A session in version {}, where the client offers it", version),
                                  [version](ClientTrial& trial) {
                                      ClientPeer& peer = trial.accept();
                                      const ClientHello& hello = peer.await_hello();
                                      if (version < hello.protocol_min || version > hello.protocol_max)
                                          throw Skipped{"the client does not offer it"};
                                      peer.welcome_now([&](ServerHello& ours) { ours.protocol = version; });
                                      peer.expect_service();
                                  }));
    constexpr Due version{ErrorCode::protocol_version, requirement::version_range};
    all.push_back(hello_refused(
        "R-123/version-above", "Our hello takes a version above those offered",
        [](ServerHello hello) {
            hello.protocol = 1000;
            return encode(ServerMessage{hello});
        },
        version));
    all.push_back(hello_refused(
        "R-123/version-below", "Our hello takes a version below those offered",
        [](ServerHello hello) {
            hello.protocol = 1;
            return encode(ServerMessage{hello});
        },
        version));
    all.push_back(client_case("R-117/ServerHello-protocol-0",
                              "Our hello takes version 0, which is none: out of range, or not offered",
                              [version](ClientTrial& trial) {
                                  ClientPeer& peer = trial.accept();
                                  peer.await_hello();
                                  ServerHello hello = peer.usual_hello();
                                  hello.protocol = 0;
                                  peer.send(hello);
                                  peer.expect_goodbye(out_of_range, {version});
                              }));
    all.push_back(hello_refused("R-141/other-model", "Our hello says that we compute another sea",
                                [](ServerHello hello) {
                                    ++hello.model;
                                    return encode(ServerMessage{hello});
                                },
                                {ErrorCode::model_version, requirement::model_version}));
    all.push_back(client_case(
        "R-142/stamp-not-echoed",
        "Our hello echoes another stamp than the client's: it may be refused, or the exchange not be used",
        [](ClientTrial& trial) {
            ClientPeer& peer = trial.welcome([](ServerHello& hello) { hello.client_stamp_us += 12345; });
            peer.expect_goodbye_or_service({{ErrorCode::value_out_of_range, any_due_requirement}});
        }));
}

}  // namespace

void add_hello_cases(Catalogue& all) {
    all.push_back(about_hello("R-101/magic", "The stream opens with the magic", was_framed));
    all.push_back(client_case(
        "R-122/in-time", "The hello comes whole within 5 s of the connection", [](ClientTrial& trial) {
            ClientPeer& peer = trial.accept();
            const int64_t begin_us = monotonic_us();
            peer.await_hello();
            trial.note(fmt::format("it came after {} ms", (monotonic_us() - begin_us) / 1000));
        }));
    all.push_back(about_hello("R-124/hello-world", "The hello names our world, or none",
                              [](const ClientHello& hello, ClientTrial&) {
                                  require(hello.world.empty() || hello.world == kit_world,
                                          fmt::format("R-124: it asks for the world '{}', this one is '{}'",
                                                      hello.world, kit_world));
                              }));
    all.push_back(about_hello("R-152/hello-token", "The hello's token, where it has one, has the form of one",
                              [](const ClientHello& hello, ClientTrial& trial) {
                                  if (hello.token.empty()) return trial.note("no token");
                                  const auto token = parse_token(hello.token);
                                  require(token.has_value(), "R-152: the hello's token is none");
                              }));
    all.push_back(about_hello("R-121/hello-first",
                              "The magic, then a hello, before anything has come from us",
                              [](const ClientHello&, ClientTrial&) {}));
    all.push_back(about_hello(
        "R-123/hello-versions", "The hello names a range of versions",
        [](const ClientHello& hello, ClientTrial& trial) {
            trial.note(fmt::format("versions {} to {}", hello.protocol_min, hello.protocol_max));
            require(hello.protocol_min <= protocol_version_max && hello.protocol_max >= protocol_version_min,
                    fmt::format("R-123: none of versions {} to {} lies in the range", protocol_version_min,
                                protocol_version_max));
        }));
    all.push_back(about_hello(
        "R-141/hello-model", "The hello names the model that the client computes",
        [](const ClientHello& hello, ClientTrial&) { require(hello.model >= 1, "R-141: model 0"); }));
    all.push_back(about_hello(
        "R-117/hello-view", "The hello's view is finite, within its ranges and not turned out of shape",
        [](const ClientHello& hello, ClientTrial&) {
            // The decoder has judged each field.
            require(std::isfinite(hello.view.tan_half_width), "R-116: the view is not finite");
        }));
    all.push_back(about_hello("R-131/hello-regions", "The hello names 32 regions at most, each within 2 km",
                              [](const ClientHello& hello, ClientTrial& trial) {
                                  trial.note(fmt::format("{} regions", hello.regions.size()));
                                  require(hello.regions.size() <= Limits{}.sync_regions,
                                          "R-131: too many regions");
                              }));
    all.push_back(about_hello(
        "R-157/hello-nothing-to-resume", "The first hello of a program has nothing to go on with",
        [](const ClientHello& hello, ClientTrial&) {
            require(!hello.resume, "there is resume data, but there was no session");
            require(hello.last_code == ErrorCode::none, "there is the code of a session that was not");
        }));
    all.push_back(client_case("R-121/silent-before-hello",
                              "Before our hello a client sends its own and nothing else",
                              [](ClientTrial& trial) {
                                  ClientPeer& peer = trial.accept();
                                  peer.await_hello();
                                  constexpr Milliseconds span{400};
                                  if (peer.receive(span))
                                      throw Failed{"R-121: a message follows the hello before ours has come"};
                                  peer.welcome_now();
                                  peer.expect_service();
                              }));
    add_answers(all);
}

}  // namespace trochoid::conformance::client
