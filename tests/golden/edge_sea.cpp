#include "tests/golden/edge_sea.hpp"

#include <fmt/format.h>

#include <array>
#include <ostream>
#include <utility>
#include <vector>

#include "protocol/units/hash.hpp"
#include "tests/golden/edge_fields.hpp"
#include "tests/golden/golden_text.hpp"

namespace trochoid {

namespace {

constexpr int64_t second = microseconds_per_second;

WaveTrain train(int32_t kx, int32_t kz, uint64_t omega, float amplitude, float choppiness,
                uint32_t field = 0) {
    const auto phase = static_cast<uint32_t>(splitmix64(static_cast<uint64_t>(kx) ^ omega));
    return {kx, kz, omega, phase, amplitude, choppiness, {field}};
}

/// A box whose corner is the n-th of places far apart, so that no two boxes meet.
WaveTrainBox box(uint32_t n, std::vector<WaveTrain> trains) {
    constexpr int64_t apart = 40'000'000;
    WaveTrainBox made;
    made.id = {n};
    made.first_train = {1 + 300 * n};
    made.origin = {(int64_t{n} % 5 - 2) * apart + 1'234'567, (int64_t{n} / 5 - 2) * apart - 7'654'321};
    made.ux = 858'993'459;  // 0.8, 0.6
    made.uz = 644'245'094;
    made.trains = std::move(trains);
    return made;
}

/// Where and when a box is looked at: in its own axes, from its own beginning.
struct Look {
    std::vector<std::pair<int64_t, int64_t>> places;  ///< u, v
    std::vector<int64_t> ages_us;
    std::vector<uint16_t> masks = {authoritative_layers.bits};
    size_t waters = 9;  ///< every so many looks, also at the fixed place
};
struct Edge {
    WaveTrainBox box;
    Look look;
};

/// Every way that the four ramps of a box meet, its time ramps, and its front.
std::vector<Edge> envelopes() {
    std::vector<Edge> edges;
    const std::vector<WaveTrain> pair{train(40'000, 90'001, 1'613'943'558'211ULL, 0.75F, 0.8F),
                                      train(-61'007, 20'013, 2'943'558'211'613ULL, 0.25F, 1.25F)};
    WaveTrainBox both = box(1, pair);  // a point is on both ramps of a pair at a time
    both.length = 300'000;
    both.width = 200'001;
    both.ramp_rear = 250'007;
    both.ramp_front = 200'003;
    both.ramp_side = 150'001;
    both.build_up_us = 10 * second;
    both.end = {100 * second};
    both.decay_us = 20 * second + 7;
    edges.push_back({both,
                     {{{150'000, 100'000},
                       {99'999, 60'001},
                       {240'000, 140'003},
                       {251'000, 100'000},
                       {120'000, 160'000},
                       {1, 1},
                       {299'999, 200'000},
                       {300'000, 100'000},
                       {150'000, 200'001},
                       {-1, 100'000},
                       {150'000, -2}},
                      {3 * second + 1, 50 * second, 107 * second, 0, 120 * second + 7, 100 * second}}});
    WaveTrainBox along = box(2, pair);  // limited one way: no sides
    along.ux = -644'245'094;
    along.uz = 858'993'459;
    along.length = 500'000;
    along.ramp_rear = 300'001;
    along.ramp_front = 1024;
    along.front_speed = 90'001;
    along.build_up_us = 77 * second;
    along.raised_us = 5 * second + 3;
    along.fade_us = 9 * second + 1;
    edges.push_back({along,
                     {{{100'000, 30'000'000},
                       {30'000, -25'000'000},
                       {499'500, 0},
                       {499'999, 77},
                       {1024, -3},
                       {60'000, 1},
                       {200'000, 1'900'000'000},
                       {250'000, -2'500'000'000}},
                      {4 * second, 8 * second + 999'999, 30 * second, 89 * second, 95 * second, 10}}});
    // No box is looked for farther from its corner than this, along x or z.
    constexpr int64_t reach = int64_t{1} << 31;
    WaveTrainBox across = box(3, pair);  // limited the other way: neither rear nor front
    across.width = 400'001;
    across.ramp_side = 210'011;
    across.roundness = 32'768;
    across.begin = {-13 * second};
    across.ux = 0;
    across.uz = 1 << 30;
    edges.push_back({across,
                     {{{30'000'000, 100'000},
                       {-25'000'000, 200'000},
                       {0, 200'001},
                       {55, 300'000},
                       {-7, 399'999},
                       {1'000'003, 2},
                       {reach, 100'000},
                       {reach + 1, 100'001},
                       {-reach - 1, 100'002},
                       {9, 199'999}},
                      {0, 5 * second}}});
    WaveTrainBox far = box(20, pair);
    far.ux = 0;
    far.uz = 1 << 30;
    far.length = 500'000;
    far.ramp_rear = 300'001;
    edges.push_back(
        {far,
         {{{100'000, reach}, {100'001, reach + 1}, {100'002, -reach}, {100'003, -reach - 1}}, {second}}});
    WaveTrainBox front = box(4, pair);  // the front has just left the rear's ramp
    front.length = (int64_t{1} << 30);
    front.width = (int64_t{1} << 30);
    front.ramp_rear = 5000;
    front.ramp_front = 4000;
    front.ramp_side = (1 << 30);
    front.front_speed = 4'000'000'000U;
    front.begin = {-40 * second};
    front.end = {0};
    front.decay_us = 50 * second;
    edges.push_back({front,
                     {{{2'000'000'000 / 8, 400'000'000},
                       {1000, 600'000'000},
                       {3'000'000, 1'000},
                       {4999, 536'870'912},
                       {5000, 1'073'741'823}},
                      {second / 100, second, 40 * second, 41 * second, 89'999'999}}});
    return edges;
}

/// Irregular heights, round waves, and both with land under limited boxes.
std::vector<Edge> modulations() {
    std::vector<Edge> edges;
    WaveTrainBox irregular = box(5, {train(9'001, -100'003, 1'702'102'102'102ULL, 1.5F, 0.5F)});
    irregular.length = 900'000;
    irregular.width = 700'000;
    irregular.ramp_rear = 800'000;
    irregular.ramp_front = 700'000;
    irregular.ramp_side = 500'000;
    irregular.irregular = {32'768,     80'003,        -10'007, 10'007, 8'003, 141'700'000'000ULL,
                           77'777'777, 3'333'333'333U};
    edges.push_back({irregular,
                     {{{450'001, 350'003}, {100'000, 500'000}, {800'000, 90'000}, {620'000, 10'001}},
                      {second, 77 * second},
                      {255, 239, 255}}});
    WaveTrainBox round =
        box(6, {train(33'000'000, 1'000'003, 9'702'102'102'102ULL, 0.01F, 0.5F), train(1, 0, 11, 2.5F, 4.0F),
                train(-70'001, -52'501, 2'102'102ULL, 0.5F, 1.0F)});
    round.length = 700'000;
    round.width = 1'025;
    round.ramp_side = 1'024;
    round.roundness = 32'767;
    edges.push_back(
        {round,
         {{{90'000, 1}, {90'001, 511}, {90'002, 512}, {90'003, 513}, {90'004, 1024}, {600'000, 700}},
          {1, 99 * second},
          {255, 191}}});
    WaveTrainBox wide = box(7, {train(20'000'000, -20'000'003, 9'702'102'102'102ULL, 0.01F, 0.5F)});
    wide.width = int64_t{1} << 30;
    wide.ramp_side = 1 << 29;
    wide.roundness = 20'001;
    edges.push_back(
        {wide, {{{77, 1'000'000'007}, {1'000, 536'870'913}, {-4'000'000, 77'777'777}}, {second}}});
    return edges;
}

/// Over the fields of edge_fields.cpp, which lie around x = z = 0.
std::vector<Edge> grounds() {
    std::vector<Edge> edges;
    const std::vector<std::pair<int64_t, int64_t>> places{{0, 0},
                                                          {1, 1},
                                                          {4095, 4095},
                                                          {4096, 4096},
                                                          {30'001, 50'003},
                                                          {65'535, 1},
                                                          {-1, -1},
                                                          {-60'001, 7},
                                                          {-65'536, 65'535},
                                                          {40'000, -3'001},
                                                          {70'000, 70'000},
                                                          {7'000, -65'537},
                                                          {-1'000'001, -9'000'003},
                                                          {-16'777'216, -1},
                                                          {2'049, 2'047}};
    WaveTrainBox layered = box(8, {train(70'001, 52'501, 2'102'102'102'102ULL, 0.75F, 1.0F, 3),
                                   train(141'007, 90'007, 2'902'902'902'902ULL, 0.25F, 0.7F, 2),
                                   train(500'009, -300'007, 5'605'605'605'605ULL, 0.125F, 0.5F, 0),
                                   train(-120'007, 250'001, 3'605'605'605'605ULL, 0.0625F, 2.5F, 4)});
    layered.overlays = {{{2}, {1}}, {{3}, {2}}, {{4}, {1}}};
    layered.origin = {-500'000, -500'000};
    layered.ux = 1 << 30;
    layered.uz = 0;
    layered.length = layered.width = 1'000'000;
    layered.ramp_rear = layered.ramp_front = layered.ramp_side = 700'000;
    layered.irregular = {9'001, 8'003, -10'007, 10'007, 8'003, 141'700'000'000ULL, 7, 3};
    layered.begin = {-second};
    layered.end = {1000 * second};
    edges.push_back({layered, {{}, {}}});
    // The same fields where the box has no limits, at another time; field 5 is no base for those of 4 m.
    WaveTrainBox open = box(9, {train(70'001, -52'501, 2'102'102'102'102ULL, 0.75F, 1.0F, 2),
                                train(9'001, 52'501, 1'102'102'102'102ULL, 0.5F, 1.0F, 4),
                                train(99'001, 52'501, 1'602'102'102'102ULL, 0.5F, 1.0F, 5)});
    open.overlays = {{{5}, {2}}};
    open.noise = {0.25F, 30'000, 2, 12, 20, false, 5};
    open.begin = {2000 * second};
    open.end = {2100 * second};
    edges.push_back({open, {{}, {}}});
    for (const auto& [x, z] : places) {
        const LatticePoint corner = edges[0].box.origin;
        edges[0].look.places.emplace_back(x - corner.x, z - corner.z);
        // Unlimited: the axes are 0.8, 0.6 and their turn, which only a sum of products can undo.
        edges[1].look.places.emplace_back(x, z);
    }
    edges[0].look.ages_us = {5 * second};
    edges[0].look.masks = {255, 255 ^ 2, 255 ^ 4, 255 ^ 32, 255 ^ 16, 255 ^ 38};
    edges[1].look.ages_us = {7 * second};
    edges[1].look.masks = {255, 33, 3, 5};
    return edges;
}

/// Wakes at every distance, from slow to fast ships, while they sail and after they are gone.
std::vector<Edge> wakes() {
    struct Ship {
        ShipWake wake;
        int64_t length;
        int64_t width;
        std::vector<std::pair<int64_t, int64_t>> behind;  ///< behind her, to her right
    };
    const std::vector<Ship> ships{
        {{0.25F, 0.375F, 0.75F, 1'676'000'000U, 8'590},
         2'000'000,
         1'500'001,
         {{1, 0},
          {3, 1},
          {600, 100},
          {650, -200},
          {1'300, 3},
          {2'000, -707},
          {16'384, -5'000},
          {300'000, 106'000}}},
        {{0.5F, 0.0F, 0.0F, 7'449'000U, 128'850},
         40'000'000,
         30'000'000,
         {{1'000, 300},
          {70'000, -20'000},
          {147'000, 51'000},
          {148'000, -45'000},
          {290'000, 0},
          {600'001, 150'007},
          {2'400'000, -800'000},
          {30'000'000, 8'000'001}}},
        {{0.0F, 0.625F, 4.0F, 1'048'576U, 343'600},
         900'000'000,
         700'000'000,
         {{20'000, 7'000},
          {1'000'000, -352'000},
          {1'048'576, 370'000},
          {2'000'000, -260'000},
          {16'777'216, 2'500'000},
          {16'777'217, -5'900'000},
          {300'000'000, 100'000'000}}},
        {{0.125F, 0.25F, 1.0F, 2'147'483'648U, 1},
         5'000,
         4'001,
         {{1, -1}, {512, 181}, {513, -150}, {1'024, 90}, {4'000, -1'300}, {4'999, 1'767}}},
    };
    std::vector<Edge> edges;
    uint32_t n = 10;
    for (const Ship& ship : ships) {
        WaveTrainBox made = box(n++, {});
        made.length = ship.length;
        made.width = ship.width;
        made.ramp_rear = 2'048;
        made.begin = {-100 * second};
        made.end = {900 * second};
        made.decay_us = 2'000 * second;
        made.course = {
            {made.begin, 1'000 * second, made.origin, 2 * static_cast<int32_t>(ship.wake.group_speed), 0}};
        made.wake = ship.wake;
        if (n == 13) {  // the third: places come out to the unit
            made.ux = 1 << 30;
            made.uz = 0;
        }
        Edge edge{made,
                  {{}, {second, 30 * second, 600 * second, 1'004 * second, 1'500 * second, 2'400 * second}}};
        for (const auto& [behind, aside] : ship.behind)
            edge.look.places.emplace_back(ship.length - behind, ship.width / 2 + aside);
        edges.push_back(std::move(edge));
    }
    return edges;
}

/// Courses with gaps, before their first leg and after their last.
std::vector<Edge> courses() {
    WaveTrainBox sails = box(14, {train(9'001, 4'003, 702'102'102'102ULL, 1.5F, 0.5F)});
    sails.length = 800'000;
    sails.width = 600'000;
    sails.ramp_rear = sails.ramp_front = 300'000;
    sails.ramp_side = 200'000;
    sails.begin = {-1'000 * second};
    sails.course = {{{-500 * second}, 100 * second, sails.origin, 85'901, -17'003},
                    {{0}, 0, {sails.origin.x + 500'000, sails.origin.z}, 99, 99},
                    {{100 * second},
                     7 * second + 3,
                     {sails.origin.x - 300'000, sails.origin.z + 9},
                     -2'097'151,
                     2'097'151}};
    return {{sails,
             {{{400'000, 300'000}, {100'000, 500'000}, {650'000, 100'001}},
              {0, 500 * second, 550 * second, 600 * second + 1, 999 * second, 1'000 * second, 1'050 * second,
               1'103 * second, 1'200 * second}}}};
}

/// Noise of every size, and trains at the ends of their ranges.
std::vector<Edge> extremes() {
    std::vector<Edge> edges;
    const std::vector<SurfaceNoise> layers{{0.5F, 65'535, 12, 16, 24, false, 1},
                                           {0x1p-20F, 32'768, 6, 20, 40, true, 0xffffffff},
                                           {32.0F, 0, 3, 7, 14, false, 99},
                                           {0.25F, 30'000, 2, 6, 25, true, 7}};
    uint32_t n = 15;
    for (const SurfaceNoise& noise : layers) {
        WaveTrainBox made = box(n++, {});
        made.length = made.width = 400'000;
        made.ramp_rear = made.ramp_front = made.ramp_side = 300'000;
        made.noise = noise;
        edges.push_back({made,
                         {{{200'000, 200'000}, {50'001, 300'000}, {399'000, 1'003}, {123'457, 222'222}},
                          {second, 3'000 * second + 12'345, 100'000'000 * second + 777},
                          {511, 255, 127}}});
    }
    WaveTrainBox strange =
        box(n++, {train(2'147'483'647, 1, UINT64_MAX, 0x1p-20F, 4.0F),
                  train(1, -2'147'483'647, uint64_t{1} << 63, 0.03125F, 0.0F), train(0, 1, 0, 32.0F, 4.0F),
                  train(-5, 0, 1, 0.0F, 1.0F), train(70'001, 90'001, 0x0000ffffff800000ULL, 32.0F, 4.0F)});
    strange.length = 400'000;
    strange.width = 300'000;
    edges.push_back(
        {strange,
         {{{200'000, 100'000}, {7, 7}, {1'024, 1'024}, {399'993, 299'999}}, {0, 1, 4'000'000'000 * second}}});
    edges.back().look.waters = 1;
    return edges;
}

std::vector<Edge> all_edges() {
    std::vector<Edge> all;
    for (const auto& part : {envelopes(), modulations(), grounds(), wakes(), courses(), extremes()})
        all.insert(all.end(), part.begin(), part.end());
    return all;
}

/// The point at (u, v) of the box where its corner is at that time.
LatticePoint place_in(const WaveTrainBox& box, SeaTime t, int64_t u, int64_t v) {
    if (box.length == 0 && box.width == 0) return {u, v};
    const LatticePoint corner = instant_of(box, t).origin;
    return {corner.x + ((u * box.ux - v * box.uz) >> 30), corner.z + ((u * box.uz + v * box.ux) >> 30)};
}

void write_looks(std::ostream& out, const Sea& sea, const Edge& edge) {
    size_t count = 0;
    for (const int64_t age : edge.look.ages_us)
        for (const auto& [u, v] : edge.look.places) {
            const SeaTime t{edge.box.begin.us + age};
            const LatticePoint p = place_in(edge.box, t, u, v);
            const Layers layers{edge.look.masks[count++ % edge.look.masks.size()]};
            if (layers == authoritative_layers)
                out << fmt::format("sample {} {} {} {}\n", t.us, p.x, p.z, sample_text(sea, t, p));
            else
                out << fmt::format("layers {} {} {} {} {}\n", layers.bits, t.us, p.x, p.z,
                                   sample_text(sea, t, p, layers));
            if (count % edge.look.waters == 0)
                out << fmt::format("water {} {} {} {}\n", t.us, p.x, p.z, water_text(sea, t, p));
        }
}

void write_trains(std::ostream& out, const Sea& sea) {
    // Where the last bit of a coefficient shows.
    for (const uint32_t phase : {3'708'693'626U, 3'746'412'722U})
        out << fmt::format("sincos {} {}\n", phase, sincos_text(phase));
    for (const auto& prepared : sea.boxes())
        for (const WaveTrain& it : prepared->record.trains) {
            out << fmt::format("constants {} {} {} {} {} {} {} {}\n", it.kx, it.kz, it.omega, it.phase,
                               hex(it.amplitude), hex(it.choppiness), it.field.value, constants_text(it));
            const uint64_t dice = splitmix64(it.phase);
            // Anywhere in the world, at any time that there is.
            const LatticePoint p{
                static_cast<int64_t>(dice % (uint64_t{1} << 36)) - (int64_t{1} << 35),
                static_cast<int64_t>((dice >> 28) % (uint64_t{1} << 36)) - (int64_t{1} << 35)};
            const SeaTime t{static_cast<int64_t>(splitmix64(dice) >> 2) - (int64_t{1} << 61)};
            out << fmt::format("phase {} {} {} {} {} {} {} {}\n", it.kx, it.kz, it.omega, it.phase, t.us, p.x,
                               p.z, phase_text(it, t, p));
        }
}

}  // namespace

void write_edges(std::ostream& out) {
    out << R"(# Trochoid golden vectors, model version 2: a second sea, of what the reference sea of sea.txt has none of. Lines as there, and:
# constants then the words of a train, then KX KZ HX HZ LAMBDA OMEGA WHOLE      of a train (chapter 2.2)
# phase KX KZ OMEGA PHASE T X Z P                                               of a train, without land and roundness (2.3)
)";
    const std::vector<Edge> edges = all_edges();
    const auto fields = edge_fields();
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    boxes.reserve(edges.size());
    for (const Edge& edge : edges) boxes.push_back(prepare(edge.box, fields));
    const Sea sea(std::move(boxes));
    write_trains(out, sea);
    write_records(out, sea);
    for (const Edge& edge : edges) write_looks(out, sea, edge);
}

}  // namespace trochoid
