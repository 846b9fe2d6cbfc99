#pragma once
#include <cmath>
#include <span>

#include "protocol/model/wave_train.hpp"

namespace trochoid {

/// 4 √(Σ A²/2) in metres, for one train too: the one meaning of "significant height" here. As a regular wave one train is 2A
/// high, which is Hs/√2.
inline double significant_height(std::span<const WaveTrain> trains) {
    double sum = 0.0;
    for (const WaveTrain& train : trains) {
        const auto a = static_cast<double>(train.amplitude);
        sum = sum + a * a * 0.5;
    }
    return 4.0 * std::sqrt(sum);
}

}  // namespace trochoid
