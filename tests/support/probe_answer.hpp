#pragma once
#include "protocol/codec/messages.hpp"
#include "protocol/model/interest_state.hpp"
#include "protocol/model/probe_sum.hpp"

namespace trochoid {

/// What a server that holds this state for its client answers, without bounds on parts.
inline ProbeReply answer_from(const InterestState& state, const Probe& probe) {
    ProbeReply reply;
    reply.sequence = probe.sequence;
    reply.result = probe.result;
    reply.time = probe.time;
    for (const LatticePoint p : probe.points) {
        const PointSum sum = probe_sum(state, probe.time, p);
        ProbedPoint point;
        point.sample = sum.sample;
        for (const PartSum& part : sum.parts) point.parts.push_back({part.box, part.part, part.sum});
        reply.points.push_back(point);
    }
    return reply;
}

}  // namespace trochoid
