#include <limits>

#include "tests/fuzz/hostile/hostile_vectors.hpp"
#include "tests/unit/codec/random_messages.hpp"

// Values that are legal one by one and contradict each other.
namespace trochoid {

namespace {

using Direction = HostileVector::Direction;
constexpr ErrorCode range = ErrorCode::value_out_of_range;

/// Each contradiction is put into this many legal messages.
constexpr uint64_t rounds = 12;

class Pairs {
public:
    explicit Pairs(std::vector<HostileVector>& out) : out_(out) {}

    template <class Message, class Change>
    void client(const char* what, Change change, ErrorCode code = range) {
        for (uint64_t round = 0; round < rounds; ++round) {
            Dice dice(9000 + round);
            Message message{};
            change(dice, message);
            give(Direction::client, what, code, encode(ClientMessage{message}));
        }
    }
    template <class Change>
    void server(const char* what, size_t kind, Change change, ErrorCode code = range) {
        for (uint64_t round = 0; round < rounds; ++round) {
            Dice dice(9100 + round);
            ServerMessage message = random_server_message(dice, kind);
            change(dice, message);
            give(Direction::server, what, code, encode(message));
        }
    }
    template <class Change>
    void box(const char* what, Change change, ErrorCode code = range) {
        for (uint64_t round = 0; round < rounds; ++round) {
            Dice dice(9200 + round);
            WaveTrainBox made = random_box(dice, 1 + static_cast<uint32_t>(round), 3);
            made.roundness = 0;  // needs what some of the changes take away
            change(dice, made);
            Delta delta = std::get<Delta>(random_server_message(dice, 2));
            delta.change = {};
            delta.change.boxes = {std::make_shared<WaveTrainBox>(made)};
            give(Direction::server, what, code, encode(ServerMessage{delta}));
            give(Direction::event, what, code, encode(LogEvent{1, {5}, BoxStarted{made, "a box", {}}}));
        }
    }
    template <class Change>
    void delta(const char* what, Change change, ErrorCode code = range) {
        server(
            what, 2,
            [&](Dice& dice, ServerMessage& message) {
                Delta& d = std::get<Delta>(message);
                d.patch_form = PatchForm::lists;
                d.change = random_change(dice, 2, 2, 3, 1);
                for (PatchDescriptor& p : d.change.patches) p.boxes = {{{1}, 2}, {{5}, 6}};
                change(dice, d);
            },
            code);
    }
    /// Of a delta whose patches are planes.
    template <class Change>
    void planes(const char* what, Change change, ErrorCode code = range) {
        delta(
            what,
            [&](Dice& dice, Delta& d) {
                d.change.patches[2].key = {20, 4, 4};
                d.change.removed_patches = {{18, 5, -6}, {19, 5, -6}};
                set_planes(d);
                change(dice, d);
            },
            code);
    }
    void give(Direction direction, const char* what, ErrorCode code, Bytes bytes) {
        out_.push_back({direction, what, "contradiction", code, std::move(bytes)});
    }

private:
    std::vector<HostileVector>& out_;
};

template <class Message, size_t kind>
auto random_client(Dice& dice) {
    return std::get<Message>(random_client_message(dice, kind));
}

void add_client_pairs(Pairs& p) {
    p.client<ClientHello>("hello: protocol_min above protocol_max", [](Dice& d, ClientHello& h) {
        h = random_client<ClientHello, 0>(d);
        h.protocol_max = static_cast<uint16_t>(d.between(0, 1000));
        h.protocol_min = static_cast<uint16_t>(d.between(h.protocol_max + 1, 65535));
    });
    p.client<ClientHello>("hello: a resumed key that ends before it begins", [](Dice& d, ClientHello& h) {
        do h = random_client<ClientHello, 0>(d);
        while (!h.resume);
        h.resume->key.from = {d.between(1, 1000)};
        h.resume->key.until = {d.between(-1000, 0)};
    });
    p.client<Probe>("probe: no points",
                    [](Dice& d, Probe& m) { m = random_client<Probe, 9>(d), m.points.clear(); });
    p.client<Desync>("desync: a patch outside the world for its level", [](Dice& d, Desync& m) {
        m = random_client<Desync, 10>(d);
        const int32_t most = int32_t{1} << (35 - m.patch.level);
        (d.coin() ? m.patch.x : m.patch.z) = d.coin() ? most : -most - 1;
    });
    p.client<Command>("wind: directions do not divide the trains", [](Dice& d, Command& c) {
        StartWind w;
        w.trains = static_cast<uint16_t>(d.between(3, 256));
        w.directions = static_cast<uint16_t>(w.trains - 1);
        c.action = w;
    });
    p.client<Command>("wind: more directions than trains", [](Dice& d, Command& c) {
        StartWind w;
        w.trains = static_cast<uint16_t>(d.between(1, 256));
        w.directions = static_cast<uint16_t>(2 * w.trains);
        c.action = w;
    });
    p.client<Command>("wind: faster than 100 m/s along the diagonal", [](Dice& d, Command& c) {
        StartWind w;
        w.vx = d.real(75.0F, 100.0F);
        w.vz = -d.real(75.0F, 100.0F);
        c.action = w;
    });
    p.client<Command>("wind: a reference depth between none and 1 m", [](Dice& d, Command& c) {
        StartWind w;
        w.reference_depth = d.real(0.001F, 0.999F);
        c.action = w;
    });
    p.client<Command>("ship: broader than long", [](Dice& d, Command& c) {
        const float length = d.real(1.0F, 400.0F);
        c.action = StartShip{{0, 0}, 0.0F, 5.0F, length, length * d.real(1.01F, 1.2F), "broad"};
    });
    p.client<Command>("land: a line of less than 2 points", [](Dice& d, Command& c) {
        c.action = ChangeLand{std::vector<LatticePoint>(static_cast<size_t>(d.between(0, 1))), 20.0F, 3.0F,
                              d.coin()};
    });
}

void add_server_pairs(Pairs& p) {
    p.server("hello: terrain of one row or column", 0, [](Dice& d, ServerMessage& m) {
        TerrainInfo& t = std::get<ServerHello>(m).terrain;
        t = {0, 0, 10, 2, 2, 5, -100};
        (d.coin() ? t.columns : t.rows) = 1;
    });
    p.server("hello: terrain that leaves the world", 0, [](Dice& d, ServerMessage& m) {
        std::get<ServerHello>(m).terrain = {
            (int64_t{1} << 34) + (d.between(1, 9) << 20), 0, 20, 16385, 2, 5, -100};
    });
    p.server("hello: terrain whose origin is not on its grid", 0, [](Dice& d, ServerMessage& m) {
        std::get<ServerHello>(m).terrain = {d.between(1, 1023), 0, 10, 5, 5, 5, -100};
    });
    p.server("hello: terrain with an open sea above water", 0,
             [](Dice&, ServerMessage& m) { std::get<ServerHello>(m).terrain = {0, 0, 10, 5, 5, 5, 0}; });
    p.server("clock reply: sent before it was received", 1, [](Dice& d, ServerMessage& m) {
        auto& r = std::get<ClockReply>(m);
        r.server_received_us = d.between(0, 1000);
        r.server_sent_us = r.server_received_us - d.between(1, 1'000'000);
    });
    p.server("tile: beyond its level", 3, [](Dice& d, ServerMessage& m) {
        TerrainTile tile;
        tile.key = {4, d.coin() ? 16 : 0, 16};
        tile.spacing_log2 = 10;
        tile.heights.resize(65 * 65);
        m = TerrainTiles{{tile}};
    });
    p.server("tile: finer than its level can be", 3, [](Dice& d, ServerMessage& m) {
        TerrainTile tile;
        tile.key = {5, 0, 0};
        tile.spacing_log2 = static_cast<uint32_t>(d.between(0, 4));
        tile.heights.resize(65 * 65);
        m = TerrainTiles{{tile}};
    });
    p.server("tile: an origin that is not on its grid", 3, [](Dice& d, ServerMessage& m) {
        TerrainTile tile;
        tile.key = {0, 0, 0};
        tile.spacing_log2 = 10;
        tile.origin_x = d.between(1, 1023);
        tile.heights.resize(65 * 65);
        m = TerrainTiles{{tile}};
    });
    p.server("probe reply: stale, but with points", 9, [](Dice& d, ServerMessage& m) {
        ProbeReply r;
        r.stale = true;
        r.points.resize(static_cast<size_t>(d.between(1, 16)));
        m = r;
    });
    p.server(
        "box list: more than 1,024", 5,
        [](Dice& d, ServerMessage& m) {
            BoxList list;
            list.boxes.resize(static_cast<size_t>(d.between(1025, 1100)));
            m = list;
        },
        ErrorCode::too_many_boxes);
}

void add_delta_pairs(Pairs& p) {
    p.delta("delta: base not before result", [](Dice& d, Delta& m) {
        m.base = m.result + static_cast<uint32_t>(d.between(0, 9)), m.result = std::min(m.result, m.base),
        m.result = std::max(m.result, 1U), m.base = std::max(m.base, m.result);
    });
    p.delta("delta: a key that ends before it begins", [](Dice& d, Delta& m) {
        m.key.from = {d.between(1, 1000)};
        m.key.until = {d.between(-1000, 0)};
    });
    p.delta("delta: boxes not by ascending id",
            [](Dice&, Delta& m) { std::swap(m.change.boxes[0], m.change.boxes[1]); });
    p.delta("delta: a box twice", [](Dice&, Delta& m) { m.change.boxes[1] = m.change.boxes[0]; });
    p.delta("delta: a patch's boxes not by ascending id", [](Dice& d, Delta& m) {
        m.change.patches[static_cast<size_t>(d.between(0, 2))].boxes = {{{5}, 1}, {{1}, 1}};
    });
    p.delta("delta: a patch's box twice", [](Dice& d, Delta& m) {
        m.change.patches[static_cast<size_t>(d.between(0, 2))].boxes = {{{5}, 1}, {{5}, 1}};
    });
    p.delta("delta: a patch outside the world for its level", [](Dice& d, Delta& m) {
        const auto level = static_cast<uint8_t>(d.between(16, 26));
        m.change.patches[0].key = {level, 0, d.coin() ? 1 << (35 - level) : -(1 << (35 - level)) - 1};
    });
    p.delta("delta: a removed patch outside the world for its level", [](Dice& d, Delta& m) {
        const auto level = static_cast<uint8_t>(d.between(16, 26));
        m.change.removed_patches[0] = {level, d.coin() ? 1 << (35 - level) : -(1 << (35 - level)) - 1, 0};
    });
    p.delta("delta: a land block outside the world for its step", [](Dice& d, Delta& m) {
        const auto step = static_cast<uint8_t>(d.between(13, 20));
        LandBlock block = *m.change.blocks[0].block;
        block.key = {(1 << (31 - step)) + 1, 0};
        m.change.blocks[0].step_log2 = step;
        m.change.blocks[0].block = std::make_shared<LandBlock>(block);
    });
    p.delta("delta: a land block with a shift that jumps", [](Dice& d, Delta& m) {
        LandBlock block = *m.change.blocks[0].block;
        block.shift[static_cast<size_t>(d.between(0, 288))] = (1 << 30) - 1;
        block.shift[0] = 0, block.shift[288] = 0;
        block.shift[static_cast<size_t>(d.between(20, 250))] = -(1 << 30) + 1;
        m.change.blocks[0].block = std::make_shared<LandBlock>(block);
    });
    p.delta(
        "delta: more than 1,024 boxes",
        [](Dice& d, Delta& m) {
            m.change.boxes.clear();
            WaveTrainBox box = random_box(d, 1, 1);
            for (uint32_t id = 1; id <= 1025; ++id)
                box.id = {id}, m.change.boxes.push_back(std::make_shared<WaveTrainBox>(box));
        },
        ErrorCode::too_many_boxes);
}

void add_plane_pairs(Pairs& p) {
    p.planes("planes: patches not by ascending key",
             [](Dice&, Delta& m) { std::swap(m.change.patches[1], m.change.patches[2]); });
    p.planes("planes: a patch twice", [](Dice&, Delta& m) { m.change.patches[1] = m.change.patches[0]; });
    p.planes("planes: removed patches not by ascending key",
             [](Dice&, Delta& m) { std::swap(m.change.removed_patches[0], m.change.removed_patches[1]); });
    p.planes("planes: a removed patch twice",
             [](Dice&, Delta& m) { m.change.removed_patches[1] = m.change.removed_patches[0]; });
    p.planes("planes: a patch of no level", [](Dice& d, Delta& m) {
        m.change.patches[2].key.level = static_cast<uint8_t>(d.between(27, 255));
    });
    p.planes("planes: a removed patch of no level", [](Dice& d, Delta& m) {
        m.change.removed_patches[0].level = static_cast<uint8_t>(d.between(0, 14));
    });
    p.planes("planes: a patch outside the world for its level", [](Dice& d, Delta& m) {
        const auto level = static_cast<uint8_t>(d.between(16, 26));
        m.change.patches = {
            {{level, 0, d.coin() ? 1 << (35 - level) : -(1 << (35 - level)) - 1}, {}, 0.0F, 0.0F}};
    });
    p.planes("planes: more trains than a box has", [](Dice& d, Delta& m) {
        m.change.patches[1].boxes[1].train_count = static_cast<uint16_t>(d.between(257, 65534));
    });
    p.planes("planes: a bound below 0", [](Dice& d, Delta& m) {
        m.change.patches[static_cast<size_t>(d.between(0, 2))].left_out = -d.real(0.0F, 2.0F);
    });
    p.planes(
        "planes: a bound that is no number",
        [](Dice& d, Delta& m) {
            m.change.patches[static_cast<size_t>(d.between(0, 2))].height_error =
                (d.coin() ? 1.0F : -1.0F) * std::numeric_limits<float>::quiet_NaN();
        },
        ErrorCode::not_finite);
    p.planes("planes: more than 1,024 patches", [](Dice&, Delta& m) {
        m.change.patches.clear();
        for (int32_t x = 0; x <= 1024; ++x) m.change.patches.push_back({{16, x, 0}, {}, 0.0F, 0.0F});
    });
    p.planes("planes: more than 65,536 boxes together", [](Dice&, Delta& m) {
        std::vector<PatchBox> boxes;
        for (uint32_t box = 1; box <= 1024; ++box) boxes.push_back({{box}, 1});
        m.change.patches.clear();
        for (int32_t x = 0; x <= 64; ++x) m.change.patches.push_back({{16, x, 0}, boxes, 0.0F, 0.0F});
    });
}

void add_box_pairs(Pairs& p) {
    p.box("box: ends before it begins",
          [](Dice& d, WaveTrainBox& b) { b.begin = {5}, b.end = {5 - d.between(1, 99)}; });
    p.box("box: no direction", [](Dice&, WaveTrainBox& b) { b.ux = b.uz = 0; });
    p.box("box: a direction that is too long", [](Dice& d, WaveTrainBox& b) {
        b.ux = 1 << 30, b.uz = static_cast<int32_t>(d.between(1 << 21, 1 << 30));
    });
    p.box("box: a direction that is too short", [](Dice& d, WaveTrainBox& b) {
        b.ux = static_cast<int32_t>(d.between(0, (1 << 30) - 1024)), b.uz = 0;
    });
    p.box("box: a train without a wave vector", [](Dice& d, WaveTrainBox& b) {
        auto& t = b.trains[static_cast<size_t>(d.between(0, 2))];
        t.kx = t.kz = 0;
    });
    p.box("box: an amplitude below 2^-20 m",
          [](Dice& d, WaveTrainBox& b) { b.trains[1].amplitude = d.real(0x1p-30F, 0x1p-21F); });
    p.box("box: an amplitude of -0", [](Dice&, WaveTrainBox& b) { b.trains[2].amplitude = -0.0F; });
    p.box("box: nothing in it", [](Dice&, WaveTrainBox& b) { b.trains.clear(), b.noise = {}, b.wake = {}; });
    p.box("box: round waves without a width", [](Dice& d, WaveTrainBox& b) {
        b.roundness = static_cast<uint16_t>(d.between(1, 32768)), b.width = 0;
    });
    p.box("box: round waves shorter than 0.125 m", [](Dice& d, WaveTrainBox& b) {
        b.roundness = static_cast<uint16_t>(d.between(1, 32768)), b.width = 1 << 20, b.trains[0].kx = 1 << 26;
    });
    p.box("box: an overlay on itself or on a later field", [](Dice& d, WaveTrainBox& b) {
        const auto field = static_cast<uint32_t>(d.between(1, 99));
        b.overlays = {{{field}, {field + static_cast<uint32_t>(d.between(0, 3))}}};
    });
    p.box("box: overlays not by ascending field", [](Dice& d, WaveTrainBox& b) {
        const auto field = static_cast<uint32_t>(d.between(2, 99));
        b.overlays = {{{field}, {1}}, {{field}, {1}}};
    });
    p.box("box: a course that begins elsewhere", [](Dice& d, WaveTrainBox& b) {
        b.course = {{{0}, 10, {b.origin.x / 2 + d.between(1, 9), b.origin.z / 2}, 0, 0}};
    });
    p.box("box: legs that begin together", [](Dice&, WaveTrainBox& b) {
        b.course = {{{7}, 10, b.origin, 0, 0}, {{7}, 10, b.origin, 0, 0}};
    });
    p.box("box: a leg that leaves the world", [](Dice&, WaveTrainBox& b) {
        b.origin = {world_bound, 0}, b.course = {{{7}, 1 << 30, b.origin, 1 << 20, 0}};
    });
    p.box("box: irregular heights without a wave vector", [](Dice& d, WaveTrainBox& b) {
        b.irregular = {static_cast<uint16_t>(d.between(1, 32768)), 0, 0, 1, 1, 1, 1, 1};
    });
    p.box("box: noise finer than its lattice", [](Dice& d, WaveTrainBox& b) {
        b.noise = {1.0F, 1, 12, static_cast<uint8_t>(d.between(6, 14)), 40, true, 1};
    });
    p.box("box: noise faster than its lattice", [](Dice& d, WaveTrainBox& b) {
        b.noise = {1.0F, 1, 12, 20, static_cast<uint8_t>(d.between(14, 22)), true, 1};
    });
    p.box("box: a wake and two legs", [](Dice& d, WaveTrainBox& b) {
        b = random_ship(d, 3);
        b.course.push_back(b.course[0]);
        b.course[1].from = b.course[1].from + 1;
    });
    p.box("box: a wake without sides", [](Dice& d, WaveTrainBox& b) {
        b = random_ship(d, 3);
        (d.coin() ? b.length : b.width) = 0;
    });
    p.box("box: a hull without sides", [](Dice& d, WaveTrainBox& b) {
        b.hull = {20.0F, 4.0F};
        (d.coin() ? b.length : b.width) = 0;
    });
    p.box("box: a hull broader than long", [](Dice& d, WaveTrainBox& b) {
        b.hull = {20.0F, d.real(20.1F, 90.0F)}, b.length = b.width = 1 << 20;
    });
}

}  // namespace

void add_contradictions(std::vector<HostileVector>& out) {
    Pairs pairs(out);
    add_client_pairs(pairs);
    add_server_pairs(pairs);
    add_delta_pairs(pairs);
    add_plane_pairs(pairs);
    add_box_pairs(pairs);
    for (uint32_t from = 10; from < 10 + rounds; ++from) {
        Dice dice(from);
        const ChangeLand change{{{0, 0}, {9, 9}}, 20.0F, 3.0F, false};
        const auto event = [&](const char* what, LandChanged changed, ErrorCode code = range) {
            pairs.give(Direction::event, what, code, encode(LogEvent{1, {5}, std::move(changed)}));
        };
        event("land: predecessors not ascending",
              {change, {{{from}, random_box(dice, from + 5, 1)}, {{from}, random_box(dice, from + 6, 1)}}});
        event("land: a successor below its predecessor", {change, {{{from}, random_box(dice, from, 1)}}});
        LandChanged many{change, {}, {}};
        many.also.assign(64, change);
        event("land: more than 63 further changes", many);
        many.also.clear();
        for (uint32_t id = 1; id <= 1025; ++id) many.boxes.push_back({{id}, random_box(dice, id + 1, 1)});
        event("land: more than 1,024 boxes", many, ErrorCode::too_many_boxes);
    }
}

}  // namespace trochoid
