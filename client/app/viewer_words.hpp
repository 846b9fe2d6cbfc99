#pragma once
#include <optional>
#include <string>

#include "client/scene/camera.hpp"
#include "client/scene/draw_options.hpp"

namespace trochoid {

// Words of the viewer's command line as values. Each throws OperatorError that says what there is.

/// "1280x720"
void set_size(const std::string& text, Camera& camera);
/// "X,Y,Z,YAW,PITCH": metres east, up and south, degrees
void set_place(const std::string& text, Camera& camera);
/// "boxes,rays"
void set_debug(const std::string& text, DrawOptions& options);
/// "256x2": cells along a side and their length in metres
void set_grid(const std::string& text, DrawOptions& options);
/// "96x160": rows and quads a row of the projected mesher
void set_projected(const std::string& text, DrawOptions& options);
/// "16.5" or "16:30"
double hour_of(const std::string& text);
Layers layers_of(const std::string& text);
Quality quality_of(const std::string& text);
MesherKind mesher_of(const std::string& text);
Displacement displacement_of(const std::string& text);
/// Nothing for "auto".
std::optional<bool> lean_of(const std::string& text);
FarMethod far_method_of(const std::string& text);
Refinement refinement_of(const std::string& text);

}  // namespace trochoid
