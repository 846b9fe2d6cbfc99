#include <cmath>

#include "client/store/client_store.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/wire_mutation.hpp"

namespace trochoid {

namespace {

bool all_finite(const SurfaceSample& s) {
    for (const float v :
         {s.ax, s.ay, s.az, s.pxx, s.pxz, s.pzx, s.pzz, s.yx, s.yz, s.nx, s.ny, s.nz, s.vx, s.vy, s.vz})
        if (!std::isfinite(v)) return false;
    return true;
}

/// The sea of a snapshot can be asked, anywhere and at any time.
void ask(const StoreSnapshot& snapshot, Dice& dice) {
    TROCHOID_ASSERT(snapshot.sea.boxes().size() == snapshot.interest->boxes.size(),
                    "{} boxes in the sea, {} told", snapshot.sea.boxes().size(),
                    snapshot.interest->boxes.size());
    SeaTime time = snapshot.key.from;
    LatticePoint place{dice.between(-world_bound, world_bound), dice.between(-world_bound, world_bound)};
    if (!snapshot.sea.boxes().empty()) {
        const auto most = static_cast<int64_t>(snapshot.sea.boxes().size()) - 1;
        const WaveTrainBox& box = snapshot.sea.boxes()[static_cast<size_t>(dice.between(0, most))]->record;
        time = {std::min(box.begin.us + dice.between(0, int64_t{1} << dice.between(1, 50)), sea_time_bound)};
        const int64_t reach = int64_t{1} << dice.between(1, 30);
        place = {std::clamp(box.origin.x + dice.between(-reach, reach), -world_bound, world_bound),
                 std::clamp(box.origin.z + dice.between(-reach, reach), -world_bound, world_bound)};
    }
    const SeaInstant instant(snapshot.sea, time);
    TROCHOID_ASSERT(all_finite(instant.evaluate(place)), "the sea is not finite at {}, {} at {}", place.x,
                    place.z, time.us);
}

/// A delta as a server would send it that knows what this client holds: so that the rest of it counts.
void make_it_fit(Delta& delta, uint32_t result, const InterestState& held) {
    delta.result = result;
    delta.piece = 0;
    delta.last = true;
    delta.base = delta.base == 0 || result == 1 ? 0 : result - 1;
    delta.base_hash = hash_of(held);
    InterestState after = delta.base == 0 ? InterestState{} : held;
    apply(after, delta.change);
    delta.state_hash = hash_of(after);
}

/// Whatever a server sends in whatever order, the store's snapshots are whole, hash as they say, and keep the limits.
void check_store(std::span<const uint8_t> input) {
    InputReader control(input);
    const uint8_t flags = control.byte();
    Dice dice(flags);
    constexpr StoreLimits limits{size_t{1} << 14, 256};
    ClientStore store(limits);
    uint32_t result = 0;
    for (const Bytes& payload : payloads_of(control.rest())) {
        auto message = decode_server(payload);
        if (!message) return check_refusal(message.error());
        const auto before = store.snapshot();
        if (const auto* hello = std::get_if<ServerHello>(&*message)) {
            store.begin(*hello);
            result = 0;
        } else if (auto* delta = std::get_if<Delta>(&*message)) {
            const bool fits = (flags & 1U) != 0;
            if (fits) make_it_fit(*delta, result + 1, *before->interest);
            const auto ack = store.apply(*delta);
            if (!ack) {
                TROCHOID_ASSERT(store.snapshot() == before, "a refused delta has changed the snapshot");
                return check_refusal(ack.error());
            }
            const auto now = store.snapshot();
            if (!*ack || (*ack)->state_hash == 0) {
                TROCHOID_ASSERT(now == before, "a snapshot of half a result");
                TROCHOID_ASSERT(!fits || *ack, "a whole result without an ack");
                if (fits) return;  // a resync was asked for: what follows would not fit
                continue;
            }
            result = delta->result;
            TROCHOID_ASSERT((*ack)->result == delta->result && now->result == delta->result, "ack of {}",
                            (*ack)->result);
            TROCHOID_ASSERT(
                (*ack)->state_hash == hash_of(*now->interest) && (*ack)->state_hash == delta->state_hash,
                "the ack's hash is not the snapshot's");
            TROCHOID_ASSERT(now->interest->blocks.size() <= limits.land_blocks, "{} blocks",
                            now->interest->blocks.size());
            for (int i = 0; i < 3; ++i) ask(*now, dice);
        } else if (const auto* tiles = std::get_if<TerrainTiles>(&*message)) {
            if (const auto done = store.apply(*tiles); !done) return check_refusal(done.error());
        } else if (const auto* reply = std::get_if<ClockReply>(&*message)) {
            store.confirm(reply->watermark, reply->log_position);
            TROCHOID_ASSERT(store.snapshot()->watermark >= before->watermark, "the watermark has fallen");
        }
    }
}

}  // namespace

const FuzzTarget store_target{"store", check_store, 40'000, [](const Bytes& in, Dice& dice, size_t most) {
                                  return mutate_frames(server_form(), in, dice, most);
                              }};

}  // namespace trochoid
