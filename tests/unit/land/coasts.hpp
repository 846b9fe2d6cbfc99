#pragma once
#include <functional>

#include "protocol/model/terrain.hpp"
#include "protocol/model/wave_train_box.hpp"
#include "server/world/traced_land.hpp"

namespace trochoid {

/// A terrain of n x n samples around x = z = 0 whose height in metres at (x, z) in metres the function gives.
TerrainGrid coast(uint32_t samples, uint32_t spacing_log2, int32_t open_depth_m,
                  const std::function<double(double, double)>& height);

/// A train: direction of travel in degrees (0 east, 90 south), wave length and amplitude in metres.
WaveTrain train(double degrees, double wavelength, double amplitude);

/// A box whose u points `degrees` from east towards south, centred on x = z = 0, length x width metres.
WaveTrainBox box(double degrees, double length, double width);

/// An unlimited box.
WaveTrainBox open_box(double degrees);

/// The first field's shift in turns (the whole number of turns included) and gain at a node.
struct NodeValue {
    double shift = 0.0;
    double gain = 1.0;
};
NodeValue node_value(const LandField& field, double x_metres, double z_metres);

}  // namespace trochoid
