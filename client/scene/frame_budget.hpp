#pragma once
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "client/scene/draw_options.hpp"

namespace trochoid {

/// What a controller may take away, each whole; in the order of `sacrifices_of`, the least visible first.
enum class Sacrifice : uint8_t {
    samples,          ///< one sample a pixel instead of several
    full_detail,      ///< DrawOptions::lean instead
    displayed_noise,  ///< noise that is only shown
    spray,
    foam_history,
    noise,
    round,
    orbits,
    irregular,
    resolution,       ///< 0.7 of width and height is drawn and enlarged
    half_resolution,  ///< half of them
    wakes,
    refraction,
    shelter  ///< waves go through land
};
std::string_view name_of(Sacrifice sacrifice);

/// What of `wanted` there is to take away, in order. `present`: layers that the sea has; others would save nothing.
std::vector<Sacrifice> sacrifices_of(const DrawOptions& wanted, Layers present = displayed_layers);

/// What the controller is doing, for people.
enum class BudgetVerdict : uint8_t {
    measuring,   ///< too little is known since the last change
    holding,     ///< near the target
    coarser,     ///< has just given something up
    finer,       ///< has just taken something back
    all_wanted,  ///< faster than the target with all that is wanted
    exhausted    ///< slower than the target, and nothing is left to give up
};
std::string_view name_of(BudgetVerdict verdict);

/// Where the controller stands.
struct BudgetReport {
    double target_ms = 0;
    double load_ms = 0;       ///< median since the last change, 0 before the first picture
    double error_factor = 1;  ///< the mesh's error over the wanted one, 1 to `coarsest_factor`
    std::vector<Sacrifice> given_up;
    size_t left_to_give = 0;
    BudgetVerdict verdict = BudgetVerdict::measuring;
    uint64_t changes = 0;  ///< decisions so far that changed something
    bool operator==(const BudgetReport&) const = default;
};

/// Holds a target frame time (row A9): makes the mesh coarser and takes layers away when pictures take too long, gives
/// both back when there is time to spare. Values only; what a picture took is told from outside.
///
/// The mesh's error is the fine knob: each step multiplies it by what the last steps have shown to be right (the step grows while it
/// keeps its sign and halves when it turns). Whole layers are the coarse one: the next is given up only where the
/// error has reached the limit of its stage, and comes back only where what it saved when it went fits below the target; one that had
/// to go again at once waits twice as long before it is tried again. A median over the pictures since the last change decides, and a
/// change has to exceed what their own scatter explains, so that a noisy clock moves nothing.
class FrameBudget {
public:
    static constexpr double coarsest_factor = 6.0;

    /// `target_ms` above 0. So many pictures after a change are passed by: the times that come may still be of earlier pictures (a GPU's
    /// timers are read some pictures later), and the first with new options does more.
    explicit FrameBudget(double target_ms, uint32_t passed_by = 5);

    /// What a picture with apply(wanted) took. True where apply() now gives something else.
    bool add(double load_ms, const DrawOptions& wanted, Layers present = displayed_layers);

    /// The wanted options less what has been given up.
    DrawOptions apply(const DrawOptions& wanted) const;

    BudgetReport report() const;
    double target_ms() const { return target_ms_; }

private:
    /// Something given up, and what that was seen to save.
    struct Given {
        Sacrifice what;
        double ratio = 1.0;      // time before over time after
        uint64_t try_after = 0;  // picture number
    };

    void take_over(const DrawOptions& wanted, Layers present);
    void forget_old_loads();
    bool decide();
    bool go_coarser(double deviation);
    bool go_finer(double deviation);
    bool scale_error(double deviation, double lowest, double highest);
    bool give_up_next();
    bool take_back_last();
    bool may_take_back() const;
    bool changed(BudgetVerdict verdict);
    double error_limit() const;

    double target_ms_;
    uint32_t passed_by_;
    DrawOptions wanted_;
    Layers present_ = displayed_layers;
    std::vector<Sacrifice> ladder_;  // what may go, in order
    std::vector<Given> given_;
    double factor_ = 1.0;  // of the error

    std::vector<double> loads_;  // since the last change
    uint32_t to_pass_ = 0;       // pictures
    uint64_t pictures_ = 0;
    double median_ = 0.0;

    double gain_ = 0.5;       // exponent of the fine knob
    int last_direction_ = 0;  // +1 coarser, -1 finer
    double before_ms_ = 0.0;  // where the last change gave a layer up: what pictures took before, else 0
    // The layer that came back last, and when: one that has to go again at once waits longer.
    std::optional<Sacrifice> came_back_;
    uint64_t came_back_at_ = 0;
    uint64_t patience_ = 0;  // pictures
    BudgetVerdict verdict_ = BudgetVerdict::measuring;
    uint64_t changes_ = 0;
};

}  // namespace trochoid
