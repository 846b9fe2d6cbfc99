#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "server/net/http_request.hpp"
#include "server/net/metrics_text.hpp"
#include "tests/unit/server_net/door_fixture.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;

/// A strict reader of Prometheus' text format 0.0.4: samples by name and labels; adds a failure for whatever is odd.
std::map<std::string, double> read_metrics(const std::string& text) {
    static const std::regex help_line(R"(# HELP ([a-zA-Z_:][a-zA-Z0-9_:]*) [^\n]+)");
    static const std::regex type_line(R"(# TYPE ([a-zA-Z_:][a-zA-Z0-9_:]*) (counter|gauge))");
    static const std::regex sample_line(
        R"re(([a-zA-Z_:][a-zA-Z0-9_:]*)(\{[a-zA-Z_]\w*="(?:[^"\\\n]|\\["\\n])*"(?:,[a-zA-Z_]\w*="(?:[^"\\\n]|\\["\\n])*")*\})? (\d+))re");
    std::map<std::string, double> samples;
    std::map<std::string, std::string> types;
    std::set<std::string> helped;
    std::string current;
    EXPECT_TRUE(text.ends_with("\n"));
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::smatch found;
        if (std::regex_match(line, found, help_line)) {
            EXPECT_TRUE(helped.insert(found[1]).second) << "helped twice: " << line;
        } else if (std::regex_match(line, found, type_line)) {
            current = found[1];
            EXPECT_TRUE(helped.contains(current)) << line;
            EXPECT_TRUE(types.emplace(current, found[2]).second) << "typed twice: " << line;
        } else if (std::regex_match(line, found, sample_line)) {
            EXPECT_EQ(found[1], current) << "outside its family: " << line;
            const bool counter = types[current] == "counter";
            EXPECT_EQ(counter, current.ends_with("_total")) << line;
            EXPECT_TRUE(samples.emplace(found[1].str() + found[2].str(), std::stod(found[3])).second) << line;
        } else {
            ADD_FAILURE() << "not a line of the format: " << line;
        }
    }
    return samples;
}

TEST(HttpHeads, WhatMattersIsRead) {
    const auto head = read_http_head(
        "GET /a?b HTTP/1.1\r\nhost: Sea.example:1\r\nOrigin: https://o\r\nConnection: keep-alive, Upgrade\r\n"
        "Upgrade: WebSocket\r\nSec-WebSocket-Key: k\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Protocol: x, trochoid\r\nSec-WebSocket-Protocol: y\r\n\r\n");
    const auto* request = std::get_if<HttpRequest>(&head);
    ASSERT_TRUE(request);
    HttpRequest expected;
    expected.method = "GET";
    expected.target = "/a?b";
    expected.host = "Sea.example:1";
    expected.origin = "https://o";
    expected.upgrade = true;
    expected.websocket_version = "13";
    expected.websocket_key = "k";
    expected.subprotocols = {"x", "trochoid", "y"};
    EXPECT_EQ(*request, expected);
    EXPECT_EQ(request->path(), "/a");
}

TEST(HttpHeads, WhatIsNotHttpIsRefused) {
    const auto status = [](const std::string& text) {
        const auto head = read_http_head(text);
        const auto* refusal = std::get_if<HttpRefusal>(&head);
        return refusal == nullptr ? 200U : refusal->status;
    };
    EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: a\r\n\r\n"), 200U);
    for (const char* bad : {"GET /\r\n\r\n", "GET  / HTTP/1.1\r\n\r\n", "G\x01T / HTTP/1.1\r\n\r\n",
                            "GET / HTTP/1.1\r\nHo st: a\r\n\r\n",
                            "GET / HTTP/1.1\r\nContent-Length: x\r\n\r\n", "GET / HTTP/1.1\r\n: a\r\n\r\n",
                            "GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n", "GET / HTTP/1.1\r\nHost: a\r\n"})
        EXPECT_EQ(status(bad), 400U) << bad;
    EXPECT_EQ(status("GET / HTTP/3.1\r\nHost: a\r\n\r\n"), 505U);
}

TEST(Metrics, EveryFamilyIsWellFormedAndLabelsAreEscaped) {
    EXPECT_EQ(escaped_label("a\"b\\c\nd"), R"(a\"b\\c\nd)");
    ServerStats sessions;
    sessions.bytes_in = 12'345'678'901'234;
    sessions.terrain_bytes = 7;
    sessions.ended[ErrorCode::rate_limited] = 3;
    sessions.refused[ErrorCode::too_late] = 2;
    DoorStats door;
    door.websocket_over_tls = 5;
    door.http_answers[404] = 4;
    auto samples = read_metrics(metrics_text(sessions, door, {"sea \"of\\\nmine", true}));
    EXPECT_EQ(samples["trochoid_received_bytes_total"], 12'345'678'901'234.0);
    EXPECT_EQ(samples["trochoid_sent_bytes_total{lane=\"terrain\"}"], 7);
    EXPECT_EQ(samples["trochoid_sessions_ended_total{code=\"402\",class=\"resource\"}"], 3);
    EXPECT_EQ(samples["trochoid_refusals_total{code=\"604\",class=\"world\"}"], 2);
    EXPECT_EQ(samples["trochoid_streams_total{form=\"websocket\",tls=\"yes\"}"], 5);
    EXPECT_EQ(samples["trochoid_http_answers_total{status=\"404\"}"], 4);
    EXPECT_EQ(samples["trochoid_ready"], 1);
    EXPECT_TRUE(std::any_of(samples.begin(), samples.end(), [](const auto& sample) {
        return sample.first.find(R"(world="sea \"of\\\nmine")") != std::string::npos;
    }));
}

class Http : public DoorFixture {};

TEST_F(Http, AnswersAndThenCloses) {
    start();
    const std::string live = get("/livez");
    EXPECT_EQ(status_of(live), 200U);
    EXPECT_EQ(body_of(live), "alive\n");
    EXPECT_NE(live.find("Content-Length: 6\r\n"), std::string::npos);
    EXPECT_NE(live.find("Connection: close\r\n"), std::string::npos);
    EXPECT_EQ(status_of(get("/readyz?verbose")), 200U);
    EXPECT_EQ(status_of(get("/nothing")), 404U);
    for (const char* method : {"POST", "PUT", "TRACE", "OPTIONS", "DELETE", "BREW"}) {
        const std::string answer = get("/livez", method);
        EXPECT_EQ(status_of(answer), 405U) << method;
        EXPECT_NE(answer.find("Allow: GET, HEAD\r\n"), std::string::npos) << answer;
    }
    const std::string head = get("/livez", "HEAD");
    EXPECT_EQ(status_of(head), 200U);
    EXPECT_EQ(body_of(head), "");
    EXPECT_NE(head.find("Content-Length: 6\r\n"), std::string::npos);
    const std::string front_page = get("/");
    EXPECT_EQ(status_of(front_page), 426U);
    EXPECT_NE(front_page.find("Upgrade: websocket\r\n"), std::string::npos);
    EXPECT_NE(body_of(front_page).find("trochoid-viewer --connect"), std::string::npos);
    EXPECT_EQ(door().http_answers[405], 6U);
    EXPECT_TRUE(stats().ended.empty());
}

TEST_F(Http, WhatIsWrongWithARequest) {
    start();
    EXPECT_EQ(status_of(say("GET\r\n\r\n")), 400U);
    EXPECT_EQ(status_of(say("GET /livez HTTP/1.1\r\n\r\n")), 400U);  // no host
    EXPECT_EQ(status_of(say("GET /livez HTTP/1.0\r\n\r\n")), 200U);
    EXPECT_EQ(status_of(say("GET /livez HTTP/2.0\r\nHost: a\r\n\r\n")), 505U);
    EXPECT_EQ(status_of(say("GET /livez HTTP/1.1\r\nHost: a\r\nContent-Length: 1\r\n\r\nx")), 413U);
    EXPECT_EQ(status_of(say("GET /livez HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n")), 413U);
    const std::string most(longest_http_head, 'a');
    const std::string begin = "GET /livez HTTP/1.1\r\nHost: a\r\nX: ";
    const std::string fitting = begin + most.substr(begin.size() + 4) + "\r\n\r\n";
    ASSERT_EQ(fitting.size(), longest_http_head);
    EXPECT_EQ(status_of(say(fitting)), 200U);
    EXPECT_EQ(status_of(say(begin + most + "\r\n\r\n")), 431U);
    EXPECT_EQ(status_of(say(begin + most)), 431U);  // however much is still to come
}

TEST_F(Http, ASlowHeadIsAnsweredAtTheDeadline) {
    limits.hello_deadline_ms = 300;
    start();
    const auto begun = std::chrono::steady_clock::now();
    EXPECT_EQ(status_of(say("GET /livez HTTP/1.1\r\nHost: a\r\nX: ")), 408U);
    EXPECT_LT(std::chrono::steady_clock::now() - begun, milliseconds(1500));
}

TEST_F(Http, ReadyOnlyOnceTheSceneIsOpen) {
    ready = false;
    start();
    EXPECT_EQ(status_of(get("/readyz")), 503U);
    EXPECT_EQ(status_of(get("/livez")), 200U);
    on_loop([this] {
        front->set_ready();
        return 0;
    });
    EXPECT_EQ(status_of(get("/readyz")), 200U);
}

// A page elsewhere that has its own name point here (DNS rebinding) reads no figures.
TEST_F(Http, MetricsAreAskedForByANameOfTheServer) {
    policy.hosts = {"sea.example"};
    start();
    const auto asked_by = [&](const std::string& host) {
        return say("GET /metrics HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
    };
    for (const char* host : {"localhost", "127.0.0.1:7421", "[::1]:7421", "sea.example:80"})
        EXPECT_EQ(status_of(asked_by(host)), 200U) << host;
    for (const char* host : {"evil.example", "localhost.evil.example", "192.0.2.1"}) {
        const std::string answer = asked_by(host);
        EXPECT_EQ(status_of(answer), 403U) << host;
        EXPECT_NE(body_of(answer).find("--allow-host"), std::string::npos);
        EXPECT_NE(answer.find("Content-Type: text/plain"), std::string::npos);
    }
    EXPECT_EQ(status_of(say("GET /metrics HTTP/1.0\r\n\r\n")), 200U);  // no browser leaves it out
}

TEST_F(Http, WhoSaysNoMoreStillGetsTheWholeAnswer) {
    world.assign(24 << 20, 'w');  // more than sockets buffer
    start();
    for (const bool tls : {false, true}) {
        const auto pipe = tls ? connect_tls(port()) : connect_tcp(port());
        ASSERT_TRUE(pipe);
        pipe->write(std::string("GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n"));
        pipe->finish_writing();
        std::this_thread::sleep_for(milliseconds(100));
        const std::string answer = pipe->read_all();
        EXPECT_EQ(status_of(answer), 200U);
        EXPECT_NE(answer.find("Content-Length: " + std::to_string(body_of(answer).size()) + "\r\n"),
                  std::string::npos)
            << body_of(answer).size();
        EXPECT_TRUE(pipe->ended_properly());
    }
}

TEST_F(Http, MetricsCountWhatHappens) {
    start();
    FormClient client(Form::web, port());
    ASSERT_TRUE(client.log_in());
    FormClient bad(Form::raw, port());
    bad.pipe().write(std::string("nonsense"));
    EXPECT_EQ(goodbye_to(bad), ErrorCode::wrong_magic);
    ASSERT_TRUE(bad.ends());
    ASSERT_TRUE(ended_with(ErrorCode::wrong_magic));
    ASSERT_EQ(status_of(get("/nothing")), 404U);
    const std::string answer = get("/metrics");
    EXPECT_NE(answer.find("Content-Type: text/plain; version=0.0.4; charset=utf-8\r\n"), std::string::npos);
    auto samples = read_metrics(body_of(answer));
    EXPECT_EQ(samples["trochoid_connections_accepted_total"], 4);
    EXPECT_EQ(samples["trochoid_streams_total{form=\"websocket\",tls=\"no\"}"], 1);
    EXPECT_EQ(samples["trochoid_streams_total{form=\"raw\",tls=\"no\"}"], 0);  // no session came of it
    EXPECT_EQ(samples["trochoid_sessions_started_total"], 1);
    EXPECT_EQ(samples["trochoid_sessions"], 1);
    EXPECT_EQ(samples["trochoid_sessions_ended_total{code=\"113\",class=\"protocol\"}"], 1);
    EXPECT_EQ(samples["trochoid_http_answers_total{status=\"404\"}"], 1);
    EXPECT_GT(samples["trochoid_sent_bytes_total{lane=\"state\"}"], 0);
}

}  // namespace
}  // namespace trochoid
