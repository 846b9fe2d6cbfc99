#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "protocol/model/sincos.hpp"
#include "tests/conformance/local_sea.hpp"
#include "tests/conformance/mutants/server_mutants.hpp"

// Servers that compute another sea, or judge clients by another one.
namespace trochoid::conformance::mutants {

namespace {

/// Answers sample requests in the server's place from the records that this connection has been sent, by another reckoning.
class OtherSea final : public MessageSpoiler {
public:
    using Reckon = SurfaceSample (*)(const Sea& sea, SeaTime time, LatticePoint place);
    explicit OtherSea(Reckon reckon) : reckon_(reckon) {}

private:
    Fate client_says(ClientMessage& message, Link&) override {
        if (const auto* request = std::get_if<SampleRequest>(&message))
            asked_[request->sequence] = request->points;
        return Fate::kept;
    }
    Fate server_says(ServerMessage& message, Link&) override {
        if (const auto* piece = std::get_if<Delta>(&message)) {
            if (piece->piece == 0 && piece->base == 0) state_ = {};
            apply(state_, piece->change);
        }
        auto* reply = std::get_if<SampleReply>(&message);
        if (reply == nullptr || state_.boxes.empty()) return Fate::kept;
        const Sea sea = local_sea(state_);
        const std::vector<LatticePoint>& points = asked_[reply->sequence];
        for (size_t i = 0; i < std::min(points.size(), reply->samples.size()); ++i)
            reply->samples[i] = reckon_(sea, reply->time, points[i]);
        return Fate::changed;
    }

    Reckon reckon_;
    InterestState state_;
    std::map<uint32_t, std::vector<LatticePoint>> asked_;
};

uint32_t phase_at(const LiveBox& live, size_t train, LatticePoint place) {
    const WaveTrain& record = live.box->record.trains[train];
    return static_cast<uint32_t>(record.kx) * static_cast<uint32_t>(place.x) +
           static_cast<uint32_t>(record.kz) * static_cast<uint32_t>(place.z) + live.phase[train];
}

template <Layer layer>
SurfaceSample without(const Sea& sea, SeaTime time, LatticePoint place) {
    return SeaInstant(sea, time, authoritative_layers.without(layer)).evaluate(place);
}

template <Layer layer>
MakeSpoiler sea_without() {
    return [] { return std::make_unique<OtherSea>(without<layer>); };
}

/// Phases of 24 bits, as a float would have them.
SurfaceSample with_coarse_phases(const Sea& sea, SeaTime time, LatticePoint place) {
    const SeaInstant instant(sea, time);
    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (const LiveBox& live : instant.live()) {
        auto box = std::make_shared<PreparedBox>(*live.box);
        for (size_t i = 0; i < box->record.trains.size(); ++i)
            box->record.trains[i].phase -= phase_at(live, i, place) & 0xffU;
        boxes.push_back(std::move(box));
    }
    return SeaInstant(Sea(std::move(boxes)), time).evaluate(place);
}

/// The first train's cosine from the mathematical library.
SurfaceSample with_library_cosine(const Sea& sea, SeaTime time, LatticePoint place) {
    const SeaInstant instant(sea, time);
    SurfaceSample sample = instant.evaluate(place);
    for (const LiveBox& live : instant.live()) {
        if (live.box->record.trains.empty()) continue;
        const uint32_t phase = phase_at(live, 0, place);
        const double turns = static_cast<double>(phase) / 4294967296.0;
        const auto library = static_cast<float>(std::cos(2.0 * std::numbers::pi * turns));
        sample.ay += live.box->record.trains[0].amplitude * (library - sincos_turns(phase).cos);
        break;
    }
    return sample;
}

/// The normal by fused products.
SurfaceSample with_fused_normal(const Sea& sea, SeaTime time, LatticePoint place) {
    SurfaceSample s = SeaInstant(sea, time).evaluate(place);
    s.nx = std::fma(s.yz, s.pzx, -(s.pzz * s.yx));
    s.ny = std::fma(s.pzz, s.pxx, -(s.pxz * s.pzx));
    s.nz = std::fma(s.pxz, s.yx, -(s.yz * s.pxx));
    return s;
}

float neighbour(float value) { return std::bit_cast<float>(std::bit_cast<uint32_t>(value) ^ 1U); }

}  // namespace

void add_other_seas(std::vector<Mutant>& all) {
    const auto reckoned = [](OtherSea::Reckon reckon) -> MakeSpoiler {
        return [reckon] { return std::make_unique<OtherSea>(reckon); };
    };
    all.push_back(server_mutant(201, "fused-products", "fuses products and sums in the normal",
                                reckoned(with_fused_normal)));
    all.push_back(
        server_mutant(202, "coarse-phases", "computes phases of 24 bits", reckoned(with_coarse_phases)));
    all.push_back(server_mutant(203, "library-cosine", "takes a cosine from the mathematical library",
                                reckoned(with_library_cosine)));
    all.push_back(server_mutant(204, "last-bit", "computes heights of which the last bit is another",
                                each_of_server<SampleReply>([](SampleReply& reply, const Talk&, Link&) {
                                    for (SurfaceSample& sample : reply.samples)
                                        sample.ay = neighbour(sample.ay);
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(204, "no-shelter", "computes a sea without what land does to heights",
                                sea_without<Layer::shelter>()));
    all.push_back(server_mutant(204, "no-refraction", "computes a sea without what land does to phases",
                                sea_without<Layer::refraction>()));
    all.push_back(server_mutant(204, "no-orbits", "computes a sea with round orbits in shallow water",
                                sea_without<Layer::orbits>()));
    all.push_back(server_mutant(204, "no-round-waves", "computes a sea without round waves",
                                sea_without<Layer::round>()));
    all.push_back(server_mutant(204, "no-irregular-heights", "computes a sea without irregular heights",
                                sea_without<Layer::irregular>()));
    all.push_back(
        server_mutant(204, "no-wakes", "computes a sea without wakes", sea_without<Layer::wakes>()));
    all.push_back(
        server_mutant(204, "no-noise", "computes a sea without noise", sea_without<Layer::noise>()));
    all.push_back(server_mutant(205, "all-exact", "calls every client exact that has answered its challenge",
                                each_of_server<ClockReply>([](ClockReply& reply, const Talk&, Link&) {
                                    if (reply.verdict != trochoid::Verdict::approximate) return Fate::kept;
                                    reply.verdict = trochoid::Verdict::exact;
                                    return Fate::changed;
                                })));
    all.push_back(server_mutant(205, "none-exact", "calls no client exact",
                                each_of_server<ClockReply>([](ClockReply& reply, const Talk&, Link&) {
                                    if (reply.verdict != trochoid::Verdict::exact) return Fate::kept;
                                    reply.verdict = trochoid::Verdict::approximate;
                                    return Fate::changed;
                                })));
}

}  // namespace trochoid::conformance::mutants
