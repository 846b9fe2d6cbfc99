#pragma once
#include <epoxy/gl.h>

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trochoid {

struct ShaderProgramOptions {
    std::vector<std::string> defines;           ///< "NAME VALUE"
    std::vector<const char*> captured_outputs;  ///< for transform feedback, interleaved
};

/// A linked program. Stages follow from the names' endings (.vert, .tesc, .tese, .geom, .frag). Throws GraphicsError with the
/// driver's words where it does not take one.
class ShaderProgram {
public:
    using Options = ShaderProgramOptions;
    explicit ShaderProgram(std::initializer_list<std::string_view> stages)
        : ShaderProgram(stages, Options{}) {}
    ShaderProgram(std::initializer_list<std::string_view> stages, const Options& options)
        : ShaderProgram(std::span(stages.begin(), stages.size()), options) {}
    ShaderProgram(std::span<const std::string_view> stages, const Options& options);
    ShaderProgram(const ShaderProgram&) = delete;
    ShaderProgram& operator=(const ShaderProgram&) = delete;
    ~ShaderProgram() { glDeleteProgram(name_); }

    void use() const { glUseProgram(name_); }
    GLuint name() const { return name_; }
    GLint uniform(const char* name) const { return glGetUniformLocation(name_, name); }

private:
    GLuint name_ = 0;
};

/// Texture units, the same in every program that has the sampler.
enum TextureUnit : GLint {
    records_unit = 0,
    lists_unit,
    slots_unit,
    nodes_unit,
    wakes_unit,
    ripples_unit,
    bed_unit,
    directory_unit,    ///< patch_directory
    sky_unit,          ///< sky_cube
    foam_unit,         ///< foam_map
    fft_unit,          ///< fft_displacement
    fft_slope_unit,    ///< fft_slope
    noise_unit,        ///< noise_lattice
    clear_sky_unit,    ///< clear_sky
    foam_detail_unit,  ///< foam_detail
    first_own_unit     ///< from here on for a pass's own textures
};
/// Binding points of the Frame and OtherSeas blocks.
inline constexpr GLuint frame_binding = 0;
inline constexpr GLuint other_seas_binding = 1;

}  // namespace trochoid
