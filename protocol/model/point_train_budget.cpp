#include "protocol/model/point_train_budget.hpp"

#include <algorithm>
#include <array>

#include "protocol/model/arithmetic_rules.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

constexpr int most_nodes = 20'000;
/// Beyond, the greedy choice stands: the search goes as deep as there are trains.
constexpr size_t most_searched = 4096;

/// A train up for choice.
struct Item {
    size_t box = 0;
    uint16_t train = 0;
    double value = 0.0;  // metres, weighted by cover
    double cost = 0.0;   // point-trains
};

/// A box that reaches the region.
struct Candidate {
    const PreparedBox* box = nullptr;
    double points = 0.0;  // covered
    double cover = 0.0;   // share of the region
    double gain = 0.0;    // largest
};

double area_of(const LatticeRect& r) {
    const double x = static_cast<double>(r.max.x - r.min.x);
    const double z = static_cast<double>(r.max.z - r.min.z);
    return (x + 1.0) * (z + 1.0);
}

/// An upper bound: by the box's bounding rectangle.
double cover_of(const WaveTrainBox& box, const BudgetQuestion& q) {
    const LatticeRect b = bounds_over(box, q.from, q.until);
    if (!overlap(b, q.region)) return 0.0;
    const LatticeRect common{{std::max(b.min.x, q.region.min.x), std::max(b.min.z, q.region.min.z)},
                             {std::min(b.max.x, q.region.max.x), std::min(b.max.z, q.region.max.z)}};
    return area_of(common) / area_of(q.region);
}

std::vector<Candidate> candidates_of(const Sea& sea, const BudgetQuestion& q) {
    std::vector<Candidate> list;
    for (const auto& box : sea.boxes()) {
        const WaveTrainBox& r = box->record;
        if (!alive(r, q.from, q.until)) continue;
        const double cover = cover_of(r, q);
        if (cover <= 0.0) continue;
        const double irregular =
            q.wanted.has(Layer::irregular) ? static_cast<double>(r.irregular.share) / 32768.0 : 0.0;
        const double land = q.wanted.has(Layer::shelter) ? static_cast<double>(r.gain_max) / 32768.0 : 1.0;
        list.push_back({box.get(), q.points * cover, cover, land * (1.0 + irregular)});
    }
    return list;
}

/// Most valuable for its cost first; equal ones in the order of the sum.
std::vector<Item> items_of(const std::vector<Candidate>& boxes) {
    std::vector<Item> items;
    for (size_t b = 0; b < boxes.size(); ++b) {
        const auto& trains = boxes[b].box->record.trains;
        for (size_t t = 0; t < trains.size(); ++t) {
            const double metres = static_cast<double>(trains[t].amplitude) * boxes[b].gain;
            items.push_back({b, static_cast<uint16_t>(t), metres * boxes[b].cover, boxes[b].points});
        }
    }
    std::stable_sort(items.begin(), items.end(),
                     [](const Item& a, const Item& b) { return a.value * b.cost > b.value * a.cost; });
    return items;
}

/// 0/1 knapsack: greedy first, then depth-first branch and bound with the fractional relaxation as upper bound.
class Knapsack {
public:
    Knapsack(const std::vector<Item>& items, double budget)
        : items_(items), budget_(budget), taken_(items.size()), best_(items.size()) {}

    void solve() {
        root_bound_ = bound(0, 0.0, 0.0);
        take_greedily();
        if (items_.size() > most_searched) return;
        descend(0, 0.0, 0.0);
        if (nodes_ < most_nodes) root_bound_ = best_value_;
    }
    const std::vector<bool>& best() const { return best_; }
    /// Metres, weighted by cover, by which the choice may fall short of the best.
    double gap() const { return std::max(root_bound_ - best_value_, 0.0); }

private:
    double bound(size_t from, double value, double cost) const {
        for (size_t i = from; i < items_.size(); ++i) {
            if (cost + items_[i].cost > budget_)
                return value + items_[i].value * ((budget_ - cost) / items_[i].cost);
            cost = cost + items_[i].cost;
            value = value + items_[i].value;
        }
        return value;
    }

    void take_greedily() {
        double cost = 0.0;
        for (size_t i = 0; i < items_.size(); ++i) {
            if (cost + items_[i].cost > budget_) continue;
            best_[i] = true;
            cost = cost + items_[i].cost;
            best_value_ = best_value_ + items_[i].value;
        }
    }

    void descend(size_t i, double value, double cost) {
        if (nodes_ >= most_nodes) return;
        ++nodes_;
        if (value > best_value_) {
            best_value_ = value;
            best_ = taken_;
        }
        if (i == items_.size() || bound(i, value, cost) <= best_value_) return;
        if (cost + items_[i].cost <= budget_) {
            taken_[i] = true;
            descend(i + 1, value + items_[i].value, cost + items_[i].cost);
            taken_[i] = false;
        }
        descend(i + 1, value, cost);
    }

    const std::vector<Item>& items_;
    double budget_;
    std::vector<bool> taken_;
    std::vector<bool> best_;
    double best_value_ = 0.0;
    double root_bound_ = 0.0;
    int nodes_ = 0;
};

/// What the layer costs over the kept trains, and the metres that its absence may change.
struct LayerBill {
    double cost = 0.0;
    double lost = 0.0;
};

LayerBill bill_of(Layer layer, const Candidate& c, const std::vector<uint16_t>& kept,
                  const LayerCosts& costs) {
    const WaveTrainBox& r = c.box->record;
    double height = 0.0;
    double land_height = 0.0;
    double on_land = 0.0;
    for (const uint16_t t : kept) {
        const double a = static_cast<double>(r.trains[t].amplitude);
        height = height + a;
        if (c.box->field_of_train[t] < 0) continue;
        on_land = on_land + 1.0;
        land_height = land_height + a;
    }
    const double gain = static_cast<double>(r.gain_max) / 32768.0;
    const double share = static_cast<double>(r.irregular.share) / 32768.0;
    const double octaves = static_cast<double>(r.noise.octaves);
    const bool noisy = r.noise.amplitude != 0.0F;
    switch (layer) {
        // The gain lies in [0, gain_max] where the open sea's is 1.
        case Layer::shelter:
            return {costs.shelter * on_land, std::max(gain - 1.0, 1.0) * land_height * (1.0 + share)};
        case Layer::refraction: return {costs.refraction * on_land, 2.0 * gain * land_height * (1.0 + share)};
        case Layer::wakes: return has_wake(r.wake) ? LayerBill{costs.wakes, wake_bound(r.wake)} : LayerBill{};
        case Layer::irregular:
            return share > 0.0 ? LayerBill{costs.irregular, share * gain * height} : LayerBill{};
        // Horizontal orbits alone: no rest point's height changes.
        case Layer::orbits: return {costs.orbits * on_land, 0.0};
        case Layer::round:
            return r.roundness != 0 ? LayerBill{costs.round * static_cast<double>(kept.size()),
                                                2.0 * gain * height * (1.0 + share)}
                                    : LayerBill{};
        case Layer::noise:
        case Layer::displayed_noise:
            return noisy && r.noise.displayed_only == (layer == Layer::displayed_noise)
                       ? LayerBill{costs.noise_octave * octaves, noise_bound(r.noise)}
                       : LayerBill{};
        case Layer::trains: break;
    }
    return {};
}

/// Buys the layers after the trains, in order, until one does not fit.
void buy_layers(BudgetChoice& choice, const std::vector<Candidate>& boxes, const BudgetQuestion& q) {
    constexpr std::array order = {Layer::shelter, Layer::refraction, Layer::wakes, Layer::irregular,
                                  Layer::orbits,  Layer::round,      Layer::noise, Layer::displayed_noise};
    bool buying = true;
    for (const Layer layer : order) {
        if (!q.wanted.has(layer)) continue;
        LayerBill bill;
        for (size_t b = 0; b < boxes.size(); ++b) {
            const LayerBill one = bill_of(layer, boxes[b], choice.boxes[b].trains, q.costs);
            bill.cost = bill.cost + one.cost * boxes[b].points;
            bill.lost = bill.lost + one.lost;
        }
        choice.asked = choice.asked + bill.cost;
        buying = buying && choice.spent + bill.cost <= q.point_trains;
        if (buying) {
            choice.spent = choice.spent + bill.cost;
            choice.layers = choice.layers.with(layer);
        } else {
            choice.layers_lost = choice.layers_lost + bill.lost;
        }
    }
}

}  // namespace

BudgetChoice choose_within(const Sea& sea, const BudgetQuestion& q) {
    TROCHOID_ASSERT(q.points > 0.0 && q.point_trains >= 0.0, "a budget of {} point-trains for {} points",
                    q.point_trains, q.points);
    BudgetChoice choice;
    const std::vector<Candidate> boxes = candidates_of(sea, q);
    for (const Candidate& c : boxes) choice.boxes.push_back({c.box->record.id, {}});
    if (!q.wanted.has(Layer::trains)) {
        buy_layers(choice, boxes, q);
        return choice;
    }
    choice.layers = choice.layers.with(Layer::trains);
    const std::vector<Item> items = items_of(boxes);
    Knapsack sack(items, q.point_trains);
    sack.solve();
    choice.gap = sack.gap();
    choice.best = choice.gap == 0.0;
    for (size_t i = 0; i < items.size(); ++i) {
        choice.asked = choice.asked + items[i].cost;
        if (sack.best()[i]) {
            choice.boxes[items[i].box].trains.push_back(items[i].train);
            choice.spent = choice.spent + items[i].cost;
        } else {
            choice.trains_lost = choice.trains_lost + items[i].value / boxes[items[i].box].cover;
        }
    }
    for (BoxShare& share : choice.boxes) std::sort(share.trains.begin(), share.trains.end());
    buy_layers(choice, boxes, q);
    return choice;
}

Sea reduced(const Sea& sea, const BudgetChoice& choice) {
    std::vector<std::shared_ptr<const PreparedBox>> kept;
    auto next = choice.boxes.begin();
    for (const auto& box : sea.boxes()) {
        while (next != choice.boxes.end() && next->box < box->record.id) ++next;
        if (next == choice.boxes.end() || next->box != box->record.id) continue;
        if (next->trains.size() == box->record.trains.size()) {
            kept.push_back(box);
            continue;
        }
        auto fewer = std::make_shared<PreparedBox>(*box);
        fewer->record.trains.clear();
        fewer->constants.clear();
        fewer->field_of_train.clear();
        for (const uint16_t t : next->trains) {
            fewer->record.trains.push_back(box->record.trains[t]);
            fewer->constants.push_back(box->constants[t]);
            fewer->field_of_train.push_back(box->field_of_train[t]);
        }
        kept.push_back(std::move(fewer));
    }
    return Sea(std::move(kept));
}

}  // namespace trochoid
