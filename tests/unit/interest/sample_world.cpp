#include "tests/unit/interest/sample_world.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"

namespace trochoid {

namespace {

constexpr double pi = std::numbers::pi;
constexpr int32_t field_blocks = 4;  // blocks of 1 km along a side, from (-2, -2)

std::shared_ptr<const LandField> sample_field(FieldId id, uint64_t seed) {
    auto field = std::make_shared<LandField>(id, uint8_t{16});
    constexpr int64_t nodes = field_blocks * block_cells;
    const auto noise = [&](int64_t x, int64_t z) {
        return splitmix64(seed ^ (static_cast<uint64_t>(x) << 32) ^ static_cast<uint64_t>(z & 0xffffffff));
    };
    for (int32_t bz = 0; bz < field_blocks; ++bz)
        for (int32_t bx = 0; bx < field_blocks; ++bx) {
            auto block = std::make_shared<LandBlock>();
            block->key = {bx - field_blocks / 2, bz - field_blocks / 2};
            for (int64_t j = 0; j < block_nodes; ++j)
                for (int64_t i = 0; i < block_nodes; ++i) {
                    const int64_t x = bx * block_cells + i;
                    const int64_t z = bz * block_cells + j;
                    // Falls to shift 0 and gain 1 on the field's border.
                    const int64_t inside = std::min({x, z, nodes - x, nodes - z, int64_t{8}});
                    const auto n = static_cast<size_t>(j * block_nodes + i);
                    block->shift[n] =
                        static_cast<int32_t>(static_cast<int64_t>(noise(x, z) % 3000) * inside / 8);
                    block->gain[n] = static_cast<uint16_t>(
                        unit_node_gain - static_cast<int64_t>((noise(x, z) >> 20) % 20000) * inside / 8);
                }
            field->set(std::move(block));
        }
    return field;
}

/// The same field with other values inside block (-1, -1) and (0, -2) and calm, open water in (1, 1).
std::shared_ptr<const LandField> sample_overlay(FieldId id, const std::shared_ptr<const LandField>& base) {
    auto field = std::make_shared<LandField>(id, base->step_log2());
    field->set_base(base);
    for (const BlockKey key : {BlockKey{-1, -1}, BlockKey{0, -2}}) {
        auto block = std::make_shared<LandBlock>(*base->find(key));
        for (size_t j = 1; j + 1 < block_nodes; ++j)
            for (size_t i = 1; i + 1 < block_nodes; ++i) {
                const size_t n = j * block_nodes + i;
                block->shift[n] = block->shift[n] * 3 / 4 + 300;
                block->gain[n] = static_cast<uint16_t>(block->gain[n] / 2 + 9000);
                block->orbit[n] = static_cast<uint16_t>(unit_node_orbit + (i * 37 + j * 91) % 700);
            }
        field->set(std::move(block));
    }
    auto calm = std::make_shared<LandBlock>();
    calm->key = {1, 1};
    calm->gain.fill(unit_node_gain);
    field->set(std::move(calm));
    return field;
}

/// Q.24 lattice units per microsecond.
int32_t leg_speed(double metres_per_second) {
    return static_cast<int32_t>(std::lround(metres_per_second * 1024e-6 * 16777216.0));
}

std::vector<CourseLeg> sample_course(const SampleBox& what) {
    const auto leg = [&](SeaTime from, LatticePoint origin, double heading) {
        return CourseLeg{from, 100'000'000'000, origin, leg_speed(what.speed * std::cos(heading)),
                         leg_speed(what.speed * std::sin(heading))};
    };
    std::vector<CourseLeg> course{leg(what.begin, what.origin, what.heading)};
    if (what.turn != 0.0) {
        const SeaTime at = what.begin + 900'000'000;
        course.push_back(leg(at, corner_at(course, at), what.heading + what.turn));
    }
    return course;
}

ShipWake sample_wake(double speed) {
    ShipWake wake;
    const double length = 2.0 * pi * speed * speed / 9.81;
    wake.transverse = static_cast<float>(length * 0.004);
    wake.diverging = static_cast<float>(length * 0.003);
    wake.choppiness = 0.8F;
    wake.inverse_length = static_cast<uint32_t>(0x1p40 / (length * 1024.0));
    wake.group_speed = static_cast<uint32_t>(leg_speed(speed * 0.5));
    return wake;
}

IrregularHeight sample_groups(double share, double heading) {
    IrregularHeight groups;
    const double turns = 4294967296.0 / (300.0 * 1024.0);
    groups.share = static_cast<uint16_t>(share * full_irregularity);
    groups.ukx = groups.vkz = static_cast<int32_t>(std::lround(turns * std::cos(heading)));
    groups.ukz = static_cast<int32_t>(std::lround(turns * std::sin(heading)));
    groups.vkx = -groups.ukz;
    groups.omega = static_cast<uint64_t>(10.0 / 300.0 * 1e-6 * 18446744073709551616.0);  // 10 m/s
    return groups;
}

WaveTrain sample_train(double wavelength, double heading, double amplitude, float choppiness,
                       uint32_t phase) {
    WaveTrain t;
    const double turns = 4294967296.0 / (wavelength * 1024.0);
    t.kx = static_cast<int32_t>(std::lround(turns * std::cos(heading)));
    t.kz = static_cast<int32_t>(std::lround(turns * std::sin(heading)));
    const double omega = std::sqrt(9.81 * 2.0 * pi / wavelength) / (2.0 * pi);  // turns per second
    t.omega = static_cast<uint64_t>(omega * 1e-6 * 18446744073709551616.0);
    t.phase = phase;
    t.amplitude = static_cast<float>(amplitude);
    t.choppiness = choppiness;
    return t;
}

}  // namespace

std::shared_ptr<const WorldBox> sample_box(const SampleBox& what, Dice& dice) {
    WaveTrainBox r;
    r.id = {what.id};
    r.first_train = {what.id * 256};
    r.origin = what.origin;
    r.ux = static_cast<int32_t>(std::lround(std::cos(what.heading) * 1073741824.0));
    r.uz = static_cast<int32_t>(std::lround(std::sin(what.heading) * 1073741824.0));
    r.length = to_lattice(what.length);
    r.width = to_lattice(what.width);
    r.ramp_rear = r.ramp_front = r.ramp_side = 512 << 10;
    r.begin = what.begin;
    r.build_up_us = what.build_up_us;
    r.end = what.end;
    r.decay_us = what.decay_us;
    r.front_speed = what.front_speed;
    r.raised_us = what.raised_us;
    r.fade_us = what.fade_us;
    r.roundness = static_cast<uint16_t>(what.roundness * full_roundness);
    if (what.share != 0.0) r.irregular = sample_groups(what.share, what.heading);
    if (what.speed != 0.0) r.course = sample_course(what);
    if (what.ship != 0.0) r.wake = sample_wake(what.ship);
    r.noise = what.noise;
    for (size_t i = 0; i < what.trains; ++i) {
        const double part =
            (static_cast<double>(i) + dice.between(0.0, 0.9)) / static_cast<double>(what.trains);
        const double wavelength = what.longest * std::pow(what.shortest / what.longest, part);
        const double amplitude = what.steepness / static_cast<double>(what.trains) * wavelength /
                                 (2.0 * pi * static_cast<double>(what.choppiness));
        r.trains.push_back(sample_train(wavelength, what.heading + dice.between(-0.8, 0.8), amplitude,
                                        what.choppiness,
                                        static_cast<uint32_t>(dice.between(0.0, 4294967295.0))));
    }
    std::vector<std::shared_ptr<const LandField>> fields;
    if (what.land) {
        for (uint32_t f = 0; f < 2; ++f)
            fields.push_back(sample_field({what.id * 10 + f + 1}, what.id * 77 + f));
        for (size_t i = 0; i < r.trains.size(); ++i)
            r.trains[i].field = fields[i < r.trains.size() / 2 ? 0 : 1]->id();
    }
    if (what.land && what.changed) {
        for (uint32_t f = 0; f < 2; ++f) {
            const FieldId id{what.id * 10 + f + 5};
            r.overlays.push_back({id, fields[f]->id()});
            fields.push_back(sample_overlay(id, fields[f]));
        }
        for (WaveTrain& train : r.trains) train.field.value += 4;
    }
    // Tests that speak of an impossible box would prove nothing.
    const auto valid = validate(r);
    TROCHOID_ASSERT(valid, "sample box {}: {}", what.id, valid ? "" : valid.error().message);
    auto box = std::make_shared<WorldBox>();
    box->sea = prepare(std::move(r), fields);
    return box;
}

WorldState sample_world(std::vector<SampleBox> boxes, uint32_t seed,
                        std::shared_ptr<const TerrainGrid> terrain) {
    Dice dice(seed);
    WorldState world;
    world.terrain = std::move(terrain);
    std::vector<std::shared_ptr<const PreparedBox>> sea;
    for (const SampleBox& b : boxes) {
        world.boxes[BoxId{b.id}] = sample_box(b, dice);
        sea.push_back(world.boxes[BoxId{b.id}]->sea);
    }
    world.sea = Sea(std::move(sea));
    return world;
}

WorldState eight_box_world(size_t trains_a_box) {
    std::vector<SampleBox> boxes;
    Dice dice(5);
    for (uint32_t id = 1; id <= 7; ++id) {
        SampleBox b;
        b.id = id;
        b.heading = dice.between(0.0, 2.0 * pi);
        b.length = dice.between(8000.0, 30000.0);
        b.width = dice.between(8000.0, 20000.0);
        // A corner such that x = z = 0 lies well inside.
        const double u = b.length * dice.between(0.25, 0.75);
        const double v = b.width * dice.between(0.25, 0.75);
        b.origin = {to_lattice(-u * std::cos(b.heading) + v * std::sin(b.heading)),
                    to_lattice(-u * std::sin(b.heading) - v * std::cos(b.heading))};
        b.trains = trains_a_box;
        b.steepness = 0.07;
        b.land = id == 3;
        if (id == 4) b.build_up_us = 2'000'000'000;  // half grown at 1000 s
        if (id == 5) b.front_speed = 17180 * 8;      // 8 m/s: its front has come 8 km at 1000 s
        boxes.push_back(b);
    }
    SampleBox swell;
    swell.id = 8;
    swell.trains = 4;
    swell.shortest = 80.0;
    swell.longest = 400.0;
    swell.steepness = 0.05;
    boxes.push_back(swell);
    return sample_world(boxes, 9);
}

WorldState live_world() {
    std::vector<SampleBox> boxes(6);
    for (uint32_t i = 0; i < 6; ++i) boxes[i].id = i + 1;
    SampleBox& storm = boxes[0];
    storm.origin = {to_lattice(-26'000.0), to_lattice(-9'000.0)};
    storm.heading = 0.25;
    storm.length = 14'000.0;
    storm.width = 9'000.0;
    storm.trains = 24;
    storm.steepness = 0.1;
    storm.share = 0.5;
    storm.speed = 21.0;
    storm.turn = -0.4;
    SampleBox& round = boxes[1];
    round.origin = {to_lattice(-6'000.0), to_lattice(-7'000.0)};
    round.heading = 0.1;
    round.length = 11'000.0;
    round.width = 12'000.0;
    round.steepness = 0.06;
    round.land = round.changed = true;
    round.roundness = 1.0;
    SampleBox& ship = boxes[2];
    ship.begin = {600'000'000};
    ship.origin = {to_lattice(-7'000.0), to_lattice(-1'500.0)};
    ship.heading = 0.0;
    ship.length = 6'000.0;
    ship.width = 4'600.0;
    ship.trains = 0;
    ship.speed = ship.ship = 8.0;
    SampleBox& noise = boxes[3];
    noise.trains = 0;
    noise.noise = {0.12F, 33'000, 3, 12, 21, false, 77};
    SampleBox& successor = boxes[4];
    successor.origin = {to_lattice(-4'000.0), to_lattice(-5'000.0)};
    successor.heading = 1.2;
    successor.length = successor.width = 9'000.0;
    successor.steepness = 0.04;
    successor.begin = {1'020'000'000};
    successor.raised_us = 800'000'000;
    successor.fade_us = 200'000'000;
    successor.build_up_us = 1'500'000'000;
    SampleBox& swell = boxes[5];
    swell.trains = 4;
    swell.shortest = 80.0;
    swell.longest = 400.0;
    swell.steepness = 0.05;
    return sample_world(boxes, 10);
}

std::shared_ptr<const TerrainGrid> island(double radius) {
    auto grid = std::make_shared<TerrainGrid>();
    grid->columns = grid->rows = 513;
    grid->origin_x = grid->origin_z = -256 * 32 * lattice_per_metre;
    for (int64_t row = 0; row < 513; ++row)
        for (int64_t column = 0; column < 513; ++column) {
            const double x = static_cast<double>(column - 256) * 32.0;
            const double z = static_cast<double>(row - 256) * 32.0;
            const double height = 8.0 + (radius - std::sqrt(x * x + z * z)) * 0.05;
            grid->heights.push_back(static_cast<int16_t>(std::clamp(height, -60.0, 300.0) * 32.0));
        }
    return grid;
}

ViewState looking(LatticePoint at, double altitude, double heading, double pitch) {
    ViewState v;
    v.position = at;
    v.altitude = static_cast<int32_t>(to_lattice(altitude));
    // Turn about y (clockwise from above: negative), then about the camera's own x.
    const double cy = std::cos(-heading / 2), sy = std::sin(-heading / 2);
    const double cp = std::cos(pitch / 2), sp = std::sin(pitch / 2);
    v.qx = static_cast<float>(cy * sp);
    v.qy = static_cast<float>(sy * cp);
    v.qz = static_cast<float>(-sy * sp);
    v.qw = static_cast<float>(cy * cp);
    return v;
}

CullKey key_around(const ViewState& view) {
    CullKey key;
    key.anchor = view;
    key.slack = static_cast<uint32_t>(8 * lattice_per_metre);
    key.slack_tangent = 0.15F;
    key.error_in_force_px = view.accepted_error_px;
    key.patch_limit = view.patch_budget;
    key.from = {1'000'000'000};
    key.until = {1'120'000'000};
    return key;
}

ViewState within_slack(const CullKey& key, Dice& dice) {
    ViewState v = key.anchor;
    double x = 1.0, y = 1.0, z = 1.0;
    const auto direction = [&] {
        do {
            x = dice.between(-1.0, 1.0), y = dice.between(-1.0, 1.0), z = dice.between(-1.0, 1.0);
        } while (x * x + y * y + z * z > 1.0 || x * x + y * y + z * z < 0.01);
        const double length = std::sqrt(x * x + y * y + z * z);
        x /= length, y /= length, z /= length;
    };
    direction();
    const double far = to_metres(key.slack) * 0.9999 * dice.between(0.0, 1.0);
    v.position.x += to_lattice(far * x);
    v.position.z += to_lattice(far * z);
    v.altitude += static_cast<int32_t>(to_lattice(far * y));
    direction();
    const double angle = std::atan(static_cast<double>(key.slack_tangent)) * 0.9999 * dice.between(0.0, 1.0);
    const double s = std::sin(angle / 2), c = std::cos(angle / 2);
    const double ax = v.qx, ay = v.qy, az = v.qz, aw = v.qw;
    v.qx = static_cast<float>(aw * s * x + ax * c + ay * s * z - az * s * y);
    v.qy = static_cast<float>(aw * s * y - ax * s * z + ay * c + az * s * x);
    v.qz = static_cast<float>(aw * s * z + ax * s * y - ay * s * x + az * c);
    v.qw = static_cast<float>(aw * c - ax * s * x - ay * s * y - az * s * z);
    return v;
}

Sea sea_of(const InterestState& state) {
    std::map<FieldId, std::shared_ptr<LandField>> fields;
    for (const auto& [key, block] : state.blocks) {
        auto& field = fields[key.field];
        if (!field) field = std::make_shared<LandField>(key.field, block.step_log2);
        field->set(block.block);
    }
    const std::vector<std::shared_ptr<const LandField>> all = [&] {
        std::vector<std::shared_ptr<const LandField>> out;
        for (const auto& [id, field] : fields) out.push_back(field);
        return out;
    }();
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (const auto& [id, record] : state.boxes) boxes.push_back(prepare(*record, all));
    return Sea(std::move(boxes));
}

}  // namespace trochoid
