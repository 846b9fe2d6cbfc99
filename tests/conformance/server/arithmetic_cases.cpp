#include <fmt/format.h>

#include <functional>

#include "protocol/units/assert.hpp"
#include "protocol/units/hash.hpp"
#include "tests/conformance/local_sea.hpp"
#include "tests/conformance/other_arithmetic.hpp"
#include "tests/conformance/server/refusals.hpp"

// the server's own answers tell by what arithmetic they were made.
namespace trochoid::conformance::server {

namespace {

constexpr uint32_t radius = 300 * 1024;
constexpr size_t most_points = 60;
// Places that are tried, here, until so many tell two reckonings apart.
constexpr uint64_t most_tried = 1000;
// So many have to be found at least.
constexpr size_t least_telling = 6;

/// Answers at points that `tell`, and the sea that they should be of.
struct Answers {
    SeaInstant instant;
    std::vector<LatticePoint> points;
    std::vector<SurfaceSample> samples;
};
using Tells = std::function<bool(const SeaInstant& instant, LatticePoint point)>;

std::vector<LatticePoint> telling_points(const SeaInstant& instant, LatticePoint centre, const Tells& tell) {
    std::vector<LatticePoint> points;
    for (uint64_t i = 0; i < most_tried && points.size() < most_points; ++i) {
        const auto offset = [](uint64_t v) { return static_cast<int64_t>(v % radius) - int64_t{radius} / 2; };
        const LatticePoint at{centre.x + offset(splitmix64(2 * i)), centre.z + offset(splitmix64(2 * i + 1))};
        if (inside_world(at) && tell(instant, at)) points.push_back(at);
    }
    return points;
}

Answers answers_at(ServerTrial& trial, LatticePoint centre, const Tells& tell) {
    ClientHello hello = ServerPeer::usual_hello();
    hello.regions = {{centre, radius}};
    ServerPeer& peer = trial.log_in(hello);
    peer.await_result(0);
    constexpr int tries = 6;
    for (int i = 0; i < tries; ++i) {
        const CullKey asked = peer.held().last()->key;
        // Late: phases have turned often by then.
        const SeaTime time{asked.until.us - (asked.until.us - asked.from.us) / 8};
        const SeaInstant instant(local_sea(peer.held().state()), time);
        const auto points = telling_points(instant, centre, tell);
        if (points.size() < least_telling) throw Skipped{"the sea is the same by either reckoning there"};
        SampleReply reply = peer.ask_samples(time, points);
        trial.note(fmt::format("{} points tell the two apart", points.size()));
        if (reply.log_position == asked.log_position) return {instant, points, std::move(reply.samples)};
        peer.settle(Milliseconds(100));
    }
    throw Skipped{"the sea changes too fast to be compared"};
}

/// Failed where the answers are those of another arithmetic, to the bit, wherever that makes a difference. Answers that are neither
/// are for the cases of R-204.
void is_not(Arithmetic other, const std::string& what, ServerTrial& trial, LatticePoint centre) {
    const Answers answers = answers_at(trial, centre, [&](const SeaInstant& instant, LatticePoint at) {
        const SurfaceSample right = instant.evaluate(at);
        TROCHOID_ASSERT(difference_of(sample_by(Arithmetic::standard, instant, at), right).empty(),
                        "two reckonings by the standard differ at ({}, {})", at.x, at.z);
        return !difference_of(sample_by(other, instant, at), right).empty();
    });
    size_t theirs = 0;
    for (size_t i = 0; i < answers.points.size(); ++i) {
        const SurfaceSample wrong = sample_by(other, answers.instant, answers.points[i]);
        if (difference_of(answers.samples[i], wrong).empty()) ++theirs;
    }
    if (theirs == answers.points.size())
        throw Failed{
            fmt::format("the samples are those of {}, at all {} points where it shows", what, theirs)};
}

/// Whatever the derivatives are, the normal is made of them.
void check_own_normals(ServerTrial& trial, LatticePoint centre) {
    const Answers answers = answers_at(trial, centre, [](const SeaInstant& instant, LatticePoint at) {
        const SurfaceSample right = instant.evaluate(at);
        return !difference_of(with_normal(right, true), right).empty();
    });
    size_t wrong = 0;
    std::string first;
    for (const SurfaceSample& given : answers.samples) {
        const std::string differs = difference_of(given, with_normal(given, false));
        if (!differs.empty() && wrong++ == 0) first = differs;
    }
    if (wrong > 0)
        throw Failed{fmt::format("{} of {} normals are not what their own derivatives come to, the first: {}",
                                 wrong, answers.points.size(), first)};
}

}  // namespace

void add_arithmetic_cases(Catalogue& all) {
    struct Place {
        const char* name;
        const char* text;
        LatticePoint (*of)(const Target& target);
    };
    const Place places[] = {{"place", "in the middle of the scene", [](const Target& t) { return t.place; }},
                            {"east", "a kilometre to the east", [](const Target& t) {
                                 return LatticePoint{t.place.x + 1000 * lattice_per_metre, t.place.z};
                             }}};
    struct Other {
        const char* id;
        Arithmetic arithmetic;
        const char* what;
    };
    const Other others[] = {
        {"R-201/not-fused", Arithmetic::fused, "fused products and sums"},
        {"R-201/not-wider", Arithmetic::wider, "sums in double precision"},
        {"R-201/not-in-lanes", Arithmetic::four_sums, "four sums side by side"},
        {"R-202/not-24-bits", Arithmetic::short_phases, "phases of 24 bits"},
        {"R-202/not-double", Arithmetic::double_phases, "phases in double precision"},
        {"R-203/not-by-library", Arithmetic::library_sine, "sines of a mathematical library"},
        {"R-203/not-fused", Arithmetic::fused_sine, "sines in fused steps"},
        {"R-203/not-unfolded", Arithmetic::unfolded_sine, "sines as sums of powers"}};
    for (const Place& place : places) {
        all.push_back(server_case(
            fmt::format("R-201/own-normals-{}", place.name),
            fmt::format("Normals {} are made of their own derivatives, each operation "
                        "rounded on its own",
                        place.text),
            [of = place.of](ServerTrial& trial) { check_own_normals(trial, of(trial.target())); }));
        for (const Other& other : others) {
            all.push_back(server_case(fmt::format("{}-{}", other.id, place.name),
                                      fmt::format("Samples {} are not those of {}", place.text, other.what),
                                      [other, of = place.of](ServerTrial& trial) {
                                          is_not(other.arithmetic, other.what, trial, of(trial.target()));
                                      }));
        }
    }
}

}  // namespace trochoid::conformance::server
