#include "protocol/model/simd/scratch.hpp"

// Wakes act on few points of few boxes: the reference's own function, point by point, on the span's accumulators.
namespace trochoid::simd {

void add_wake(const PlannedBox& box, Scratch& at, int n) {
    const LiveBox& live = *box.live;
    SpanSums& m = at.sums;
    for (size_t i = 0; i < static_cast<size_t>(n); ++i) {
        const Envelope e{at.envelope.gain[i], at.envelope.dx[i], at.envelope.dz[i]};
        if (e.gain == 0) continue;
        const LatticePoint p{at.x[i], at.z[i]};
        Sums acc = sums_at(m, i);
        trochoid::add_wake(acc, live, e, p);
        m.ax[i] = acc.ax;
        m.ay[i] = acc.ay;
        m.az[i] = acc.az;
        m.bx[i] = acc.bx;
        m.bz[i] = acc.bz;
        m.mxx[i] = acc.mxx;
        m.mxz[i] = acc.mxz;
        m.mzx[i] = acc.mzx;
        m.mzz[i] = acc.mzz;
        m.vx[i] = acc.vx;
        m.vy[i] = acc.vy;
        m.vz[i] = acc.vz;
    }
}

}  // namespace trochoid::simd
