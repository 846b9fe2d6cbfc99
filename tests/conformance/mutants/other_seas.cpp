#include <algorithm>
#include <bit>

#include "tests/conformance/local_sea.hpp"
#include "tests/conformance/mutants/server_mutants.hpp"
#include "tests/conformance/other_arithmetic.hpp"

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

template <Layer layer>
SurfaceSample without(const Sea& sea, SeaTime time, LatticePoint place) {
    return SeaInstant(sea, time, authoritative_layers.without(layer)).evaluate(place);
}

template <Layer layer>
MakeSpoiler sea_without() {
    return [] { return std::make_unique<OtherSea>(without<layer>); };
}

template <Arithmetic how>
SurfaceSample by(const Sea& sea, SeaTime time, LatticePoint place) {
    return sample_by(how, SeaInstant(sea, time), place);
}

template <Arithmetic how>
MakeSpoiler sea_by() {
    return [] { return std::make_unique<OtherSea>(by<how>); };
}

float neighbour(float value) { return std::bit_cast<float>(std::bit_cast<uint32_t>(value) ^ 1U); }

}  // namespace

void add_other_seas(std::vector<Mutant>& all) {
    all.push_back(
        server_mutant(201, "fused-products", "fuses products and sums", sea_by<Arithmetic::fused>()));
    all.push_back(server_mutant(201, "wider-sums", "sums in double precision", sea_by<Arithmetic::wider>()));
    all.push_back(
        server_mutant(201, "four-sums", "sums trains in four lanes", sea_by<Arithmetic::four_sums>()));
    all.push_back(server_mutant(202, "coarse-phases", "computes phases of 24 bits",
                                sea_by<Arithmetic::short_phases>()));
    all.push_back(server_mutant(202, "double-phases", "computes phases in double precision",
                                sea_by<Arithmetic::double_phases>()));
    all.push_back(server_mutant(203, "library-cosine",
                                "takes sines and cosines from the mathematical library",
                                sea_by<Arithmetic::library_sine>()));
    all.push_back(
        server_mutant(203, "fused-sine", "computes sines in fused steps", sea_by<Arithmetic::fused_sine>()));
    all.push_back(server_mutant(203, "unfolded-sine", "computes sines as sums of powers",
                                sea_by<Arithmetic::unfolded_sine>()));
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
