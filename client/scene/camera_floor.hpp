#pragma once
#include <memory>
#include <vector>

#include "client/scene/camera.hpp"
#include "client/scene/scene_input.hpp"
#include "protocol/model/sea.hpp"

namespace trochoid {

/// Keeps cameras out of the ground and out of the water: from inside there is nothing to see.
class CameraFloor {
public:
    /// Lifts the camera to a metre and a half above the ground and over the crest that passes below it, where it is lower.
    void lift(Camera& camera, const SceneInput& input);

private:
    double ground_m(const SceneInput& input, LatticePoint p) const;
    double water_m(const SceneInput& input, LatticePoint p);

    std::shared_ptr<const InterestState> state_;
    Sea sea_;  // without land fields: near the shore it stands a little too high
};

}  // namespace trochoid
