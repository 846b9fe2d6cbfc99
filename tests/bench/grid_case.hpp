#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <vector>

#include "protocol/model/sea.hpp"
#include "protocol/model/simd/sea_grid.hpp"

namespace trochoid {

/// Open water with `count` trains of 8 to 200 m in one box, fully grown: what a bench sums.
inline Sea open_sea(int count) {
    WaveTrainBox box;
    box.id = {1};
    box.first_train = {1};
    for (int i = 0; i < count; ++i) {
        const double wavelength = 200.0 * std::pow(0.04, static_cast<double>(i) / std::max(1, count - 1));
        const double heading = 0.7 * std::sin(2.4 * i);
        const double turns = 4294967296.0 / (1024.0 * wavelength);
        WaveTrain t;
        t.kx = static_cast<int32_t>(turns * std::cos(heading));
        t.kz = static_cast<int32_t>(turns * std::sin(heading));
        // Deep water: omega^2 = g k, in turns per microsecond.
        const double radians = std::sqrt(9.81 * 6.283185307179586 / wavelength);
        t.omega = static_cast<uint64_t>(radians / 6.283185307179586 * 1e-6 * 18446744073709551616.0);
        t.phase = static_cast<uint32_t>(i) * 2654435769U;
        t.amplitude = static_cast<float>(0.006 * wavelength / std::sqrt(count));
        t.choppiness = 0.7F;
        box.trains.push_back(t);
    }
    return Sea({prepare(std::move(box), {})});
}

/// Displacement and normal of n x n points, a metre apart.
class GridCase {
public:
    GridCase(int trains, int32_t n)
        : sea_(open_sea(trains)), instant_(sea_, {123'456'789}), grid_{{-70'000, 30'000}, 1024, 1024, n, n} {
        constexpr size_t line = 64;
        const size_t room = (grid_.size() * sizeof(float) + line - 1) / line * line + line;
        storage_.resize(std::size(planes_) * room + line);
        void* at = storage_.data();
        size_t left = storage_.size();
        for (float*& plane : planes_) {
            plane = static_cast<float*>(std::align(line, room, at, left));
            at = static_cast<std::byte*>(at) + room;
            left -= room;
        }
    }
    GridCase(const GridCase&) = delete;
    GridCase& operator=(const GridCase&) = delete;
    void evaluate(Workers& workers) {
        evaluate_grid(instant_, grid_,
                      SurfacePlanes{.ax = planes_[0],
                                    .ay = planes_[1],
                                    .az = planes_[2],
                                    .nx = planes_[3],
                                    .ny = planes_[4],
                                    .nz = planes_[5]},
                      workers);
    }
    const SeaInstant& instant() const { return instant_; }
    const LatticeGrid& grid() const { return grid_; }
    const float* plane(size_t i) const { return planes_[i]; }

private:
    Sea sea_;
    SeaInstant instant_;
    LatticeGrid grid_;
    /// Planes begin on lines of the cache, each on another line of its page: vectors are stored whole.
    std::vector<std::byte> storage_;
    float* planes_[6] = {};
};

}  // namespace trochoid
