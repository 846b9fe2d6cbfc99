#include "client/ctl/ctl_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "client/ctl/text_table.hpp"

namespace trochoid {

namespace {

using Json = nlohmann::ordered_json;

double seconds(SeaTime t) { return static_cast<double>(t.us) * 1e-6; }

Json json_of(SeaTime t) {
    if (t >= end_of_time) return nullptr;
    return seconds(t);
}

std::string seconds_text(SeaTime t) { return t >= end_of_time ? "never" : fmt::format("{:.1f}", seconds(t)); }

std::string as_text(const Json& json) { return json.dump(2) + "\n"; }

const char* kind_of(const BoxSummary& box) {
    switch (box.kind) {
        case BoxKind::waves: return "waves";
        case BoxKind::wind: return "wind";
        case BoxKind::ship: return "ship";
        case BoxKind::noise: return "noise";
    }
    return "unknown";
}

Json json_of(const BoxSummary& box, SeaTime now) {
    return Json{{"box", box.box.value},
                {"name", box.name},
                {"stage", stage_of(box, now)},
                {"share_of_height", box.gain_now},
                {"significant_height_m", box.significant_height},
                {"wind_speed_m_s", box.wind_speed},
                {"towards_degrees", box.towards_degrees},
                {"trains", box.trains},
                {"begin_s", json_of(box.begin)},
                {"end_s", json_of(box.end)},
                {"decay_s", static_cast<double>(box.decay_us) * 1e-6},
                {"kind", kind_of(box)},
                {"x_m", to_metres(box.at.x)},
                {"z_m", to_metres(box.at.z)},
                {"vx_m_s", box.vx},
                {"vz_m_s", box.vz},
                {"length_m", box.hull.length},
                {"beam_m", box.hull.beam}};
}

/// What came of a command, with a place for the time.
struct Outcome {
    std::string operator()(const StartWind&) const { return "the wind starts at sea time {}"; }
    std::string operator()(const StartShip&) const { return "the ship starts at sea time {}"; }
    std::string operator()(const Steer& steer) const {
        return steer.speed == 0.0F ? "lies still from sea time {} on"
                                   : "the new course holds from sea time {} on";
    }
    std::string operator()(const StopWind&) const { return "the decay starts at sea time {}"; }
    std::string operator()(const ChangeLand&) const { return "the land changes at sea time {}"; }
    std::string operator()(const SetRate& rate) const {
        return fmt::format("rate {:g} from sea time {{}} on", static_cast<double>(rate.rate_q16) / 65536.0);
    }
    std::string operator()(const SkipTime&) const { return "time goes on from sea time {}"; }
    std::string operator()(const ListBoxes&) const { return "listed at sea time {}"; }
};

/// Speed in m/s and heading in degrees of a box that moves.
struct Motion {
    double speed = 0.0;
    double heading = 0.0;
};
std::optional<Motion> motion_of(const BoxSummary& box) {
    if (box.vx == 0.0F && box.vz == 0.0F) return std::nullopt;
    const auto vx = static_cast<double>(box.vx);
    const auto vz = static_cast<double>(box.vz);
    const double heading = std::atan2(vx, -vz) * 180.0 / std::numbers::pi;
    return Motion{std::hypot(vx, vz), heading < -0.5 ? heading + 360.0 : std::abs(heading)};
}

}  // namespace

std::string sea_time_text(SeaTime time) {
    if (time >= end_of_time) return "never";
    const int64_t ms = (time.us < 0 ? -time.us : time.us) / 1000;
    const int64_t s = ms / 1000;
    const int64_t days = s / 86400;
    const std::string clock =
        fmt::format("{:02}:{:02}:{:02}.{:03}", s / 3600 % 24, s / 60 % 60, s % 60, ms % 1000);
    const char* sign = time.us < 0 ? "-" : "";
    return fmt::format("{}{}.{:03} s ({}{}{})", sign, s, ms % 1000, sign,
                       days > 0 ? fmt::format("{} d ", days) : "", clock);
}

const char* stage_of(const BoxSummary& box, SeaTime now) {
    if (now < box.begin) return "waiting";
    // A ship whose box has a hull and does not move.
    if (now < box.end && box.kind == BoxKind::ship && box.vx == 0.0F && box.vz == 0.0F) return "lying";
    if (now < box.end) return box.gain_now < 1.0F ? "growing" : "grown";
    return now < box.end + box.decay_us ? "decaying" : "over";
}

std::string report(const BoxList& list, bool json) {
    if (json) {
        Json boxes = Json::array();
        for (const BoxSummary& box : list.boxes) boxes.push_back(json_of(box, list.now));
        return as_text({{"sea_time_s", seconds(list.now)}, {"boxes", boxes}});
    }
    std::string out = fmt::format("sea time {}\n", sea_time_text(list.now));
    if (list.boxes.empty()) return out + "no wave train boxes: the sea is still\n";
    using enum TextTable::Align;
    TextTable table({{"BOX"},
                     {"NAME", left},
                     {"KIND", left},
                     {"STAGE", left},
                     {"NOW %"},
                     {"HS m"},
                     {"WIND m/s"},
                     {"TOWARDS"},
                     {"TRAINS"},
                     {"BEGIN s"},
                     {"END s"},
                     {"DECAY s"},
                     {"X m"},
                     {"Z m"},
                     {"MOVES m/s"},
                     {"COURSE"},
                     {"HULL m"}});
    for (const BoxSummary& b : list.boxes) {
        const std::optional<Motion> motion = motion_of(b);
        table.add({fmt::to_string(b.box.value), b.name, kind_of(b), stage_of(b, list.now),
                   fmt::format("{:.0f}", b.gain_now * 100.0F), fmt::format("{:.2f}", b.significant_height),
                   b.wind_speed > 0.0F ? fmt::format("{:.1f}", b.wind_speed) : "-",
                   fmt::format("{:.0f}°", b.towards_degrees), fmt::to_string(b.trains), seconds_text(b.begin),
                   seconds_text(b.end), fmt::format("{:.1f}", static_cast<double>(b.decay_us) * 1e-6),
                   fmt::format("{:.0f}", to_metres(b.at.x)), fmt::format("{:.0f}", to_metres(b.at.z)),
                   motion ? fmt::format("{:.1f}", motion->speed) : "-",
                   motion ? fmt::format("{:.0f}°", motion->heading) : "-",
                   has_hull(b.hull) ? fmt::format("{:g} x {:.1f}", b.hull.length, b.hull.beam) : "-"});
    }
    return out + table.text();
}

std::string report(const CommandReply& reply, const CommandAction& action, SeaTime asked, bool json) {
    const bool of_a_box = !std::holds_alternative<SetRate>(action) &&
                          !std::holds_alternative<SkipTime>(action) &&
                          !std::holds_alternative<ChangeLand>(action);
    const bool timed = asked.us > -sea_time_bound;
    const int64_t deferred_us = timed ? reply.effective - asked : 0;
    if (json) {
        Json out{{"effective_s", json_of(reply.effective)},
                 {"effective_us", reply.effective.us},
                 {"log_position", reply.log_position.value}};
        if (of_a_box) out["box"] = reply.box.value;
        if (timed) out["deferred_s"] = static_cast<double>(deferred_us) * 1e-6;
        return as_text(out);
    }
    std::string out = of_a_box ? fmt::format("box {}: ", reply.box.value) : std::string();
    out += fmt::format(fmt::runtime(std::visit(Outcome{}, action)), sea_time_text(reply.effective)) + "\n";
    if (deferred_us > 0)
        out += fmt::format("deferred by {:.3f} s: nothing can take hold earlier any more\n",
                           static_cast<double>(deferred_us) * 1e-6);
    return out;
}

std::string report(const ClockReply& reply, bool json) {
    const SeaTime now = sea_time_at(reply.clock, reply.server_sent_us);
    const double rate = static_cast<double>(reply.clock.rate_q16) / 65536.0;
    if (json)
        return as_text({{"sea_time_s", seconds(now)},
                        {"sea_time_us", now.us},
                        {"rate", rate},
                        {"epoch", reply.clock.epoch},
                        {"watermark_s", json_of(reply.watermark)},
                        {"log_position", reply.log_position.value},
                        {"log_hash", fmt::format("{:016x}", reply.log_hash)}});
    return fmt::format(
        "sea time   {}\nrate       {:g}{}\nepoch      {}\nwatermark  {}\nlog        {} events, hash {:016x}\n",
        sea_time_text(now), rate, reply.clock.rate_q16 == 0 ? " (paused)" : "", reply.clock.epoch,
        sea_time_text(reply.watermark), reply.log_position.value, reply.log_hash);
}

std::string refusal(const CommandReply& reply) {
    // The server says what to do; here stands only how trochoid-ctl is told to.
    const char* how = "";
    if (reply.code == ErrorCode::token_required) how = " (--sign-with KEY)";
    if (reply.code == ErrorCode::unknown_box) how = " (trochoid-ctl list)";
    if (reply.code == ErrorCode::too_late) how = " (--at, --in, --or-refuse)";
    return fmt::format("the server refuses ({} {}): {}{}", static_cast<unsigned>(reply.code),
                       error_class(reply.code), reply.message, how);
}

}  // namespace trochoid
