#include "client/app/probe_report.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <nlohmann/json.hpp>

namespace trochoid {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array names{"ax", "ay", "az", "pxx", "pxz", "pzx", "pzz", "yx",
                           "yz", "nx", "ny", "nz",  "vx",  "vy",  "vz"};

std::array<float, names.size()> floats_of(const SurfaceSample& s) {
    return {s.ax, s.ay, s.az, s.pxx, s.pxz, s.pzx, s.pzz, s.yx, s.yz, s.nx, s.ny, s.nz, s.vx, s.vy, s.vz};
}

double seconds(SeaTime t) { return static_cast<double>(t.us) * 1e-6; }

const char* name_of(Trust trust) {
    switch (trust) {
        case Trust::exact: return "exact";
        case Trust::bounded: return "bounded";
        case Trust::unknown: return "unknown";
    }
    return "";
}

const char* word(Fidelity fidelity) {
    switch (fidelity) {
        case Fidelity::exact: return "exact";
        case Fidelity::approximate: return "approximate";
        case Fidelity::unknown: return "unknown";
    }
    return "";
}

const char* certainty(const WaterAnswer& answer) { return answer.confirmed ? "confirmed" : "expected"; }

}  // namespace

std::vector<uint32_t> bits_of(const SurfaceSample& sample) {
    std::vector<uint32_t> bits;
    for (const float v : floats_of(sample)) bits.push_back(std::bit_cast<uint32_t>(v));
    return bits;
}

void compare(ProbeComparison& sum, const ProbeSample& ours, const SurfaceSample& servers) {
    ++sum.asked;
    const std::vector<uint32_t> a = bits_of(ours.surface);
    const std::vector<uint32_t> b = bits_of(servers);
    if (a == b) {
        ++sum.identical;
        return;
    }
    if (!sum.first_difference.empty()) return;
    for (size_t i = 0; i < a.size(); ++i)
        if (a[i] != b[i]) {
            sum.first_difference = fmt::format(
                "{} at x {} z {} (lattice units), sea time {} us: {:08x} ({:g}) here, {:08x} ({:g}) on the server",
                names[i], ours.point.x, ours.point.z, ours.time.us, a[i], floats_of(ours.surface)[i], b[i],
                floats_of(servers)[i]);
            return;
        }
}

std::string bits_line(const ProbeSample& sample) {
    std::string line = fmt::format("{} {} {}", sample.time.us, sample.point.x, sample.point.z);
    for (const uint32_t word_of_bits : bits_of(sample.surface)) line += fmt::format(" {:08x}", word_of_bits);
    return line + "\n";
}

std::string table_of(const std::vector<ProbeSample>& samples) {
    std::string out = fmt::format("{:>14}  {:>11}  {:>11}  {:>9}  {:>22}  {:>20}  {}\n", "TIME s", "X m",
                                  "Z m", "HEIGHT m", "NORMAL", "VELOCITY m/s", "TRUST");
    for (const ProbeSample& s : samples) {
        const WaterPoint& w = s.answer.water;
        out += fmt::format(
            "{:14.3f}  {:11.3f}  {:11.3f}  {:+9.4f}  {:+6.3f}  {:+6.3f}  {:+6.3f}  {:+6.2f} {:+6.2f} {:+6.2f}  {}, {}\n",
            seconds(s.time), to_metres(s.point.x), to_metres(s.point.z), w.height, w.nx, w.ny, w.nz, w.vx,
            w.vy, w.vz, name_of(s.answer.trust), certainty(s.answer));
    }
    return out;
}

std::string watch_line(const ProbeSample& s) {
    const WaterPoint& w = s.answer.water;
    return fmt::format(
        "sea time {:.3f} s  height {:+.4f} m  normal {:+.3f} {:+.3f} {:+.3f}  velocity {:+.2f} {:+.2f} {:+.2f} m/s  {}, {}\n",
        seconds(s.time), w.height, w.nx, w.ny, w.nz, w.vx, w.vy, w.vz, name_of(s.answer.trust),
        certainty(s.answer));
}

std::string comparison_line(const ProbeComparison& comparison) {
    std::string line = fmt::format("{} of {} identical\n", comparison.identical, comparison.asked);
    if (!comparison.first_difference.empty())
        line += fmt::format("first difference: {}\n", comparison.first_difference);
    return line;
}

std::string summary(const SessionStatistics& s, const StoreSnapshot& known) {
    return fmt::format(
        "{} | {} | {} boxes, {} land blocks, log {} | clock within {:.3f} ms | {} bytes received, {} sent, {} results, {} resyncs, {} of {} probes differ\n",
        s.server_version.empty() ? s.sentence : s.server_version, word(s.fidelity),
        known.interest->boxes.size(), known.interest->blocks.size(), known.log_position.value,
        static_cast<double>(s.clock_error_us) * 1e-3, s.bytes_received, s.bytes_sent, s.store.results,
        s.store.resyncs, s.store.desyncs, s.store.probed);
}

std::string json_of(const std::vector<ProbeSample>& samples, const ProbeComparison* comparison,
                    const SessionStatistics& statistics, const StoreSnapshot& known) {
    Json list = Json::array();
    for (const ProbeSample& s : samples) {
        const WaterPoint& w = s.answer.water;
        list.push_back({{"time_s", seconds(s.time)},
                        {"x_m", to_metres(s.point.x)},
                        {"z_m", to_metres(s.point.z)},
                        {"height_m", w.height},
                        {"normal", {w.nx, w.ny, w.nz}},
                        {"velocity_m_s", {w.vx, w.vy, w.vz}},
                        {"trust", name_of(s.answer.trust)},
                        {"confirmed", s.answer.confirmed}});
    }
    Json out{{"server", statistics.server_version},
             {"fidelity", word(statistics.fidelity)},
             {"boxes", known.interest->boxes.size()},
             {"land_blocks", known.interest->blocks.size()},
             {"log_position", known.log_position.value},
             {"clock_error_ms", static_cast<double>(statistics.clock_error_us) * 1e-3},
             {"bytes_received", statistics.bytes_received},
             {"bytes_sent", statistics.bytes_sent},
             {"resyncs", statistics.store.resyncs},
             {"resumed", statistics.store.resumed},
             {"probed", statistics.store.probed},
             {"desyncs", statistics.store.desyncs},
             {"samples", list}};
    if (comparison != nullptr)
        out["compared"] = {{"asked", comparison->asked},
                           {"identical", comparison->identical},
                           {"first_difference", comparison->first_difference}};
    return out.dump(2) + "\n";
}

}  // namespace trochoid
