#pragma once
#include <cstdint>
#include <optional>

#include "protocol/units/sea_time.hpp"

namespace trochoid {

/// Which sea time a picture shows: the server's own, one that is held, or one that goes on by a fixed step a picture.
class SeaClockChoice {
public:
    /// `at_s`: held from the start; `step_s` above 0: goes on by so much. A step without a start begins at the sea's own time of begin().
    SeaClockChoice(std::optional<double> at_s, double step_s)
        : step_us_(seconds_to_us(step_s)),
          start_(at_s ? std::optional(SeaTime{seconds_to_us(*at_s)}) : std::nullopt) {}

    /// From here on pictures count; before, a held time stands still.
    void begin(SeaTime now) {
        if (step_us_ > 0 && !start_) start_ = now;
        begun_ = true;
    }
    /// A picture has been drawn.
    void advance() {
        if (begun_ && step_us_ > 0) ++steps_;
    }
    /// The time to show; nothing where it is the sea's own.
    std::optional<SeaTime> time() const {
        if (!start_) return std::nullopt;
        return *start_ + static_cast<int64_t>(steps_) * step_us_;
    }
    /// Whether pictures shall be the same on every run, so that all that a view wants has to be there first.
    bool repeatable() const { return start_.has_value() || step_us_ > 0; }
    bool stepped() const { return step_us_ > 0; }
    double step_s() const { return static_cast<double>(step_us_) * 1e-6; }
    /// Sea time since begin(), for a clock that steps.
    double shown_s() const { return static_cast<double>(steps_) * step_s(); }

private:
    int64_t step_us_;
    std::optional<SeaTime> start_;
    uint64_t steps_ = 0;
    bool begun_ = false;
};

}  // namespace trochoid
