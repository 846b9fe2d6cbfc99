#include "server/net/server_stats.hpp"

#include <fmt/format.h>

namespace trochoid {

namespace {

std::string by_code(const std::map<ErrorCode, uint64_t>& counts) {
    std::string text;
    for (const auto& [code, count] : counts)
        text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", static_cast<unsigned>(code), count);
    return text.empty() ? "none" : text;
}

template <class Key>
std::string by_name(const std::map<Key, uint64_t>& counts) {
    std::string text;
    for (const auto& [key, count] : counts)
        text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", name_of(key), count);
    return text.empty() ? "none" : text;
}

}  // namespace

std::string text_of(const ServerStats& s) {
    return fmt::format(
        "{} connections ({} sessions, {} open, {} held back), in {} frames {} bytes, out {} frames (bytes: control {}, state {}, answers "
        "{}, terrain {}), {} results ({} empty, {} resyncs), {} tiles, {} views ({} superseded), {} commands, viewers {} "
        "exact {} approximate, resumes {}, {} probes ({} stale), desyncs {}, ended by code {}, refused by code {}, clients' ends {}",
        s.connections, s.sessions_started, s.sessions_now, s.held_back, s.frames_in, s.bytes_in, s.frames_out,
        s.control_bytes, s.state_bytes, s.answer_bytes, s.terrain_bytes, s.results, s.empty_results,
        s.resyncs, s.terrain_tiles, s.views, s.views_superseded, s.commands, s.exact_viewers,
        s.approximate_viewers, by_name(s.resumes), s.probes, s.stale_probes, by_name(s.desyncs),
        by_code(s.ended), by_code(s.refused), by_code(s.clients_ends));
}

}  // namespace trochoid
