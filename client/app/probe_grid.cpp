#include "client/app/probe_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace trochoid {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::pair<Layer, const char*>, 9> layer_names{{{Layer::trains, "trains"},
                                                                    {Layer::shelter, "shelter"},
                                                                    {Layer::refraction, "refraction"},
                                                                    {Layer::wakes, "wakes"},
                                                                    {Layer::irregular, "irregular heights"},
                                                                    {Layer::orbits, "orbits"},
                                                                    {Layer::round, "round waves"},
                                                                    {Layer::noise, "noise"},
                                                                    {Layer::displayed_noise, "ripples"}}};

std::vector<const char*> names_of(Layers layers, bool those_in) {
    std::vector<const char*> names;
    for (const auto& [layer, name] : layer_names)
        if (layers.has(layer) == those_in) names.push_back(name);
    return names;
}

std::string list_of(const std::vector<const char*>& names) {
    return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

double seconds(SeaTime t) { return static_cast<double>(t.us) * 1e-6; }

/// Displacement and slopes of a grid.
struct Mesh {
    explicit Mesh(size_t points) : ax(points), ay(points), az(points), yx(points), yz(points) {}
    SurfacePlanes planes() {
        return {.ax = ax.data(), .ay = ay.data(), .az = az.data(), .yx = yx.data(), .yz = yz.data()};
    }
    std::vector<float> ax, ay, az, yx, yz;
};

double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
    double most = 0.0;
    for (size_t i = 0; i < a.size(); ++i)
        most = std::max(most, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
    return most;
}

/// Heights alone, by all cores.
std::vector<float> heights_of(const SeaInstant& sea, const LatticeGrid& grid) {
    Workers workers(0);
    std::vector<float> heights(grid.size());
    evaluate_grid(sea, grid, {.ay = heights.data()}, workers);
    return heights;
}

/// Milliseconds, the best of five: whatever else the machine does only adds.
template <class Work>
double best_ms(Work work) {
    double best = 0.0;
    for (int i = 0; i < 5; ++i) {
        const auto begun = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begun;
        best = i == 0 ? took.count() : std::min(best, took.count());
    }
    return best;
}

BudgetAnswer::Box box_line(const PreparedBox& box, const BoxShare& share) {
    BudgetAnswer::Box line{box.record.id, static_cast<uint32_t>(box.record.trains.size()), share.trains, 0.0,
                           0.0};
    for (const uint16_t train : share.trains) {
        const auto length = static_cast<double>(box.constants[train].wavelength);
        line.longest_m = std::max(line.longest_m, length);
        line.shortest_m = line.shortest_m == 0.0 ? length : std::min(line.shortest_m, length);
    }
    return line;
}

}  // namespace

std::optional<LatticeGrid> grid_within(const SyncRegion& region, uint32_t side) {
    // Half the square's side; 0.7071 is below the root of 1/2.
    const int64_t half = int64_t{region.radius} * 7071 / 10000;
    const int64_t steps = int64_t{side} - 1;
    const int64_t step = 2 * half / steps;
    if (step < 1) return std::nullopt;
    const int64_t reach = step * steps / 2;
    const LatticePoint corner{region.centre.x - reach, region.centre.z - reach};
    return LatticeGrid{corner, step, step, static_cast<int32_t>(side), static_cast<int32_t>(side)};
}

BudgetAnswer spend_budget(const Sea& sea, SeaTime time, const LatticeGrid& grid, double point_trains) {
    BudgetQuestion question;
    question.region = {grid.origin, grid.at(grid.nx - 1, grid.nz - 1)};
    question.from = time;
    question.until = time + 1;
    question.points = static_cast<double>(grid.size());
    question.point_trains = point_trains;
    BudgetAnswer answer{time, grid.size(), point_trains, choose_within(sea, question), {}, 0.0};
    for (const BoxShare& share : answer.choice.boxes)
        for (const auto& box : sea.boxes())
            if (box->record.id == share.box) answer.boxes.push_back(box_line(*box, share));
    const auto all = heights_of(SeaInstant(sea, time, question.wanted), grid);
    const auto bought = heights_of(SeaInstant(reduced(sea, answer.choice), time, answer.choice.layers), grid);
    answer.height_seen = largest_difference(all, bought);
    return answer;
}

bool BudgetAnswer::keeps_bound() const {
    return height_seen <= 1.00001 * (choice.trains_lost + choice.layers_lost) + 1e-4;
}

CoarseAnswer evaluate_coarsely(const Sea& sea, SeaTime time, const LatticeGrid& grid,
                               const CoarseOptions& options) {
    const SeaInstant instant(sea, time);
    CoarseAnswer answer{time, grid.size(), 0, options, {}};
    for (const LiveBox& live : instant.live())
        answer.trains += static_cast<uint32_t>(live.box->record.trains.size());
    Workers one_core(1);
    Mesh exact(grid.size());
    Mesh coarse(grid.size());
    answer.exact_ms = best_ms([&] { evaluate_grid(instant, grid, exact.planes(), one_core); });
    answer.coarse_ms = best_ms(
        [&] { answer.bound = evaluate_coarse_grid(instant, grid, coarse.planes(), options, one_core); });
    answer.height_seen = largest_difference(exact.ay, coarse.ay);
    answer.horizontal_seen =
        std::max(largest_difference(exact.ax, coarse.ax), largest_difference(exact.az, coarse.az));
    answer.slope_seen =
        std::max(largest_difference(exact.yx, coarse.yx), largest_difference(exact.yz, coarse.yz));
    return answer;
}

std::string text_of(const BudgetAnswer& a) {
    std::string out =
        fmt::format("sea time {:.3f} s, {} points: {:.4g} point-trains of {:.4g} asked for, budget {:.4g}\n",
                    seconds(a.time), a.points, a.choice.spent, a.choice.asked, a.point_trains);
    out += fmt::format("{:>6}  {:>6}  {:>6}  {:>10}  {:>10}\n", "BOX", "TRAINS", "KEPT", "LONGEST m",
                       "SHORTEST m");
    for (const BudgetAnswer::Box& box : a.boxes)
        out += fmt::format("{:>6}  {:>6}  {:>6}  {:>10.2f}  {:>10.2f}\n", box.box.value, box.trains,
                           box.kept.size(), box.longest_m, box.shortest_m);
    out += fmt::format("layers bought: {}; left out: {}\n", list_of(names_of(a.choice.layers, true)),
                       list_of(names_of(a.choice.layers, false)));
    out += fmt::format(
        "lost in height at most {:.4f} m by trains and {:.4f} m by layers; seen on these points {:.4f} m\n",
        a.choice.trains_lost, a.choice.layers_lost, a.height_seen);
    out += a.choice.best
               ? "no other choice within the budget keeps more\n"
               : fmt::format("the search was cut short: {:.4f} m from the best at most\n", a.choice.gap);
    return out;
}

std::string text_of(const CoarseAnswer& a) {
    std::string out = fmt::format(
        "sea time {:.3f} s, {} points: {} of {} trains interpolated between points {} steps apart\n",
        seconds(a.time), a.points, a.bound.trains, a.trains, a.options.factor);
    if (a.bound.trains == 0)
        out +=
            "only trains that are long against these steps, in boxes that are full all over the grid, without "
            "land, irregular heights or round waves, can be\n";
    out += fmt::format("{:<16}  {:>12}  {:>12}\n", "ERROR", "BOUND", "SEEN");
    out += fmt::format("{:<16}  {:>12.3e}  {:>12.3e}\n", "height, m", a.bound.height, a.height_seen);
    out +=
        fmt::format("{:<16}  {:>12.3e}  {:>12.3e}\n", "horizontal, m", a.bound.horizontal, a.horizontal_seen);
    out += fmt::format("{:<16}  {:>12.3e}  {:>12.3e}\n", "slope", a.bound.slope, a.slope_seen);
    out += fmt::format("{:.3f} ms instead of {:.3f} ms on one core: {:.2f} times as fast\n", a.coarse_ms,
                       a.exact_ms, a.exact_ms / std::max(a.coarse_ms, 1e-9));
    return out;
}

std::string json_line(const BudgetAnswer& a) {
    Json boxes = Json::array();
    for (const BudgetAnswer::Box& box : a.boxes)
        boxes.push_back({{"box", box.box.value}, {"trains", box.trains}, {"kept", box.kept}});
    return Json{{"time_s", seconds(a.time)},
                {"points", a.points},
                {"budget_point_trains", a.point_trains},
                {"spent_point_trains", a.choice.spent},
                {"asked_point_trains", a.choice.asked},
                {"boxes", boxes},
                {"layers", names_of(a.choice.layers, true)},
                {"layers_left_out", names_of(a.choice.layers, false)},
                {"trains_lost_m", a.choice.trains_lost},
                {"layers_lost_m", a.choice.layers_lost},
                {"height_seen_m", a.height_seen},
                {"best", a.choice.best},
                {"gap_m", a.choice.gap}}
               .dump() +
           "\n";
}

std::string json_line(const CoarseAnswer& a) {
    return Json{{"time_s", seconds(a.time)},
                {"points", a.points},
                {"trains", a.trains},
                {"interpolated", a.bound.trains},
                {"factor", a.options.factor},
                {"bound",
                 {{"height_m", a.bound.height},
                  {"horizontal_m", a.bound.horizontal},
                  {"slope", a.bound.slope}}},
                {"seen",
                 {{"height_m", a.height_seen}, {"horizontal_m", a.horizontal_seen}, {"slope", a.slope_seen}}},
                {"exact_ms", a.exact_ms},
                {"coarse_ms", a.coarse_ms}}
               .dump() +
           "\n";
}

}  // namespace trochoid
