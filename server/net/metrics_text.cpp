#include "server/net/metrics_text.hpp"

#include <fmt/format.h>

#include <iterator>
#include <map>
#include <utility>

#include "protocol/units/version.hpp"

namespace trochoid {

namespace {

class Page {
public:
    void counter(std::string_view name, std::string_view help, uint64_t value) {
        begin(name, help, "counter");
        line(name, "", value);
    }
    void gauge(std::string_view name, std::string_view help, uint64_t value) {
        begin(name, help, "gauge");
        line(name, "", value);
    }
    void begin(std::string_view name, std::string_view help, std::string_view type) {
        fmt::format_to(std::back_inserter(text_), "# HELP trochoid_{0} {1}\n# TYPE trochoid_{0} {2}\n", name,
                       escaped_help(help), type);
    }
    /// `labels`: "lane=\"state\"", values escaped; or nothing.
    void line(std::string_view name, std::string_view labels, uint64_t value) {
        if (labels.empty())
            fmt::format_to(std::back_inserter(text_), "trochoid_{} {}\n", name, value);
        else
            fmt::format_to(std::back_inserter(text_), "trochoid_{}{{{}}} {}\n", name, labels, value);
    }
    void by_code(std::string_view name, std::string_view help, const std::map<ErrorCode, uint64_t>& counts) {
        begin(name, help, "counter");
        for (const auto& [code, count] : counts)
            line(name,
                 fmt::format("code=\"{}\",class=\"{}\"", static_cast<unsigned>(code), error_class(code)),
                 count);
    }
    template <class Key>
    void by_name(std::string_view name, std::string_view help, std::string_view label,
                 const std::map<Key, uint64_t>& counts) {
        begin(name, help, "counter");
        for (const auto& [key, count] : counts)
            line(name, fmt::format("{}=\"{}\"", label, escaped_label(name_of(key))), count);
    }
    std::string take() { return std::move(text_); }

private:
    static std::string escaped_help(std::string_view help) {
        std::string text;
        for (const char c : help) text += c == '\\' ? "\\\\" : c == '\n' ? "\\n" : std::string(1, c);
        return text;
    }
    std::string text_;
};

void add_door(Page& page, const DoorStats& s) {
    page.counter("connections_accepted_total", "Connections that came to the door.", s.accepted);
    page.gauge("connections_waiting", "Connections not told apart yet, in a handshake or being answered.",
               s.guests_now);
    page.begin("streams_total", "Streams handed to sessions, by form and encryption.", "counter");
    page.line("streams_total", "form=\"raw\",tls=\"no\"", s.raw);
    page.line("streams_total", "form=\"raw\",tls=\"yes\"", s.raw_over_tls);
    page.line("streams_total", "form=\"websocket\",tls=\"no\"", s.websocket);
    page.line("streams_total", "form=\"websocket\",tls=\"yes\"", s.websocket_over_tls);
    page.begin("tls_handshakes_total", "TLS handshakes that ended, by outcome.", "counter");
    page.line("tls_handshakes_total", "outcome=\"done\"", s.handshakes);
    page.line("tls_handshakes_total", "outcome=\"failed\"", s.handshakes_failed);
    page.counter("tls_handshake_turns_total", "Turns in which TLS handshakes were begun, a few each.",
                 s.handshake_turns);
    page.gauge("tls_handshakes_open", "TLS handshakes under way.", s.handshakes_now);
    page.counter("connections_made_room_total",
                 "Connections that were not in yet and had to go because newer ones came.", s.made_room);
    page.begin("http_answers_total", "HTTP answers by status, upgrades apart.", "counter");
    for (const auto& [status, count] : s.http_answers)
        page.line("http_answers_total", fmt::format("status=\"{}\"", status), count);
}

void add_sessions(Page& page, const ServerStats& s) {
    page.counter("sessions_started_total", "Sessions past their hello.", s.sessions_started);
    page.gauge("sessions", "Connections that sessions hold now.", s.sessions_now);
    page.counter("sessions_held_back_total", "Connections that waited, as their address logs in too often.",
                 s.held_back);
    page.by_code("sessions_ended_total", "Connections and sessions that ended, by code.", s.ended);
    page.by_code("sessions_ended_elsewhere_total", "How clients say that their last session ended, by code.",
                 s.clients_ends);
    page.by_name("resumes_total", "Hellos that wished to go on with what they held, by what became of it.",
                 "outcome", s.resumes);
    page.begin("viewers_total", "Answers to the known-answer challenge.", "counter");
    page.line("viewers_total", "verdict=\"exact\"", s.exact_viewers);
    page.line("viewers_total", "verdict=\"approximate\"", s.approximate_viewers);
}

void add_traffic(Page& page, const ServerStats& s) {
    page.counter("frames_received_total", "Frames from clients.", s.frames_in);
    page.counter("received_bytes_total", "Bytes from clients, frame headers included.", s.bytes_in);
    page.counter("frames_sent_total", "Frames to clients.", s.frames_out);
    page.begin("sent_bytes_total", "Bytes to clients by lane, frame headers included.", "counter");
    page.line("sent_bytes_total", "lane=\"control\"", s.control_bytes);
    page.line("sent_bytes_total", "lane=\"state\"", s.state_bytes);
    page.line("sent_bytes_total", "lane=\"answers\"", s.answer_bytes);
    page.line("sent_bytes_total", "lane=\"terrain\"", s.terrain_bytes);
}

void add_work(Page& page, const ServerStats& s) {
    page.counter("results_total", "Results begun, empty ones included.", s.results);
    page.counter("empty_results_total", "Results that only brought a new key or a marker.", s.empty_results);
    page.counter("resyncs_total", "Snapshots because a state hash differed.", s.resyncs);
    page.counter("probes_total", "Probes answered.", s.probes);
    page.counter("stale_probes_total", "Probes whose result had been superseded.", s.stale_probes);
    page.by_name("desyncs_total", "Differences that clients told, by the part that differed first.", "part",
                 s.desyncs);
    page.counter("terrain_tiles_total", "Terrain tiles sent.", s.terrain_tiles);
    page.counter("views_total", "Views received.", s.views);
    page.counter("views_superseded_total", "Views replaced before a result was decided from them.",
                 s.views_superseded);
    page.counter("commands_total", "Commands received.", s.commands);
    page.by_code("refusals_total", "Commands and requests refused, by code.", s.refused);
}

}  // namespace

std::string escaped_label(std::string_view value) {
    std::string text;
    for (const char c : value) {
        if (c == '\n') {
            text += "\\n";
            continue;
        }
        if (c == '\\' || c == '"') text += '\\';
        text += c;
    }
    return text;
}

std::string metrics_text(const ServerStats& sessions, const DoorStats& door, const MetricsFacts& facts) {
    Page page;
    page.begin("server_info", "What runs here; always 1.", "gauge");
    page.line("server_info",
              fmt::format("version=\"{}\",world=\"{}\"", escaped_label(software_version()),
                          escaped_label(facts.world)),
              1);
    page.gauge("ready", "1 while /readyz says so.", facts.ready ? 1 : 0);
    add_door(page, door);
    add_sessions(page, sessions);
    add_traffic(page, sessions);
    add_work(page, sessions);
    return page.take();
}

}  // namespace trochoid
