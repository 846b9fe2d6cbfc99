#include "client/scene/ship_pose.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "protocol/model/simd/water_batch.hpp"

namespace trochoid {

namespace {

constexpr double gravity = 9.80665;  // m/s²
constexpr double slowest_planing_ratio = 0.999;
/// A ship that does not plane: length of the usual one up to a speed, m/s and m.
struct UsualLength {
    double below;
    double length;
};
constexpr std::array<UsualLength, 4> usual_lengths{{{3.0, 12.0}, {7.0, 40.0}, {13.0, 110.0}, {1e9, 220.0}}};

/// Points of the waterline's area at which the water is read: along and across, odd, even spacing.
constexpr int stations = 17;
constexpr int rows = 3;
/// Slope that no hull takes over from the water: she would swamp.
constexpr double steepest = 0.35;
constexpr double longest_turn_s = 40.0;

bool there(const WaveTrainBox& box, SeaTime now) { return is_ship(box) && box.begin <= now && now < box.end; }

glm::dvec2 heading_of(const WaveTrainBox& box) {
    const auto east = static_cast<double>(box.ux);
    const auto south = static_cast<double>(box.uz);
    const double length = std::sqrt(east * east + south * south);
    return {east / length, south / length};
}

/// The box of the same ship's course before this one, if it is known: it ends where and when this one begins.
const WaveTrainBox* course_before(const InterestState& state, const WaveTrainBox& box) {
    constexpr int64_t near = 4 * lattice_per_metre;
    const LatticePoint start = ship_place(box, box.begin);
    for (const auto& [id, other] : state.boxes) {
        if (!is_ship(*other) || other->end != box.begin || id == box.id) continue;
        const LatticePoint last = ship_place(*other, other->end);
        if (std::abs(last.x - start.x) <= near && std::abs(last.z - start.z) <= near) return other.get();
    }
    return nullptr;
}

/// Turns from one heading to another, the shorter way round.
glm::dvec2 between(glm::dvec2 from, glm::dvec2 to, double share) {
    const double turn = std::atan2(from.x * to.y - from.y * to.x, from.x * to.x + from.y * to.y);
    const double angle = turn * (share - 1.0);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    return {to.x * c - to.y * s, to.x * s + to.y * c};
}

Ship ship_of(const InterestState& state, const WaveTrainBox& box, SeaTime now) {
    Ship ship;
    ship.box = box.id;
    ship.place = ship_place(box, now);
    ship.heading = heading_of(box);
    ship.speed = has_wake(box.wake) ? static_cast<double>(wake_speed(box.wake)) : 0.0;
    const HullSize size = has_hull(box.hull) ? HullSize{static_cast<double>(box.hull.length),
                                                        static_cast<double>(box.hull.beam)}
                                             : hull_size(box.wake);
    ship.length = size.length;
    ship.beam = size.beam;
    // She turns within two lengths of hers.
    const double turning_s =
        ship.speed > 0.0 ? std::clamp(2.0 * ship.length / ship.speed, 3.0, longest_turn_s) : longest_turn_s;
    const double t = static_cast<double>(now - box.begin) * 1e-6 / turning_s;
    if (t < 1.0)
        if (const WaveTrainBox* before = course_before(state, box))
            ship.heading = between(heading_of(*before), ship.heading, t * t * (3.0 - 2.0 * t));
    return ship;
}

double square(double x) { return x * x; }

double distance_m(const Camera& camera, LatticePoint p) {
    return std::sqrt(square(to_metres(p.x - camera.position.x)) + square(to_metres(p.z - camera.position.z)) +
                     square(camera.altitude_m));
}

}  // namespace

HullSize hull_size(const ShipWake& wake) {
    const auto speed = static_cast<double>(wake_speed(wake));
    const auto diverging = static_cast<double>(wake.diverging);
    const double ratio =
        static_cast<double>(wake.transverse) / std::max(diverging, 0x1p-20);  // min(1, 1/(2F))^4
    HullSize size;
    double froude = 0.5;
    if (ratio < slowest_planing_ratio) {
        froude = 0.5 / std::sqrt(std::sqrt(std::max(ratio, 1e-4)));
        size.length = square(speed) / (gravity * square(froude));
    } else {
        const auto usual = std::find_if(usual_lengths.begin(), usual_lengths.end(),
                                        [&](const UsualLength& u) { return speed < u.below; });
        size.length = std::max(usual->length, square(speed) / (gravity * square(0.5)));
        froude = speed / std::sqrt(gravity * size.length);
    }
    size.length = std::clamp(size.length, 3.0, 450.0);
    const double beam = 4.0 * diverging / square(std::min(froude, 0.5));
    size.beam = std::clamp(beam, size.length / 10.0, size.length / 3.0);
    return size;
}

std::vector<Ship> ships_of(const InterestState& state, SeaTime now) {
    std::vector<Ship> ships;
    for (const auto& [id, box] : state.boxes)
        if (there(*box, now)) ships.push_back(ship_of(state, *box, now));
    return ships;
}

ShipPose pose_of(const Ship& ship, const SeaInstant& water, Workers& workers) {
    constexpr int count = stations * rows;
    std::array<LatticePoint, count> places;
    std::array<double, count> along{};
    std::array<double, count> across{};
    for (int i = 0; i < count; ++i) {
        const auto n = static_cast<size_t>(i);
        const int station = i / rows - stations / 2;
        const int row = i % rows - rows / 2;
        // The bow's and the stern's ends carry little.
        along[n] = station * ship.length * 0.92 / (stations - 1);
        across[n] = row * ship.beam * 0.35;
        const double east = along[n] * ship.heading.x - across[n] * ship.heading.y;
        const double south = along[n] * ship.heading.y + across[n] * ship.heading.x;
        places[n] = {ship.place.x + to_lattice(east), ship.place.z + to_lattice(south)};
    }
    std::array<WaterPoint, count> heights;
    water_at_batch(water, places, heights, workers);
    double weights = 0, mean = 0, along2 = 0, across2 = 0, lengthwise = 0, sideways = 0;
    for (size_t n = 0; n < count; ++n) {
        // Breadth of the waterline.
        const double weight = 1.0 - square(square(2.0 * along[n] / ship.length));
        const double height = weight * static_cast<double>(heights[n].height);
        weights += weight;
        mean += height;
        lengthwise += height * along[n];
        along2 += weight * square(along[n]);
        sideways += height * across[n];
        across2 += weight * square(across[n]);
    }
    return {mean / weights, std::clamp(lengthwise / along2, -steepest, steepest),
            std::clamp(sideways / across2, -steepest, steepest)};
}

const Sea& ShipWaters::sea_of(const SceneInput& input) {
    if (input.sea) return *input.sea;
    if (prepared_of_ == input.state) return prepared_;
    std::map<FieldId, std::shared_ptr<LandField>> fields;
    for (const auto& [key, block] : input.state->blocks) {
        std::shared_ptr<LandField>& field = fields[key.field];
        if (!field) field = std::make_shared<LandField>(key.field, block.step_log2);
        if (field->fits(key.block)) field->set(block.block);
    }
    std::vector<std::shared_ptr<const LandField>> list;
    list.reserve(fields.size());
    for (const auto& [id, field] : fields) list.push_back(field);
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    boxes.reserve(input.state->boxes.size());
    for (const auto& [id, record] : input.state->boxes) boxes.push_back(prepare(*record, list));
    prepared_ = Sea(std::move(boxes));
    prepared_of_ = input.state;
    return prepared_;
}

std::vector<FloatingShip> ShipWaters::ships(const SceneInput& input, const Camera& camera) {
    if (!input.state) return {};
    if (input.state != state_) {
        state_ = input.state;
        any_ship_ = std::any_of(state_->boxes.begin(), state_->boxes.end(),
                                [](const auto& entry) { return is_ship(*entry.second); });
    }
    if (!any_ship_) return {};
    std::vector<Ship> seen = ships_of(*state_, input.now);
    const double half_pixel = 0.5 * static_cast<double>(radians_per_pixel(camera));
    std::erase_if(seen, [&](const Ship& ship) {
        return ship.length < half_pixel * distance_m(camera, ship.place) ||
               std::max(std::abs(ship.place.x - camera.position.x),
                        std::abs(ship.place.z - camera.position.z)) > anchor_reach / 2;
    });
    std::sort(seen.begin(), seen.end(), [&](const Ship& a, const Ship& b) {
        return std::pair(distance_m(camera, a.place), a.box) < std::pair(distance_m(camera, b.place), b.box);
    });
    if (seen.empty()) return {};
    if (seen.size() > most_ships) seen.resize(most_ships);
    const SeaInstant water(sea_of(input), input.now);
    std::vector<FloatingShip> floating;
    floating.reserve(seen.size());
    for (const Ship& ship : seen)
        floating.push_back({ship, ship.speed > 0.0 ? pose_of(ship, water.without(ship.box), one_core_)
                                                   : pose_of(ship, water, one_core_)});
    return floating;
}

}  // namespace trochoid
