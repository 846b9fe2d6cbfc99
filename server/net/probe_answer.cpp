#include "server/net/probe_answer.hpp"

#include <utility>

#include "protocol/model/probe_sum.hpp"

namespace trochoid {

ProbeReply answer_probe(const InterestState& state, const Probe& probe) {
    ProbeReply reply;
    reply.sequence = probe.sequence;
    reply.result = probe.result;
    reply.time = probe.time;
    size_t listed = 0;
    for (const LatticePoint p : probe.points) {
        const PointSum sum = probe_sum(state, probe.time, p, most_probe_parts);
        listed += sum.parts.size();
        if (listed > most_probe_parts) break;
        ProbedPoint point;
        point.sample = sum.sample;
        point.parts.reserve(sum.parts.size());
        for (const PartSum& part : sum.parts) point.parts.push_back({part.box, part.part, part.sum});
        reply.points.push_back(std::move(point));
    }
    return reply;
}

}  // namespace trochoid
