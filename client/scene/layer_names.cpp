#include "client/scene/layer_names.hpp"

#include <algorithm>

namespace trochoid {

namespace {

bool signed_word(std::string_view word) { return word.starts_with('-') || word.starts_with('+'); }

bool apply(Layers& layers, std::string_view word) {
    if (word == "all")
        layers = displayed_layers;
    else if (word == "none")
        layers = Layers{};
    else if (word == "authoritative")
        layers = authoritative_layers;
    else {
        const std::string_view name = signed_word(word) ? word.substr(1) : word;
        const auto found = std::find_if(layers_by_importance.begin(), layers_by_importance.end(),
                                        [name](const NamedLayer& l) { return l.name == name; });
        if (found == layers_by_importance.end()) return false;
        layers = word.starts_with('-') ? layers.without(found->layer) : layers.with(found->layer);
    }
    return true;
}

}  // namespace

std::optional<Layers> layers_named(std::string_view text) {
    Layers layers = signed_word(text) ? displayed_layers : Layers{};
    for (;;) {
        const size_t comma = text.find(',');
        if (!apply(layers, text.substr(0, comma))) return std::nullopt;
        if (comma == std::string_view::npos) return layers;
        text.remove_prefix(comma + 1);
    }
}

Layers toggled(Layers layers, Layer layer) {
    return layers.has(layer) ? layers.without(layer) : layers.with(layer);
}

}  // namespace trochoid
