#pragma once
#include <array>
#include <optional>
#include <string_view>

#include "protocol/model/sea.hpp"

namespace trochoid {

/// A layer as people switch it (row A9).
struct NamedLayer {
    Layer layer;
    std::string_view name;   ///< as --layers takes it
    std::string_view about;  ///< a few words
};

/// All layers in order of importance, which is also the order of their keys, 1 to 9.
inline constexpr std::array<NamedLayer, 9> layers_by_importance{{
    {Layer::trains, "trains", "wave trains"},
    {Layer::shelter, "shelter", "shadow and shoaling by land"},
    {Layer::refraction, "refraction", "crests turned by shallow water"},
    {Layer::wakes, "wakes", "ship wakes"},
    {Layer::irregular, "irregular", "irregular heights"},
    {Layer::orbits, "orbits", "flatter orbits in shallow water"},
    {Layer::round, "round", "round waves"},
    {Layer::noise, "noise", "noise that everybody feels"},
    {Layer::displayed_noise, "capillary", "noise that is only shown"},
}};

/// Reads names separated by commas: a plain name adds a layer to none, `-name` and `+name` change the displayed ones; "all",
/// "none" and "authoritative" are sets of their own. Nothing where a word is none of these.
std::optional<Layers> layers_named(std::string_view text);

/// The layer switched on where it was off, and the other way round.
Layers toggled(Layers layers, Layer layer);

}  // namespace trochoid
