#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/app/result_worker.hpp"
#include "server/app/sea_authority.hpp"
#include "server/app/token_door.hpp"
#include "server/net/probe_answer.hpp"
#include "server/net/sea_provider.hpp"

namespace trochoid {

/// What sessions ask of the sea, answered from the authority's published state. On the io thread.
class SeaService final : public SeaProvider {
public:
    /// `aside`: where results that hold up nobody are computed; it outlives this object, and the loop does not run after it. nullptr: at
    /// once, on the io thread.
    SeaService(SeaAuthority& authority, WorldInstance instance, TokenDoor& door,
               ResultWorker* aside = nullptr);

    HelloFacts hello_facts() const override;
    ClockFacts clock_facts() const override;
    Result<LoginDecision> login(const ClientHello& hello, bool loopback) override {
        return door_.login(hello, loopback, authority_.state()->name, instance_);
    }
    IssuedTicket new_ticket(uint64_t session, Role role) override {
        return door_.new_ticket(session, role, instance_);
    }
    std::optional<MadeResult> make_result(const ResultRequest& request) override;
    void make_result_aside(const ResultRequest& request,
                           const std::function<void(std::optional<MadeResult>)>& done) override;
    Resumption resume(const ResumeState& claim) override;
    ProbeReply probe(const InterestState& state, const Probe& probe) const override {
        return answer_probe(state, probe);
    }
    InterestDelta change(const InterestState& base, const InterestState& target,
                         const CullKey& key) const override;
    std::vector<TerrainTileKey> tiles_for(const ViewState& view) override {
        return authority_.terrain_choice()->tiles_for(view);
    }
    uint32_t tile_revision(TerrainTileKey key) const override {
        return authority_.terrain_choice()->revision(key);
    }
    TerrainTile tile(TerrainTileKey key) override { return authority_.terrain_choice()->tile(key); }
    void command(const Command& command, Role role, uint64_t session,
                 std::function<void(CommandReply)> reply) override;
    void session_over(uint64_t session) override { authority_.session_over(session); }
    BoxList list_boxes() const override;
    Result<SampleReply> sample(const SampleRequest& request) const override;
    Result<RaysReply> rays(const RaysRequest& request) const override;

private:
    int64_t refresh_at_us(const CullKey& key) const;
    ResumeVerdict judge(const ResumeState& claim, MadeResult& held) const;

    SeaAuthority& authority_;
    WorldInstance instance_;
    TokenDoor& door_;
    ResultWorker* aside_;
};

}  // namespace trochoid
