#include "client/scene/draw_options.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace trochoid {

namespace {

template <class T, size_t N>
using Names = std::array<std::pair<T, std::string_view>, N>;

constexpr Names<MesherKind, 4> meshers{{{MesherKind::patches, "patches"},
                                        {MesherKind::uniform, "uniform"},
                                        {MesherKind::projected, "projected"},
                                        {MesherKind::coherent, "coherent"}}};
constexpr Names<Displacement, 3> displacements{
    {{Displacement::trains, "trains"}, {Displacement::noise, "noise"}, {Displacement::fft, "fft"}}};
constexpr Names<FarMethod, 3> far_methods{
    {{FarMethod::combined, "combined"}, {FarMethod::spectrum, "spectrum"}, {FarMethod::texture, "texture"}}};
constexpr Names<Refinement, 3> refinements{
    {{Refinement::distance, "distance"}, {Refinement::screen, "screen"}, {Refinement::frustum, "frustum"}}};

template <class T, size_t N>
std::optional<T> find(const Names<T, N>& names, std::string_view name) {
    for (const auto& [value, text] : names)
        if (text == name) return value;
    return std::nullopt;
}

template <class T, size_t N>
std::string_view find(const Names<T, N>& names, T value) {
    return names[static_cast<size_t>(value)].second;
}

}  // namespace

std::optional<MesherKind> mesher_named(std::string_view name) { return find(meshers, name); }
std::optional<Displacement> displacement_named(std::string_view name) { return find(displacements, name); }
std::optional<FarMethod> far_method_named(std::string_view name) { return find(far_methods, name); }
std::optional<Refinement> refinement_named(std::string_view name) { return find(refinements, name); }
std::string_view name_of(Quality quality) {
    switch (quality) {
        case Quality::low: return "low";
        case Quality::medium: return "medium";
        case Quality::high: break;
    }
    return "high";
}
std::string_view name_of(MesherKind kind) { return find(meshers, kind); }
std::string_view name_of(Displacement displacement) { return find(displacements, displacement); }
std::string_view name_of(FarMethod method) { return find(far_methods, method); }
std::string_view name_of(Refinement refinement) { return find(refinements, refinement); }

std::optional<Quality> quality_named(std::string_view name) {
    if (name == "low") return Quality::low;
    if (name == "medium") return Quality::medium;
    if (name == "high") return Quality::high;
    return std::nullopt;
}

DrawOptions options_for(Quality quality) {
    DrawOptions options;
    switch (quality) {
        case Quality::low:
            options.error_px = 9.0F;
            options.land_error_px = 8.0F;
            break;
        case Quality::medium: break;
        case Quality::high:
            options.error_px = 2.0F;
            options.land_error_px = 1.0F;
            options.samples = 4;
            options.triangles_per_draw = 20'000;
            break;
    }
    return options;
}

void set_quality(DrawOptions& options, Quality quality) {
    const DrawOptions from = options_for(quality);
    options.error_px = from.error_px;
    options.land_error_px = from.land_error_px;
    options.samples = from.samples;
    options.triangles_per_draw = from.triangles_per_draw;
}

Refinement refinement_in_force(const DrawOptions& options) {
    return options.lean && options.refinement == Refinement::distance ? Refinement::screen
                                                                      : options.refinement;
}

DisplayFilter filter_of(const Camera& camera, const DrawOptions& options, float error_in_force_px) {
    return display_filter(view_of(camera, glm::dvec3(0)), std::max(options.error_px, error_in_force_px));
}

}  // namespace trochoid
