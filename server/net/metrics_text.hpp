#pragma once
#include <string>
#include <string_view>

#include "server/net/door_stats.hpp"
#include "server/net/server_stats.hpp"

namespace trochoid {

struct MetricsFacts {
    std::string world;
    bool ready = false;
};

/// Counters and gauges in Prometheus' text format, version 0.0.4. Names begin with trochoid_, counters end in _total.
std::string metrics_text(const ServerStats& sessions, const DoorStats& door, const MetricsFacts& facts);

/// A label's value with \, " and line ends escaped.
std::string escaped_label(std::string_view value);

}  // namespace trochoid
