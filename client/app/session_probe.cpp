// Now and then a few sums are compared with the server's (protocol/README.md, "Probes").
#include "client/app/session_link.hpp"
#include "client/store/desync_probe.hpp"
#include "protocol/units/hash.hpp"
#include "protocol/wire/session_rules.hpp"

namespace trochoid {

namespace {

constexpr size_t points_a_round = 4;
constexpr std::chrono::milliseconds probe_interval{30'000};
/// While no result is whole, or another came in between.
constexpr std::chrono::milliseconds probe_again{1'000};
/// A server takes a difference every 5 s.
constexpr std::chrono::milliseconds after_desync{8'000};

}  // namespace

void SessionLink::probe_after(std::chrono::milliseconds pause) {
    const ServerHello& hello = *store_.hello();
    if (hello.protocol < first_with_probes || (hello.capabilities & capability_probes) == 0) return;
    if (probe_round_ == 0) probe_round_ = 1;
    loop_.after(pause, [this, row = ++probe_row_] { probe(row); });
}

void SessionLink::probe(uint64_t row) {
    if (row != probe_row_ || !live_) return;
    const auto held = store_.snapshot();
    if (held->result == 0 || !store_.resume_state()) return probe_after(probe_again);
    Probe request;
    request.result = held->result;
    request.points = probe_points(*held->interest, held->regions,
                                  splitmix64(store_.hello()->session) + probe_round_, points_a_round);
    if (request.points.empty()) return probe_after(probe_interval);
    {
        const std::lock_guard lock(board_.mutex);
        // Who computes another sea knows it, and would find nothing else here.
        if (board_.fidelity == Fidelity::approximate) return;
        request.time = board_.clock.sea_time(client_monotonic_us());
    }
    ++probe_round_;
    probe_after(probe_interval);
    Question question;
    question.take = [this, held, request](ServerMessage& message) {
        // A refusal says that the server is busy.
        if (const auto* reply = std::get_if<ProbeReply>(&message)) probed(request, *held, *reply);
        return true;
    };
    question.fail = [](const Error&) {};
    ask(
        [&](uint32_t sequence) {
            request.sequence = sequence;
            return request;
        },
        std::move(question));
}

void SessionLink::probed(const Probe& asked, const StoreSnapshot& held, const ProbeReply& reply) {
    if (reply.stale) return probe_after(probe_again);
    const auto finding = compare(reply, asked, *held.interest);
    if (!finding) return connection_->refuse(finding.error());
    store_.probed(finding->compared);
    if (finding->difference) {
        Desync desync = *finding->difference;
        desync.sequence = ++sequence_;
        store_.distrust();
        connection_->send(desync);
        probe_after(after_desync);
    }
    show_store();
}

}  // namespace trochoid
