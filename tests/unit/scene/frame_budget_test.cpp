// The controller over made-up machines: it reaches what can be reached, holds still there, and gives back what it took.
#include "client/scene/frame_budget.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace trochoid {
namespace {

/// Milliseconds of a picture drawn with some options.
using Machine = std::function<double(const DrawOptions&)>;

/// Time goes with vertices times what each costs, and with pixels times their samples.
struct Model {
    double fixed_ms = 2;
    double vertex_ms = 30;      // at an error of 6 px with all layers
    double elasticity = 2;      // of the vertices' time in 1 / error
    double sample_ms = 4;       // a sample, at full resolution
    double layer_share = 0.08;  // of the vertices' time, each layer but the trains
    double operator()(const DrawOptions& o) const {
        double vertices = vertex_ms * std::pow(6.0 / static_cast<double>(o.error_px), elasticity);
        const double pixels = sample_ms * static_cast<double>(o.render_scale * o.render_scale);
        double layers = 1.0;
        for (int bit = 1; bit <= 8; ++bit)
            if ((o.layers.bits & (1 << bit)) == 0) layers -= layer_share;
        return fixed_ms + vertices * layers + pixels * o.samples + (o.spray ? 0.5 : 0.0);
    }
};

DrawOptions wanted_options() {
    DrawOptions options = options_for(Quality::medium);
    options.samples = 4;
    return options;
}

/// A controller on a machine whose times scatter and arrive some pictures late, as a GPU's timers do.
class Drawing {
public:
    Drawing(double target_ms, Machine machine, double scatter = 0.0, size_t delay = 0)
        : budget(target_ms), machine_(std::move(machine)), scatter_(scatter), delay_(delay) {}

    void draw(int pictures) {
        for (int i = 0; i < pictures; ++i) {
            pipeline_.push_back(machine_(budget.apply(wanted)) * std::exp(scatter_ * normal_(dice_)));
            if (pipeline_.size() <= delay_) continue;
            if (budget.add(pipeline_.front(), wanted)) ++changes;
            pipeline_.erase(pipeline_.begin());
        }
    }
    double time() const { return machine_(budget.apply(wanted)); }
    void become(Machine machine) { machine_ = std::move(machine); }

    DrawOptions wanted = wanted_options();
    FrameBudget budget;
    int changes = 0;

private:
    Machine machine_;
    double scatter_;
    size_t delay_;
    std::vector<double> pipeline_;
    std::mt19937 dice_{7};
    std::normal_distribution<double> normal_;
};

TEST(FrameBudget, gives_nothing_up_where_there_is_time) {
    Drawing run(100, Model{});
    run.draw(300);
    EXPECT_EQ(run.changes, 0);
    EXPECT_EQ(run.budget.apply(run.wanted), run.wanted);
    EXPECT_EQ(run.budget.report().verdict, BudgetVerdict::all_wanted);
}

/// For machines of all kinds: bound by vertices, by pixels, by neither.
class Reach : public ::testing::TestWithParam<std::tuple<double, double, double>> {};

TEST_P(Reach, comes_within_a_tenth_and_stays) {
    const auto [elasticity, sample_ms, share] = GetParam();
    const Model machine{2, 30, elasticity, sample_ms, 0.08};
    const double all = machine(wanted_options());
    DrawOptions least = wanted_options();
    least.error_px *= static_cast<float>(FrameBudget::coarsest_factor);
    least.samples = 1;
    least.lean = true;
    least.render_scale = 0.5F;
    least.spray = least.foam_history = false;
    least.layers = Layers{}.with(Layer::trains);
    const double target = all * share;
    Drawing run(target, machine, 0.0, 4);
    run.draw(600);
    if (machine(least) <= target) {
        EXPECT_LE(run.time(), target * 1.1) << "still too slow";
        // Below the target something must still be given up for a reason: the next thing back would not fit, or nothing is given up.
        const BudgetReport report = run.budget.report();
        if (run.time() < target * 0.8) {
            EXPECT_LT(report.error_factor, 1.05);
        }
    }
    const int changes = run.changes;
    run.draw(3000);
    EXPECT_LE(run.changes - changes, 16) << "it swings";
    if (machine(least) <= target) {
        EXPECT_LE(run.time(), target * 1.1);
    }
}

INSTANTIATE_TEST_SUITE_P(Machines, Reach,
                         ::testing::Combine(::testing::Values(0.3, 1.0, 2.0, 3.5),
                                            ::testing::Values(0.5, 8.0),
                                            ::testing::Values(0.95, 0.7, 0.4, 0.2, 0.05)));

TEST(FrameBudget, takes_the_mesh_first_and_layers_by_reverse_importance) {
    Drawing run(26, Model{});
    std::vector<Sacrifice> order;
    for (double target : {40.0, 30.0, 20.0, 12.0, 8.0, 6.0, 3.0}) {
        Drawing each(target, Model{});
        each.draw(900);
        const auto given = each.budget.report().given_up;
        if (target >= 40.0) {
            EXPECT_TRUE(given.empty()) << "a coarser mesh is enough";
            EXPECT_GT(each.budget.report().error_factor, 1.05);
        }
        // What a smaller target gives up begins with what a larger one gave up.
        ASSERT_GE(given.size(), order.size());
        EXPECT_TRUE(std::equal(order.begin(), order.end(), given.begin()));
        order = given;
    }
    EXPECT_EQ(order.front(), Sacrifice::samples);
    EXPECT_EQ(order.back(), Sacrifice::shelter);
    EXPECT_EQ(sacrifices_of(wanted_options()), order);
}

/// A lean picture has nothing of it left to give; what is left is refined by what it looks like.
TEST(FrameBudget, a_lean_picture_is_given_once) {
    DrawOptions wanted = wanted_options();
    EXPECT_EQ(refinement_in_force(wanted), Refinement::distance);
    EXPECT_EQ(sacrifices_of(wanted)[1], Sacrifice::full_detail);
    wanted.lean = true;
    EXPECT_EQ(refinement_in_force(wanted), Refinement::screen);
    const auto left = sacrifices_of(wanted);
    EXPECT_EQ(std::count(left.begin(), left.end(), Sacrifice::full_detail), 0);
    wanted.refinement = Refinement::frustum;
    EXPECT_EQ(refinement_in_force(wanted), Refinement::frustum) << "what was asked for by name stays";
}

TEST(FrameBudget, says_so_where_a_target_cannot_be_reached) {
    Drawing run(1, Model{});
    run.draw(1500);
    EXPECT_EQ(run.budget.report().verdict, BudgetVerdict::exhausted);
    EXPECT_EQ(run.budget.report().left_to_give, 0U);
    EXPECT_DOUBLE_EQ(run.budget.report().error_factor, FrameBudget::coarsest_factor);
    const int changes = run.changes;
    run.draw(2000);
    EXPECT_EQ(run.changes, changes);
    EXPECT_TRUE(run.budget.apply(run.wanted).layers.has(Layer::trains)) << "the trains are the sea";
}

TEST(FrameBudget, holds_still_under_noise) {
    for (const double scatter : {0.05, 0.2, 0.4}) {
        Drawing run(24, Model{}, scatter, 4);
        run.draw(1200);
        const double reached = run.time();
        EXPECT_NEAR(reached, 24.0, 24.0 * (0.1 + scatter / 4)) << scatter;
        const int changes = run.changes;
        run.draw(6000);
        EXPECT_LE(run.changes - changes, 40) << scatter;
        EXPECT_NEAR(run.time(), 24.0, 24.0 * (0.1 + scatter / 4)) << scatter;
    }
}

TEST(FrameBudget, an_odd_slow_picture_changes_nothing) {
    int picture = 0;
    const Model model;
    Drawing run(60, [&](const DrawOptions& o) { return model(o) * (++picture % 9 == 0 ? 6.0 : 1.0); });
    run.draw(900);
    EXPECT_EQ(run.changes, 0);
}

TEST(FrameBudget, follows_a_load_that_rises_and_falls) {
    const Model light;
    Model heavy;
    heavy.vertex_ms = 150;
    Drawing run(60, light, 0.05, 4);
    run.draw(300);
    EXPECT_EQ(run.budget.apply(run.wanted), run.wanted);
    run.become(heavy);
    run.draw(400);
    EXPECT_LE(run.time(), 66.0);
    EXPECT_GT(run.time(), 48.0);
    run.become(light);
    run.draw(1200);
    EXPECT_EQ(run.budget.apply(run.wanted), run.wanted) << "all that is wanted comes back";
}

TEST(FrameBudget, a_layer_that_does_not_fit_is_not_tried_again_and_again) {
    // Half of the time is one layer's, and the mesh costs nothing: with it 30 ms, without it 15.
    const Machine machine = [](const DrawOptions& o) {
        return o.layers.has(Layer::displayed_noise) ? 30.0 : 15.0;
    };
    Drawing run(25, machine, 0.1);
    run.wanted.samples = 1;
    run.draw(5000);
    EXPECT_FALSE(run.budget.apply(run.wanted).layers.has(Layer::displayed_noise));
    EXPECT_LE(run.changes, 30);
}

TEST(FrameBudget, takes_over_what_the_person_wants) {
    Drawing run(24, Model{}, 0.0, 0);
    run.draw(600);
    run.wanted.samples = 1;
    run.wanted.layers = run.wanted.layers.without(Layer::displayed_noise);
    run.draw(600);
    for (const Sacrifice s : run.budget.report().given_up) {
        EXPECT_NE(s, Sacrifice::samples);
        EXPECT_NE(s, Sacrifice::displayed_noise);
    }
    EXPECT_LE(run.time(), 26.4);
    // Times that are none are passed by.
    EXPECT_FALSE(run.budget.add(std::nan(""), run.wanted));
    EXPECT_FALSE(run.budget.add(0.0, run.wanted));
}

TEST(FrameBudget, does_not_give_up_what_the_sea_has_not) {
    const Layers present = Layers{}.with(Layer::trains).with(Layer::noise);
    FrameBudget budget(1);
    const DrawOptions wanted = wanted_options();
    for (int i = 0; i < 600; ++i) budget.add(20, wanted, present);
    EXPECT_EQ(budget.report().verdict, BudgetVerdict::exhausted);
    const std::vector<Sacrifice> expected{
        Sacrifice::samples, Sacrifice::full_detail, Sacrifice::spray,          Sacrifice::foam_history,
        Sacrifice::noise,   Sacrifice::resolution,  Sacrifice::half_resolution};
    EXPECT_EQ(budget.report().given_up, expected);
    // Ships have come: their wakes go in their turn.
    for (int i = 0; i < 600; ++i) budget.add(20, wanted, present.with(Layer::wakes));
    EXPECT_EQ(budget.report().given_up.back(), Sacrifice::wakes);
    EXPECT_EQ(budget.report().given_up.size(), expected.size() + 1);
}

TEST(FrameBudget, names_everything) {
    for (const Sacrifice s : sacrifices_of(wanted_options())) EXPECT_FALSE(name_of(s).empty());
    for (int i = 0; i <= static_cast<int>(BudgetVerdict::exhausted); ++i)
        EXPECT_FALSE(name_of(static_cast<BudgetVerdict>(i)).empty());
}

}  // namespace
}  // namespace trochoid
