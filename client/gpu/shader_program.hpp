#pragma once
#include <epoxy/gl.h>

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trochoid {

/// A linked program. Stages follow from the names' endings (.vert, .tesc, .tese, .frag); one that does not compile is
/// our bug and asserts with the driver's words.
class ShaderProgram {
public:
    struct Options {
        std::vector<std::string> defines;           ///< "NAME VALUE"
        std::vector<const char*> captured_outputs;  ///< for transform feedback, interleaved
    };
    explicit ShaderProgram(std::initializer_list<std::string_view> stages)
        : ShaderProgram(stages, Options{}) {}
    ShaderProgram(std::initializer_list<std::string_view> stages, const Options& options);
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
    bed_unit
};
/// Binding point of the Frame block.
inline constexpr GLuint frame_binding = 0;

}  // namespace trochoid
