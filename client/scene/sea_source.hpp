#pragma once
#include "client/scene/scene_input.hpp"
#include "protocol/model/view.hpp"
#include "protocol/units/ids.hpp"

namespace trochoid {

/// Where the viewer gets its sea from: the connection in the shipped program, a fixture in tests. Called from the
/// viewer's thread only; an implementation with a thread of its own locks inside.
class SeaSource {
public:
    SeaSource() = default;
    SeaSource(const SeaSource&) = delete;
    SeaSource& operator=(const SeaSource&) = delete;
    virtual ~SeaSource() = default;

    /// What is known now, with now = sea_time_now(). Cheap enough for every frame: shares what did not change.
    virtual SceneInput snapshot() = 0;
    /// Tells the other end where we look; may be called every frame, the source limits its rate.
    virtual void set_view(const ViewState& view) = 0;
    virtual SeaTime sea_time_now() = 0;
    /// Asks for a box's traced wave rays; they come with a later snapshot.
    virtual void request_rays(BoxId box) = 0;
};

}  // namespace trochoid
