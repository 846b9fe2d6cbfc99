#include "client/scene/train_account.hpp"

#include "protocol/model/point_train_budget.hpp"

namespace trochoid {

namespace {

const PatchDescriptor* patch_of(const InterestState& state, LatticePoint place) {
    for (uint8_t level = finest_patch_level; level <= coarsest_patch_level; ++level) {
        const auto found = state.patches.find(patch_at(place, level));
        if (found != state.patches.end()) return &found->second;
    }
    return nullptr;
}

}  // namespace

Layers layers_in(const InterestState& state) {
    Layers layers = Layers{}.with(Layer::trains);
    if (!state.blocks.empty())
        layers = layers.with(Layer::shelter).with(Layer::refraction).with(Layer::orbits);
    for (const auto& [id, box] : state.boxes) {
        if (has_wake(box->wake)) layers = layers.with(Layer::wakes);
        if (box->irregular.share != 0) layers = layers.with(Layer::irregular);
        if (box->roundness != 0) layers = layers.with(Layer::round);
        if (box->noise.amplitude != 0.0F)
            layers = layers.with(box->noise.displayed_only ? Layer::displayed_noise : Layer::noise);
    }
    return layers;
}

TrainAccount account_of(const InterestState& state, LatticePoint place, SeaTime now, float spacing_m,
                        Layers layers) {
    TrainAccount account;
    const PatchDescriptor* patch = patch_of(state, place);
    BudgetQuestion question;
    question.region = rect_of(patch != nullptr ? patch->key : patch_at(place, finest_patch_level));
    question.from = now;
    question.until = now + microseconds_per_second;
    question.points = 1.0;
    question.wanted = layers;
    if (patch != nullptr) {
        account.server_left_out_m = static_cast<double>(patch->left_out);
        account.patch_side_m = to_metres(question.region.max.x - question.region.min.x);
    }
    if (!layers.has(Layer::trains)) return account;

    std::vector<std::shared_ptr<const PreparedBox>> boxes;
    for (const auto& [id, record] : state.boxes) {
        if (!alive(*record, question.from, question.until) ||
            !overlap(bounds_over(*record, question.from, question.until), question.region))
            continue;
        boxes.push_back(prepare(*record, {}));
        const double gain =
            layers.has(Layer::shelter) ? static_cast<double>(record->gain_max) / 32768.0 : 1.0;
        for (const TrainConstants& train : boxes.back()->constants) {
            const float share = displayed_weight(train.wavelength, spacing_m);
            ++account.known;
            if (share > 0.0F) ++account.shown;
            account.lost_m += static_cast<double>(train.a) * gain * static_cast<double>(1.0F - share);
        }
    }
    question.point_trains = static_cast<double>(account.shown);
    question.wanted = Layers{}.with(Layer::trains);
    if (layers.has(Layer::shelter)) question.wanted = question.wanted.with(Layer::shelter);
    const BudgetChoice best = choose_within(Sea(std::move(boxes)), question);
    account.best_lost_m = best.trains_lost;
    account.best_proven = best.best;
    return account;
}

}  // namespace trochoid
