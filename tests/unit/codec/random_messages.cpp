#include "tests/unit/codec/random_messages.hpp"

#include <algorithm>
#include <cmath>

namespace trochoid {

namespace {

LatticePoint place(Dice& d) {
    return {d.between(-world_bound, world_bound), d.between(-world_bound, world_bound)};
}
SeaTime sea_time(Dice& d) { return {d.between(-sea_time_bound, sea_time_bound)}; }
int64_t stamp(Dice& d) { return d.between(-(int64_t{1} << 56), int64_t{1} << 56); }

std::string text(Dice& d, int64_t most) {
    static constexpr const char* characters[] = {
        "a", "Z", " ", "7", "\xc3\xa4", "\xe6\xb5\xb7", "\xf0\x9f\x8c\x8a", "'"};
    std::string out;
    for (int64_t left = d.between(0, most); left >= 4; left = most - static_cast<int64_t>(out.size()))
        if (out += characters[d.between(0, 7)]; d.between(0, 20) == 0) break;
    return out;
}

ViewState view(Dice& d) {
    ViewState v;
    v.position = place(d);
    v.altitude = d.any<int32_t>();
    float q[4];
    double norm = 0.0;
    for (float& c : q) {
        c = d.real(-1.0F, 1.0F);
        norm += static_cast<double>(c) * static_cast<double>(c);
    }
    for (float& c : q) c = static_cast<float>(static_cast<double>(c) / std::sqrt(norm));
    v.qx = q[0], v.qy = q[1], v.qz = q[2], v.qw = q[3];
    v.tan_half_width = d.real(0.01F, 20.0F);
    v.tan_half_height = d.real(0.01F, 20.0F);
    v.viewport_width = static_cast<uint16_t>(d.between(1, 16384));
    v.viewport_height = static_cast<uint16_t>(d.between(1, 16384));
    v.vx = d.real(-10000.0F, 10000.0F);
    v.vy = d.real(-10000.0F, 10000.0F);
    v.vz = d.real(-10000.0F, 10000.0F);
    v.accepted_error_px = d.real(0.1F, 100.0F);
    v.patch_budget = static_cast<uint32_t>(d.between(1, 1024));
    return v;
}

std::vector<SyncRegion> regions(Dice& d) {
    std::vector<SyncRegion> out(static_cast<size_t>(d.between(0, 32)));
    for (SyncRegion& r : out) r = {place(d), static_cast<uint32_t>(d.between(0, 2048 * 1024))};
    return out;
}

StartWind wind(Dice& d) {
    StartWind w;
    w.speed = d.real(1.0F, 40.0F);
    w.towards_degrees = d.real(0.0F, 359.9F);
    w.origin = place(d);
    w.fetch = d.between(0, longest_side);
    w.width = d.between(0, longest_side);
    w.life_us = d.between(0, sea_time_bound);
    w.trains = static_cast<uint16_t>(d.between(1, 64) * 4);
    w.seed = d.bits();
    w.spectrum = static_cast<Spectrum>(d.between(0, 3));
    w.spreading = static_cast<Spreading>(d.between(0, 2));
    w.directions = static_cast<uint16_t>(d.coin() ? 0 : 1 << d.between(0, 2));
    w.reference_depth = d.coin() ? 0.0F : d.real(1.0F, 12000.0F);
    w.roundness = d.real(0.0F, 1.0F);
    w.irregularity = d.real(0.0F, 1.0F);
    w.noise = d.real(0.0F, 1.0F);
    w.vx = d.real(-70.0F, 70.0F);
    w.vz = d.real(-70.0F, 70.0F);
    return w;
}

StartShip ship(Dice& d) {
    StartShip s{place(d), d.real(0.0F, 359.9F), d.real(0.5F, 30.0F), d.real(1.0F, 500.0F), 0.0F, text(d, 64)};
    if (d.coin()) s.beam = s.length * d.real(0.0F, 1.0F);
    return s;
}

ChangeLand land_change(Dice& d) {
    ChangeLand c{{}, d.real(1.0F, 2000.0F), d.real(-200.0F, 200.0F), d.coin()};
    c.line.resize(static_cast<size_t>(d.between(2, 64)));
    for (LatticePoint& p : c.line) p = place(d);
    return c;
}

SeaClock clock(Dice& d) {
    return {static_cast<uint32_t>(d.between(1, UINT32_MAX)), sea_time(d), stamp(d),
            static_cast<uint32_t>(d.between(0, 16 << 16))};
}

ErrorCode code(Dice& d) {
    static constexpr ErrorCode some[] = {
        ErrorCode::none,           ErrorCode::wrong_magic,     ErrorCode::token_required,
        ErrorCode::rate_limited,   ErrorCode::client_closed,   ErrorCode::too_late,
        ErrorCode::internal_error, static_cast<ErrorCode>(499)};  // of a later version
    return some[d.between(0, 7)];
}

Goodbye goodbye(Dice& d) {
    return {code(d), text(d, 512), d.coin(), d.any<uint32_t>(), d.any<uint32_t>(), d.any<uint16_t>()};
}

Command command(Dice& d) {
    Command c{d.any<uint32_t>(), sea_time(d), d.coin(), ListBoxes{}};
    switch (d.between(0, 7)) {
        case 0: c.action = wind(d); break;
        case 3: c.action = ship(d); break;
        case 4: c.action = Steer{{d.any<uint32_t>()}, d.real(0.0F, 359.9F), d.real(0.0F, 100.0F)}; break;
        case 5: c.action = land_change(d); break;
        case 6: c.action = SkipTime{d.between(1, longest_skip_us)}; break;
        case 1: c.action = StopWind{{d.any<uint32_t>()}}; break;
        case 2: c.action = SetRate{static_cast<uint32_t>(d.between(0, 16 << 16))}; break;
        default: break;
    }
    return c;
}

CullKey cull_key(Dice& d) {
    CullKey k;
    k.anchor = view(d);
    k.slack = d.any<uint32_t>();
    k.slack_tangent = d.real(0.0F, 3.0F);
    k.error_in_force_px = d.real(0.1F, 100.0F);
    k.patch_limit = static_cast<uint32_t>(d.between(0, 1024));
    k.regions = regions(d);
    k.log_position = {d.bits()};
    k.from = sea_time(d);
    k.until = {d.between(k.from.us, sea_time_bound)};
    return k;
}

std::vector<uint8_t> ticket(Dice& d) {
    std::vector<uint8_t> out(static_cast<size_t>(d.between(0, longest_ticket)));
    for (uint8_t& b : out) b = d.any<uint8_t>();
    return out;
}

ClientHello client_hello(Dice& d) {
    ClientHello h;
    h.protocol_min = 1;
    h.protocol_max = static_cast<uint16_t>(d.between(1, 65535));
    h.model = d.any<uint16_t>();
    h.schema_hash = d.bits();
    h.software = text(d, 256);
    h.world = text(d, 256);
    h.token = text(d, 1024);
    h.view = view(d);
    h.regions = regions(d);
    h.clock_stamp_us = stamp(d);
    h.capabilities = d.bits();
    h.ticket = ticket(d);
    h.last_code = code(d);
    if (d.coin()) return h;
    ResumeState& r = h.resume.emplace();
    for (uint8_t& b : r.instance.bytes) b = d.any<uint8_t>();
    r.key = cull_key(d);
    r.state_hash = d.bits();
    r.log_position = {d.bits()};
    r.log_hash = d.bits();
    return h;
}

Desync desync(Dice& d) {
    const auto level = static_cast<uint8_t>(d.between(finest_patch_level, coarsest_patch_level));
    const int64_t most = int64_t{1} << (35 - level);
    return {d.any<uint32_t>(),
            d.any<uint32_t>(),
            sea_time(d),
            place(d),
            {level, static_cast<int32_t>(d.between(-most, most - 1)),
             static_cast<int32_t>(d.between(-most, most - 1))},
            {d.any<uint32_t>()},
            d.any<uint16_t>(),
            d.bits(),
            d.bits()};
}

ProbeReply probe_reply(Dice& d) {
    ProbeReply r{d.any<uint32_t>(), d.any<uint32_t>(), d.coin(), sea_time(d), {}};
    if (r.stale) return r;
    r.points.resize(static_cast<size_t>(d.between(0, most_probe_points)));
    for (ProbedPoint& point : r.points) {
        point.sample = d.bits();
        point.parts.resize(static_cast<size_t>(d.between(0, most_probe_parts / most_probe_points)));
        for (ProbePart& part : point.parts) part = {{d.any<uint32_t>()}, d.any<uint16_t>(), d.bits()};
    }
    return r;
}

ServerHello server_hello(Dice& d) {
    ServerHello h;
    h.protocol = static_cast<uint16_t>(d.between(1, 65535));
    h.model = d.any<uint16_t>();
    h.schema_hash = d.bits();
    h.software = text(d, 256);
    h.session = d.bits();
    h.world = text(d, 256);
    for (uint8_t& b : h.instance.bytes) b = d.any<uint8_t>();
    h.role = static_cast<Role>(d.between(0, 2));
    h.log_position = {d.bits()};
    h.clock = clock(d);
    h.client_stamp_us = stamp(d);
    h.server_now_us = stamp(d);
    h.limits.frame_after_login = static_cast<uint32_t>(d.between(1024, 1 << 24));
    h.limits.views_per_second = d.any<uint32_t>();
    h.limits.command_lead_ms = d.any<uint32_t>();
    h.challenge_seed = d.bits();
    h.challenge_count = static_cast<uint32_t>(d.between(0, 65536));
    h.projection = text(d, 4096);
    h.origin_lon = static_cast<double>(d.real(-180.0F, 180.0F));
    h.origin_lat = static_cast<double>(d.real(-90.0F, 90.0F));
    h.capabilities = d.bits();
    h.resumed = d.coin();
    h.ticket = ticket(d);
    h.ticket_life_ms = d.any<uint32_t>();
    h.last_session = d.bits();
    h.last_code = code(d);
    if (d.coin()) return h;
    TerrainInfo& t = h.terrain;
    t.spacing_log2 = static_cast<uint32_t>(d.between(0, 20));
    t.columns = static_cast<uint32_t>(d.between(2, 16385));
    t.rows = static_cast<uint32_t>(d.between(2, 16385));
    t.height_step_log2 = static_cast<int32_t>(d.between(0, 10));
    t.open_sea_depth = static_cast<int32_t>(d.between(-(1 << 24), -1));
    t.origin_x = d.between(-1000, 1000) << t.spacing_log2;
    t.origin_z = d.between(-1000, 1000) << t.spacing_log2;
    return h;
}

Delta delta(Dice& d) {
    Delta out;
    out.result = static_cast<uint32_t>(d.between(1, UINT32_MAX));
    out.piece = d.any<uint16_t>();
    out.last = d.coin();
    out.base = static_cast<uint32_t>(d.between(0, int64_t{out.result} - 1));
    out.base_hash = d.bits();
    out.state_hash = d.bits();
    out.key = cull_key(d);
    out.watermark = sea_time(d);
    const auto few = [&] { return static_cast<size_t>(d.between(0, 4)); };
    out.change = random_change(d, few(), few(), few() * 8, few());
    if (d.coin()) set_planes(out);
    return out;
}

TerrainTile tile(Dice& d) {
    TerrainTile t;
    t.key.level = static_cast<uint8_t>(d.between(0, 8));
    t.key.x = static_cast<int32_t>(d.between(0, (256 >> t.key.level) - 1));
    t.key.z = static_cast<int32_t>(d.between(0, (256 >> t.key.level) - 1));
    const auto grid_spacing = static_cast<uint32_t>(d.between(0, 16));
    t.spacing_log2 = grid_spacing + t.key.level;
    const int64_t side = int64_t{64} << t.spacing_log2;
    t.origin_x = (d.between(-10000, 10000) << grid_spacing) + t.key.x * side;
    t.origin_z = (d.between(-10000, 10000) << grid_spacing) + t.key.z * side;
    t.height_step_log2 = static_cast<int32_t>(d.between(0, 10));
    const bool rough = d.between(0, 3) == 0;
    for (int32_t i = 0; i < 65 * 65; ++i)
        t.heights.push_back(rough ? d.any<int16_t>()
                                  : static_cast<int16_t>((i % 65) * (i / 65) - 900 + d.between(0, 2)));
    return t;
}

BoxSummary summary(Dice& d) {
    return {{d.any<uint32_t>()},
            text(d, 256),
            sea_time(d),
            sea_time(d),
            d.between(0, sea_time_bound),
            d.any<uint16_t>(),
            d.real(0.0F, 20.0F),
            d.real(0.0F, 40.0F),
            d.real(0.0F, 360.0F),
            d.real(0.0F, 1.0F),
            static_cast<BoxKind>(d.between(0, 3)),
            place(d),
            d.real(-100.0F, 100.0F),
            d.real(-100.0F, 100.0F),
            d.coin() ? Hull{} : Hull{d.real(10.0F, 500.0F), d.real(0.5F, 10.0F)}};
}

SurfaceSample sample(Dice& d) {
    const auto f = [&] { return d.real(-100.0F, 100.0F); };
    return {f(), f(), f(), f(), f(), f(), f(), f(), f(), f(), f(), f(), f(), f(), f()};
}

WaveRay ray(Dice& d) {
    WaveRay r{place(d), place(d), {}};
    r.points.resize(static_cast<size_t>(d.between(0, 6)));
    for (ActionPoint& p : r.points) p = {place(d), static_cast<ActionKind>(d.between(1, 4))};
    return r;
}

template <class T, class Make>
std::vector<T> list(Dice& d, int64_t most, Make make) {
    std::vector<T> out;
    for (int64_t n = d.between(0, most); n > 0; --n) out.push_back(make(d));
    return out;
}

CourseLeg leg(Dice& d, SeaTime from) {
    const auto near = [&] { return d.between(-(int64_t{1} << 34), int64_t{1} << 34); };
    // Below 2^34 lattice units: it ends inside the world.
    return {from,
            d.between(0, int64_t{1} << 36),
            {near(), near()},
            static_cast<int32_t>(d.between(-(1 << 20), 1 << 20)),
            static_cast<int32_t>(d.between(-(1 << 20), 1 << 20))};
}

std::vector<CourseLeg> course(Dice& d, int64_t legs) {
    std::vector<CourseLeg> out;
    for (SeaTime from{d.between(-1000, 1000)}; legs > 0; --legs) {
        out.push_back(leg(d, from));
        from = from + d.between(1, int64_t{1} << 40);
    }
    return out;
}

IrregularHeight irregular(Dice& d) {
    const auto k = [&] { return static_cast<int32_t>(d.between(1, INT32_MAX)); };
    return {static_cast<uint16_t>(d.between(0, full_irregularity)),
            k(),
            -k(),
            k(),
            k(),
            d.bits(),
            d.any<uint32_t>(),
            d.any<uint32_t>()};
}

SurfaceNoise noise(Dice& d) {
    const auto octaves = d.between(1, 12);
    return {d.coin() ? 0.0F : d.real(0.001F, 32.0F),
            d.any<uint16_t>(),
            static_cast<uint8_t>(octaves),
            static_cast<uint8_t>(d.between(std::max(int64_t{6}, octaves + 3), 20)),
            static_cast<uint8_t>(d.between(std::max(int64_t{14}, octaves + 11), 40)),
            d.coin(),
            d.any<uint32_t>()};
}

ShipWake wake(Dice& d) {
    return {d.real(0.001F, 32.0F), d.real(0.001F, 32.0F), d.real(0.0F, 4.0F),
            static_cast<uint32_t>(d.between(1 << 20, int64_t{1} << 31)),
            static_cast<uint32_t>(d.between(1, fastest_leg))};
}

/// Each of the things that a plain box is without, or not.
void add_extras(Dice& d, WaveTrainBox& b) {
    if (d.coin()) {
        b.roundness = static_cast<uint16_t>(d.between(0, full_roundness));
        for (WaveTrain& t : b.trains) t.kx = t.kx % (1 << 20) + 1, t.kz %= 1 << 20;  // of 1 m and more
    }
    if (d.coin()) b.raised_us = d.between(0, sea_time_bound - std::max(b.begin.us, int64_t{0}));
    if (d.coin()) b.fade_us = d.between(0, int64_t{1} << 39);
    if (d.coin())
        for (uint32_t field = 2; field <= 3; ++field) b.overlays.push_back({{field}, {field - 1}});
    if (d.coin()) b.course = course(d, d.coin() ? 1 : d.between(2, 64));
    if (d.coin()) b.irregular = irregular(d);
    if (d.coin()) b.noise = noise(d);
    if (!b.course.empty()) b.origin = b.course.front().origin;
}

}  // namespace

WaveTrainBox random_ship(Dice& d, uint32_t id) {
    WaveTrainBox b;
    b.id = {id};
    b.first_train = {static_cast<uint32_t>(d.between(1, 1 << 30))};
    b.length = d.between(1 << 20, longest_side);
    b.width = d.between(1 << 20, longest_side);
    b.begin = {d.between(0, 1'000'000)};
    b.end = {d.between(b.begin.us, sea_time_bound)};
    b.decay_us = d.between(0, int64_t{1} << 39);
    CourseLeg along = leg(d, b.begin);
    along.vx = static_cast<int32_t>(d.between(1, 1 << 20));
    along.vz = 0;
    b.course = {along};
    b.origin = along.origin;
    b.wake = wake(d);
    b.wake.group_speed = static_cast<uint32_t>(along.vx) / 2 + 1;
    if (d.coin()) b.hull = {d.real(10.0F, 500.0F), d.real(0.5F, 10.0F)};
    return b;
}

WaveTrainBox random_box(Dice& d, uint32_t id, size_t trains) {
    WaveTrainBox b;
    b.id = {id};
    b.first_train = {static_cast<uint32_t>(d.between(1, 1 << 30))};
    b.origin = place(d);
    if (d.coin()) b.ux = 858'993'459, b.uz = -644'245'094;  // (0.8, -0.6)
    b.length = d.between(0, longest_side);
    b.width = d.between(1 << 12, longest_side);
    b.ramp_rear = static_cast<int32_t>(d.between(shortest_ramp, longest_side));
    b.ramp_front = static_cast<int32_t>(d.between(shortest_ramp, longest_side));
    b.ramp_side = static_cast<int32_t>(d.between(shortest_ramp, longest_side));
    b.begin = sea_time(d);
    b.build_up_us = d.between(0, int64_t{1} << 39);
    b.end = {d.between(b.begin.us, sea_time_bound)};
    b.decay_us = d.between(0, int64_t{1} << 39);
    b.front_speed = d.any<uint32_t>();
    b.gain_max = d.any<uint16_t>();
    const bool land = d.coin();
    for (size_t i = 0; i < trains; ++i) {
        WaveTrain t;
        t.kx = static_cast<int32_t>(d.between(1, INT32_MAX));
        t.kz = static_cast<int32_t>(d.between(-INT32_MAX, INT32_MAX));
        t.omega = d.bits();
        t.phase = d.any<uint32_t>();
        t.amplitude = i % 5 == 4 ? 0.0F : d.real(0.001F, 32.0F);
        t.choppiness = d.real(0.0F, 4.0F);
        if (land) t.field = {static_cast<uint32_t>(d.between(0, 3))};
        b.trains.push_back(t);
    }
    if (d.coin()) add_extras(d, b);
    return b;
}

LandBlock random_block(Dice& d, BlockKey key) {
    LandBlock b;
    b.key = key;
    const int64_t steep = int64_t{1} << d.between(0, 17);
    const int64_t offset = d.between(-(1 << 20), 1 << 20);
    for (int i = 0; i < block_nodes * block_nodes; ++i) {
        const int x = i % block_nodes;
        const int z = i / block_nodes;
        const auto at = static_cast<size_t>(i);
        b.shift[at] = static_cast<int32_t>(offset + (x * x - 3 * z) * steep + d.between(0, steep));
        b.gain[at] =
            d.between(0, 9) == 0 ? d.any<uint16_t>() : static_cast<uint16_t>(unit_node_gain + 50 * x * z);
    }
    if (d.coin())
        for (size_t i = 0; i < b.orbit.size(); ++i)
            b.orbit[i] =
                d.between(0, 9) == 0 ? d.any<uint16_t>() : static_cast<uint16_t>(unit_node_orbit + 9 * i);
    return b;
}

InterestDelta random_change(Dice& d, size_t boxes, size_t blocks, size_t patches, size_t removals) {
    InterestDelta c;
    uint32_t id = 0;
    for (size_t i = 0; i < boxes; ++i) {
        id += static_cast<uint32_t>(d.between(1, 1000));
        const bool ship = d.between(0, 5) == 0;
        c.boxes.push_back(std::make_shared<WaveTrainBox>(
            ship ? random_ship(d, id) : random_box(d, id, static_cast<size_t>(d.between(1, 256)))));
    }
    for (size_t i = 0; i < blocks; ++i) {
        const auto step = static_cast<uint8_t>(d.between(12, 20));
        const int64_t most = int64_t{1} << (31 - step);
        const BlockKey key{static_cast<int32_t>(d.between(-most, most)),
                           static_cast<int32_t>(d.between(-most, most))};
        c.blocks.push_back({{static_cast<uint32_t>(d.between(1, 9))},
                            step,
                            std::make_shared<LandBlock>(random_block(d, key)),
                            0});
    }
    const auto patch_key = [&] {
        const auto level = static_cast<uint8_t>(d.between(finest_patch_level, coarsest_patch_level));
        const int64_t most = int64_t{1} << (35 - level);
        return PatchKey{level, static_cast<int32_t>(d.between(-most, most - 1)),
                        static_cast<int32_t>(d.between(-most, most - 1))};
    };
    for (size_t i = 0; i < patches; ++i) {
        PatchDescriptor p{patch_key(), {}, d.real(0.0F, 2.0F), d.real(0.0F, 3.0F)};
        for (uint32_t box = 1; box < 12; ++box)
            if (d.coin()) p.boxes.push_back({{box * 7}, static_cast<uint16_t>(d.between(0, 256))});
        c.patches.push_back(std::move(p));
    }
    for (size_t i = 0; i < removals; ++i) {
        c.removed_boxes.push_back({d.any<uint32_t>()});
        c.removed_blocks.push_back({{d.any<uint32_t>()}, {d.any<int32_t>(), d.any<int32_t>()}});
        c.removed_patches.push_back(patch_key());
    }
    return c;
}

void set_planes(Delta& delta) {
    delta.patch_form = PatchForm::planes;
    std::vector<PatchDescriptor>& patches = delta.change.patches;
    const auto key_of = [](const PatchDescriptor& patch) { return patch.key; };
    std::ranges::sort(patches, {}, key_of);
    const auto twice = std::ranges::unique(patches, {}, key_of);
    patches.erase(twice.begin(), twice.end());
    std::vector<PatchKey>& removed = delta.change.removed_patches;
    std::ranges::sort(removed);
    removed.erase(std::unique(removed.begin(), removed.end()), removed.end());
}

ClientMessage random_client_message(Dice& d, size_t index) {
    switch (index) {
        case 0: return client_hello(d);
        case 1: return ViewUpdate{d.any<uint32_t>(), view(d)};
        case 2: return SyncRegions{d.any<uint32_t>(), regions(d)};
        case 3: return ClockRequest{d.any<uint32_t>(), stamp(d)};
        case 4: {
            Ack a{d.any<uint32_t>(), d.bits(), d.any<uint32_t>(), {}};
            if (d.coin()) a.known_answer = d.bits();
            return a;
        }
        case 5: return command(d);
        case 6: return SampleRequest{d.any<uint32_t>(), sea_time(d), list<LatticePoint>(d, 240, place)};
        case 7: return RaysRequest{d.any<uint32_t>(), {d.any<uint32_t>()}};
        case 9: {
            const auto points = static_cast<size_t>(d.between(1, most_probe_points));
            Probe probe{d.any<uint32_t>(), static_cast<uint32_t>(d.between(1, UINT32_MAX)), sea_time(d), {}};
            for (size_t i = 0; i < points; ++i) probe.points.push_back(place(d));
            return probe;
        }
        case 10: return desync(d);
        default: return goodbye(d);
    }
}

ServerMessage random_server_message(Dice& d, size_t index) {
    switch (index) {
        case 0: return server_hello(d);
        case 1: {
            ClockReply r{d.any<uint32_t>(), stamp(d),    stamp(d),   0,
                         clock(d),          sea_time(d), {d.bits()}, d.bits()};
            r.server_sent_us = r.server_received_us;
            r.verdict = static_cast<Verdict>(d.bits() % 3);
            return r;
        }
        case 2: return delta(d);
        case 3: return TerrainTiles{list<TerrainTile>(d, 2, tile)};
        case 4:
            return CommandReply{d.any<uint32_t>(), code(d),    text(d, 512),
                                sea_time(d),       {d.bits()}, {d.any<uint32_t>()}};
        case 5: return BoxList{d.any<uint32_t>(), sea_time(d), list<BoxSummary>(d, 20, summary), d.coin()};
        case 6:
            return SampleReply{
                d.any<uint32_t>(), sea_time(d), {d.bits()}, list<SurfaceSample>(d, 240, sample)};
        case 7: return RaysReply{d.any<uint32_t>(), {d.any<uint32_t>()}, list<WaveRay>(d, 40, ray), d.coin()};
        case 9: return probe_reply(d);
        default: return goodbye(d);
    }
}

LogEvent random_event(Dice& d, size_t index) {
    LogEvent e{d.bits(), sea_time(d), BoxEnding{{d.any<uint32_t>()}, sea_time(d)}};
    if (index == 0)
        e.what = BoxStarted{random_box(d, d.any<uint32_t>() | 1U, static_cast<size_t>(d.between(1, 256))),
                            text(d, 256), wind(d)};
    if (index == 2) e.what = ClockChanged{clock(d)};
    if (index == 3) e.what = BoxSteered{{d.any<uint32_t>()}, leg(d, sea_time(d))};
    if (index == 4) {
        LandChanged changed{land_change(d), {}};
        for (uint32_t i = 1; i < 5; ++i)
            changed.boxes.push_back(
                {{10 * i}, random_box(d, 100 + i, static_cast<size_t>(d.between(1, 40)))});
        for (int64_t i = d.between(0, 3); i > 0; --i) changed.also.push_back(land_change(d));
        e.what = changed;
    }
    if ((d.bits() & 1) != 0) e.present = sea_time(d);
    return e;
}

bool same(const InterestDelta& a, const InterestDelta& b) {
    const auto same_box = [](const auto& x, const auto& y) { return *x == *y; };
    const auto same_block = [](const FieldBlock& x, const FieldBlock& y) {
        return x.field == y.field && x.step_log2 == y.step_log2 && *x.block == *y.block;
    };
    return std::equal(a.boxes.begin(), a.boxes.end(), b.boxes.begin(), b.boxes.end(), same_box) &&
           std::equal(a.blocks.begin(), a.blocks.end(), b.blocks.begin(), b.blocks.end(), same_block) &&
           a.patches == b.patches && a.removed_boxes == b.removed_boxes &&
           a.removed_blocks == b.removed_blocks && a.removed_patches == b.removed_patches;
}

namespace {

bool same_message(const Delta& a, const Delta& b) {
    return a.result == b.result && a.piece == b.piece && a.last == b.last && a.base == b.base &&
           a.base_hash == b.base_hash && a.state_hash == b.state_hash && a.key == b.key &&
           a.watermark == b.watermark && same(a.change, b.change);
}

template <class T>
bool same_message(const T& a, const T& b) {
    return a == b;
}

}  // namespace

bool same(const ServerMessage& a, const ServerMessage& b) {
    if (a.index() != b.index()) return false;
    return std::visit([&](const auto& m) { return same_message(m, std::get<std::decay_t<decltype(m)>>(b)); },
                      a);
}

}  // namespace trochoid
