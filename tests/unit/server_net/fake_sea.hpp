#pragma once
#include <atomic>
#include <deque>
#include <functional>

#include "server/net/sea_provider.hpp"

namespace trochoid {

/// A small sea for session tests: one box, `patches` patches around the view whose errors change with `revision`, `bulk` boxes of
/// 5 KiB that change with it, and a square of terrain tiles. Everything belongs to the io thread, except what is atomic.
class FakeSea final : public SeaProvider {
public:
    std::atomic<uint32_t> patches{16};
    std::atomic<uint32_t> bulk{0};  ///< what makes a result large: patches cost little
    std::atomic<uint64_t> revision{1};
    std::atomic<uint32_t> tiles{0};
    std::atomic<uint32_t> changed_tiles{0};  ///< so many of the first are at revision 1, all others at 0
    std::atomic<uint64_t> results_made{0};
    std::atomic<int64_t> refresh_after_us{0};  ///< 0: never
    std::atomic<uint64_t> last_over{0};        ///< the session that ended last
    std::atomic<uint64_t> resumes_asked{0};    ///< claims that reached the sea
    std::atomic<bool> holds_aside{false};      ///< results aside wait for `release_aside`
    std::atomic<uint64_t> asked_aside{0};
    std::atomic<int64_t> costs_us{0};  ///< a result that is not made aside
    std::atomic<bool> lies{false};     ///< the next result has a wrong train; probes tell the truth
    /// Set before the server starts.
    std::string token = "secret";  ///< makes directors, any number of times

    HelloFacts hello_facts() const override;
    ClockFacts clock_facts() const override;
    Result<LoginDecision> login(const ClientHello& hello, bool loopback) override;
    IssuedTicket new_ticket(uint64_t session, Role role) override;
    std::optional<MadeResult> make_result(const ResultRequest& request) override;
    void make_result_aside(const ResultRequest& request,
                           const std::function<void(std::optional<MadeResult>)>& done) override;
    Resumption resume(const ResumeState& claim) override;
    ProbeReply probe(const InterestState& state, const Probe& probe) const override;
    InterestDelta change(const InterestState& base, const InterestState& target,
                         const CullKey& key) const override;
    std::vector<TerrainTileKey> tiles_for(const ViewState& view) override;
    uint32_t tile_revision(TerrainTileKey key) const override;
    TerrainTile tile(TerrainTileKey key) override;
    void command(const Command& command, Role role, uint64_t session,
                 std::function<void(CommandReply)> reply) override;
    void session_over(uint64_t session) override { last_over = session; }
    BoxList list_boxes() const override;
    Result<SampleReply> sample(const SampleRequest& request) const override;
    Result<RaysReply> rays(const RaysRequest& request) const override;

    /// The state that a client has to end up with for this view.
    InterestState state_for(const ViewState& view) const;
    /// Hands over the result aside that has waited longest; false: none waits. On the io thread.
    bool release_aside();

private:
    std::optional<MadeResult> result_for(const ResultRequest& request);

    std::deque<std::function<void()>> aside_;
};

}  // namespace trochoid
