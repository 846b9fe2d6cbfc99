#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/app/director_token.hpp"
#include "server/app/sea_authority.hpp"
#include "server/net/sea_provider.hpp"

namespace trochoid {

/// What sessions ask of the sea, answered from the authority's published state. On the io thread.
class SeaService final : public SeaProvider {
public:
    SeaService(SeaAuthority& authority, WorldInstance instance, DirectorToken token);

    HelloFacts hello_facts() const override;
    ClockFacts clock_facts() const override;
    Result<Role> role_for(const std::string& token) const override { return token_.role_for(token); }
    std::optional<MadeResult> make_result(const ResultRequest& request) override;
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

    SeaAuthority& authority_;
    WorldInstance instance_;
    DirectorToken token_;
};

}  // namespace trochoid
