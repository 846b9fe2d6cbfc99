#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "protocol/model/displayed.hpp"
#include "protocol/model/point_query.hpp"
#include "protocol/units/hash.hpp"
#include "tests/conformance/local_sea.hpp"
#include "tests/conformance/server/refusals.hpp"

// and the bounds of patches: the server's own answers against what its records make up here, bit for bit.
namespace trochoid::conformance::server {

namespace {

constexpr uint32_t radius = 300 * 1024;

/// Points within a disc, the same at every run.
std::vector<LatticePoint> points_in(const SyncRegion& region, size_t count, uint64_t seed) {
    std::vector<LatticePoint> points;
    const auto side =
        static_cast<uint64_t>(region.radius) * 7 / 5;  // the square within the disc, and a bit less
    for (uint64_t i = 0; points.size() < count; ++i) {
        const uint64_t a = splitmix64(seed + 2 * i);
        const uint64_t b = splitmix64(seed + 2 * i + 1);
        const auto offset = [&](uint64_t v) {
            return static_cast<int64_t>(v % side) - static_cast<int64_t>(side / 2);
        };
        points.push_back({std::clamp(region.centre.x + offset(a), -world_bound, world_bound),
                          std::clamp(region.centre.z + offset(b), -world_bound, world_bound)});
    }
    return points;
}

/// Compares the server's samples with ours. Where the sea has changed meanwhile it is asked again.
void compare(ServerPeer& peer, const std::vector<LatticePoint>& points,
             const std::function<SeaTime(const CullKey&)>& time_of) {
    constexpr int tries = 6;
    for (int i = 0; i < tries; ++i) {
        const SeaTime time = time_of(peer.held().last()->key);
        const SampleReply reply = peer.ask_samples(time, points);
        const CullKey& key = peer.held().last()->key;
        if (time < key.from || time > key.until) continue;
        const SeaInstant instant(local_sea(peer.held().state()), time);
        size_t wrong = 0;
        std::string first;
        for (size_t p = 0; p < points.size(); ++p) {
            const std::string differs = difference_of(reply.samples[p], instant.evaluate(points[p]));
            if (differs.empty()) continue;
            if (wrong++ == 0)
                first = fmt::format("at ({}, {}), {} us: {}", points[p].x, points[p].z, time.us, differs);
        }
        if (wrong == 0) return;
        if (reply.log_position == key.log_position || i + 1 == tries)
            throw Failed{fmt::format("{} of {} samples differ, the first {}", wrong, points.size(), first)};
        peer.settle(Milliseconds(100));
    }
    throw Skipped{"the sea changes too fast to be compared"};
}

void compare_at(ServerTrial& trial, LatticePoint centre, uint64_t seed) {
    ClientHello hello = ServerPeer::usual_hello();
    hello.regions = {{centre, radius}};
    ServerPeer& peer = trial.log_in(hello);
    peer.await_result(0);
    trial.note(fmt::format("{} boxes, {} blocks", peer.held().state().boxes.size(),
                           peer.held().state().blocks.size()));
    const auto points = points_in(hello.regions[0], 48, seed);
    const auto share = [](int64_t parts) {
        return [parts](const CullKey& key) {
            return SeaTime{key.from.us + (key.until.us - key.from.us) / 8 * parts};
        };
    };
    for (const int64_t parts : {1, 4, 7}) compare(peer, points, share(parts));
}

void add_samples(Catalogue& all) {
    const auto at = [&](const std::string& name, const std::string& title,
                        std::function<LatticePoint(const Target&)> place) {
        all.push_back(server_case("R-204/" + name, title,
                                  [place, seed = Hash64().text(name).value()](ServerTrial& trial) {
                                      compare_at(trial, place(trial.target()), seed);
                                  }));
    };
    at("place", "Samples in the middle of the scene", [](const Target& t) { return t.place; });
    const std::pair<const char*, LatticePoint> ways[] = {
        {"east", {1, 0}},  {"south-east", {1, 1}},   {"south", {0, 1}},  {"south-west", {-1, 1}},
        {"west", {-1, 0}}, {"north-west", {-1, -1}}, {"north", {0, -1}}, {"north-east", {1, -1}}};
    for (const auto& [name, way] : ways)
        for (const int64_t metres : {1000, 5000})
            at(fmt::format("{}-{}-m", name, metres),
               fmt::format("Samples {} m {} of the scene's middle", metres, name),
               [step = way, metres](const Target& t) {
                   return LatticePoint{t.place.x + step.x * metres * lattice_per_metre,
                                       t.place.z + step.z * metres * lattice_per_metre};
               });
    const int64_t far = world_bound - 2 * int64_t{radius};
    for (const auto& [x, z] :
         {std::pair{far, far}, std::pair{-far, far}, std::pair{far, -far}, std::pair{-far, -far}})
        at(fmt::format("corner-{}-{}", x > 0 ? "east" : "west", z > 0 ? "south" : "north"),
           "Samples at a corner of the world",
           [corner = LatticePoint{x, z}](const Target&) { return corner; });
    for (size_t i = 0; i < 8; ++i)
        at(fmt::format("box-{}", i), fmt::format("Samples where box {} of the scene begins", i),
           [i](const Target& t) {
               if (i >= t.boxes.size()) throw Skipped{"the scene has fewer boxes"};
               constexpr int64_t most = world_bound - 2 * int64_t{radius};
               return LatticePoint{std::clamp(t.boxes[i].at.x, -most, most),
                                   std::clamp(t.boxes[i].at.z, -most, most)};
           });
    all.push_back(
        server_case("R-204/twice", "The same question twice has the same answer", [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            const auto points = points_in({trial.target().place, radius}, 40, 1);
            const SeaTime time = peer.ask_clock().watermark;
            const SampleReply one = peer.ask_samples(time, points);
            const SampleReply other = peer.ask_samples(time, points);
            if (one.log_position == other.log_position && one.samples != other.samples)
                throw Failed{"two answers differ"};
        }));
    all.push_back(
        server_case("R-204/240-points", "As many points as a request may have", [](ServerTrial& trial) {
            ServerPeer& peer = trial.log_in();
            const auto points =
                points_in({trial.target().place, radius}, peer.hello().limits.sample_points, 2);
            peer.ask_samples(peer.ask_clock().watermark, points);
        }));
    all.push_back(server_case("R-204/twenty-questions",
                              "Twenty questions in one write are answered in their order",
                              [](ServerTrial& trial) {
                                  ServerPeer& peer = trial.log_in();
                                  const SeaTime time = peer.ask_clock().watermark;
                                  const auto points = points_in({trial.target().place, radius}, 100, 3);
                                  for (int i = 0; i < 20; ++i)
                                      peer.send(SampleRequest{peer.next_sequence(), time, points});
                                  uint32_t before = 0;
                                  for (int i = 0; i < 20; ++i) {
                                      const auto reply = peer.await<SampleReply>("sample reply");
                                      if (reply.sequence <= before)
                                          throw Failed{"the answers are not in the order of the questions"};
                                      before = reply.sequence;
                                  }
                              }));
}

/// A node of a block held, as a point.
void add_land(Catalogue& all) {
    all.push_back(server_case(
        "R-204/land-nodes",
        "Samples at nodes, borders and middles of the land blocks that came: field interpolation",
        [](ServerTrial& trial) {
            if (trial.target().hello.terrain.columns == 0) throw Skipped{"the scene has no terrain"};
            ClientHello hello = ServerPeer::usual_hello();
            hello.regions = {{trial.target().place, 1024 * 1024}};
            ServerPeer& peer = trial.log_in(hello);
            peer.await_result(0);
            std::vector<LatticePoint> points;
            for (const auto& [key, value] : peer.held().state().blocks) {
                const int64_t step = int64_t{1} << value.step_log2;
                const LatticePoint corner{key.block.x * block_cells * step, key.block.z * block_cells * step};
                for (const int64_t off :
                     {int64_t{0}, int64_t{-1}, int64_t{1}, step / 2, step - 1, 5 * step, 16 * step - 1})
                    points.push_back({corner.x + off, corner.z + 3 * off / 2});
                if (points.size() > 2000) break;
            }
            const auto outside = [&](LatticePoint p) {
                const int64_t dx = p.x - hello.regions[0].centre.x;
                const int64_t dz = p.z - hello.regions[0].centre.z;
                return dx * dx + dz * dz > int64_t{hello.regions[0].radius} * hello.regions[0].radius;
            };
            points.erase(std::remove_if(points.begin(), points.end(), outside), points.end());
            if (points.empty()) throw Skipped{"no land blocks near the scene's middle"};
            points.resize(std::min<size_t>(points.size(), peer.hello().limits.sample_points));
            trial.note(
                fmt::format("{} points on {} blocks", points.size(), peer.held().state().blocks.size()));
            compare(peer, points, [](const CullKey& key) {
                return SeaTime{key.from.us + (key.until.us - key.from.us) / 2};
            });
        }));
}

// ---- patches ----

/// Distance of a patch's square from the camera's place, metres, less the slack.
double nearest_m(const PatchKey& patch, const CullKey& key) {
    const LatticeRect rect = rect_of(patch);
    const auto gap = [](int64_t least, int64_t most, int64_t at) {
        return at < least ? least - at : (at > most ? at - most : 0);
    };
    const double dx = to_metres(gap(rect.min.x, rect.max.x, key.anchor.position.x));
    const double dz = to_metres(gap(rect.min.z, rect.max.z, key.anchor.position.z));
    const double up = to_metres(key.anchor.altitude);
    return std::max(0.0, std::sqrt(dx * dx + dz * dz + up * up) - to_metres(key.slack));
}

ServerPeer& watch_water(ServerTrial& trial, double altitude_m) {
    ClientHello hello = ServerPeer::usual_hello();
    hello.view = view_of_water(trial.target(), altitude_m);
    hello.view.patch_budget = 512;
    ServerPeer& peer = trial.log_in(hello);
    peer.await_result(0);
    if (peer.held().state().patches.empty()) throw Skipped{"no water is in view at the scene's middle"};
    return peer;
}

/// No train that a patch leaves out is displayed at its nearest point.
void check_filter(ServerPeer& peer, Trial& trial) {
    const CullKey& key = peer.held().last()->key;
    const DisplayFilter filter = display_filter(key.anchor, key.error_in_force_px);
    size_t left_out = 0;
    for (const auto& [place, patch] : peer.held().state().patches) {
        // A hair nearer: what the rounding of the distance may come to.
        const auto distance = static_cast<float>(nearest_m(place, key) * 0.999);
        const float spacing = vertex_spacing(filter, distance);
        for (const PatchBox& entry : patch.boxes) {
            const WaveTrainBox& box = *peer.held().state().boxes.at(entry.box);
            for (size_t i = entry.train_count; i < box.trains.size(); ++i, ++left_out) {
                const TrainConstants constants = derive_constants(box.trains[i]);
                const float weight = displayed_weight(constants.wavelength, spacing * 1.001F);
                if (weight > 0.0F && box.trains[i].amplitude > 0.0F)
                    throw Failed{fmt::format(
                        "patch ({}, {}) of level {} leaves out train {} of box {}, {:.2f} m long, which is displayed at {:.4f} "
                        "where vertices are {:.3f} m apart",
                        place.x, place.z, place.level, i, entry.box.value, constants.wavelength, weight,
                        spacing)};
            }
        }
    }
    trial.note(fmt::format("{} trains left out of {} patches", left_out, peer.held().state().patches.size()));
}

/// `left_out` is no more than all the amplitudes that there are.
void check_left_out(ServerPeer& peer) {
    double all = 0.0;
    for (const auto& [id, box] : peer.held().state().boxes) all += height_bound(*box);
    for (const auto& [place, patch] : peer.held().state().patches)
        if (static_cast<double>(patch.left_out) > all * 1.001 + 1e-3)
            throw Failed{fmt::format(
                "patch ({}, {}) of level {} says that {} m were left out, but all boxes that came make {} m",
                place.x, place.z, place.level, patch.left_out, all)};
}

/// The height at fixed places without what a patch leaves out is within its bound.
void check_height_error(ServerPeer& peer, Trial& trial) {
    const InterestState& state = peer.held().state();
    const CullKey& key = peer.held().last()->key;
    const SeaTime time{key.from.us + (key.until.us - key.from.us) / 2};
    const SeaInstant whole(local_sea(state), time);
    double largest = 0.0;
    size_t looked_at = 0;
    for (const auto& [place, patch] : state.patches) {
        if (++looked_at > 24) break;
        const SeaInstant cut(local_sea(state, patch), time);
        const LatticeRect rect = rect_of(place);
        const LatticePoint middle{(rect.min.x + rect.max.x) / 2, (rect.min.z + rect.max.z) / 2};
        if (!inside_world(middle)) continue;
        const double error = std::abs(static_cast<double>(water_at(whole, middle).height) -
                                      static_cast<double>(water_at(cut, middle).height));
        largest = std::max(largest, error);
        if (error > static_cast<double>(patch.height_error) + 1e-3)
            throw Failed{fmt::format(
                "in the middle of patch ({}, {}) of level {} the height is {:.4f} m off, but the bound is {:.4f} m",
                place.x, place.z, place.level, error, patch.height_error)};
    }
    trial.note(fmt::format("the largest error met was {:.4f} m", largest));
}

/// Where rays of the picture meet still water nearby, some patch lies.
void check_cover(ServerPeer& peer, Trial& trial, double altitude_m) {
    const InterestState& state = peer.held().state();
    const ViewState& view = peer.held().last()->key.anchor;
    // Camera to world: the quaternion turns about x alone.
    const double sine = 2.0 * static_cast<double>(view.qx) * static_cast<double>(view.qw);
    const double cosine = 1.0 - 2.0 * static_cast<double>(view.qx) * static_cast<double>(view.qx);
    size_t rays = 0;
    for (int row = -4; row <= 4; ++row)
        for (int column = -4; column <= 4; ++column) {
            const double across = 0.95 * static_cast<double>(view.tan_half_width) * column / 4.0;
            const double upwards = 0.95 * static_cast<double>(view.tan_half_height) * row / 4.0;
            const double dz = upwards * sine - cosine;
            const double fall = upwards * cosine + sine;  // y of the direction
            if (fall >= -0.01) continue;
            const double reach = altitude_m / -fall;
            const LatticePoint hit{view.position.x + to_lattice(across * reach),
                                   view.position.z + to_lattice(dz * reach)};
            if (!inside_world(hit)) continue;
            ++rays;
            bool covered = false;
            for (uint8_t level = finest_patch_level; level <= coarsest_patch_level && !covered; ++level)
                covered = state.patches.contains(patch_at(hit, level));
            if (!covered)
                throw Failed{fmt::format(
                    "the water {:.0f} m ahead and {:.0f} m aside is in view, but no patch holds it",
                    -dz * reach, across * reach)};
        }
    trial.note(fmt::format("{} rays of the picture meet the water", rays));
}

void add_patches(Catalogue& all) {
    for (const double altitude : {5.0, 20.0, 100.0, 500.0}) {
        const std::string name = fmt::format("{:.0f}-m", altitude);
        all.push_back(server_case("R-131/cover-" + name, "Patches cover the water in view from " + name,
                                  [altitude](ServerTrial& trial) {
                                      if (trial.target().hello.terrain.columns > 0)
                                          throw Skipped{"the scene has land, where no water is due"};
                                      check_cover(watch_water(trial, altitude), trial, altitude);
                                  }));
        all.push_back(server_case(
            "R-131/filter-" + name, "No train that a patch leaves out is displayed there, seen from " + name,
            [altitude](ServerTrial& trial) { check_filter(watch_water(trial, altitude), trial); }));
        all.push_back(
            server_case("R-131/left-out-" + name,
                        "What patches say was left out is no more than there is, seen from " + name,
                        [altitude](ServerTrial& trial) { check_left_out(watch_water(trial, altitude)); }));
        all.push_back(server_case(
            "R-131/height-error-" + name, "The height errors that patches state hold, seen from " + name,
            [altitude](ServerTrial& trial) { check_height_error(watch_water(trial, altitude), trial); }));
    }
}

}  // namespace

void add_evaluation_cases(Catalogue& all) {
    add_samples(all);
    add_land(all);
    add_patches(all);
}

}  // namespace trochoid::conformance::server
