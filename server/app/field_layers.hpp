#pragma once
#include <cstddef>

#include "server/world/traced_land.hpp"

namespace trochoid {

/// How many blocks the overlays of a box may hold for each that counts, before they are laid down in fields of their own.
struct LayerLimit {
    size_t blocks = 3;
    size_t counting = 1;
};
inline constexpr LayerLimit usual_layers{3, 1};
inline constexpr LayerLimit tight_layers{3, 2};

/// Where the overlays of a land that was traced again (its memory knows them) hide more of each other than the limit allows: the same
/// land in fields of their own, which lie over none and share the blocks. Then nothing keeps what the overlays hid but
/// the predecessors, until they go. Else the land as it is.
TracedLand without_hidden_blocks(TracedLand land, FieldId first_field, LayerLimit limit);

}  // namespace trochoid
