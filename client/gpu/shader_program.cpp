#include "client/gpu/shader_program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <sstream>

#include "client/gpu/gl_health.hpp"
#include "client/gpu/graphics_error.hpp"
#include "client/gpu/shader_sources.hpp"
#include "client/scene/sea_table.hpp"
#include "protocol/units/assert.hpp"

namespace trochoid {

namespace {

GLenum stage_of(std::string_view file) {
    if (file.ends_with(".vert")) return GL_VERTEX_SHADER;
    if (file.ends_with(".tesc")) return GL_TESS_CONTROL_SHADER;
    if (file.ends_with(".tese")) return GL_TESS_EVALUATION_SHADER;
    if (file.ends_with(".geom")) return GL_GEOMETRY_SHADER;
    TROCHOID_ASSERT(file.ends_with(".frag"), "no stage for {}", file);
    return GL_FRAGMENT_SHADER;
}

std::string log_of(GLuint object, bool program) {
    std::string log(8192, '\0');
    GLsizei length = 0;
    if (program)
        glGetProgramInfoLog(object, static_cast<GLsizei>(log.size()), &length, log.data());
    else
        glGetShaderInfoLog(object, static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<size_t>(length));
    return log;
}

/// The line that the driver's log names first ("0:123(4)", "0(123)", "ERROR: 0:123:"), of the text after the prelude.
std::string line_named(const std::string& log, const std::string& text) {
    static const std::regex number("0[:(]([0-9]+)");
    std::smatch found;
    if (!std::regex_search(log, found, number)) return {};
    const int wanted = std::stoi(found[1].str().substr(0, 6));
    std::istringstream lines(text.substr(std::min(text.find("#line 1\n"), text.size())));
    std::string line;
    for (int at = 0; at <= wanted; ++at)
        if (!std::getline(lines, line)) return {};
    return fmt::format(" (line {}, includes counted: \"{}\")", wanted, line);
}

[[noreturn]] void refuse_shader(std::string_view file, const std::string& log, const std::string& text) {
    throw GraphicsError(fmt::format(
        "The graphics driver does not take the shader {}{}.\nIt says: {}\nDriver: {}\nUpdate the driver, or draw without "
        "the graphics device (LIBGL_ALWAYS_SOFTWARE=1 takes Mesa's software renderer); if a current driver says this, "
        "report all of it.",
        file, line_named(log, text), log.empty() ? "nothing" : log.substr(0, 2000), describe_gl()));
}

GLuint compile(std::string_view file, const std::string& prelude) {
    const auto source = shader_sources().find(file);
    TROCHOID_ASSERT(source != shader_sources().end(), "no shader {}", file);
    const std::string text = prelude + "#line 1\n" + std::string(source->second);
    const char* begin = text.c_str();
    const GLuint shader = glCreateShader(stage_of(file));
    glShaderSource(shader, 1, &begin, nullptr);
    glCompileShader(shader);
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled != GL_TRUE) refuse_shader(file, log_of(shader, false), text);
    return shader;
}

void set_units(GLuint program) {
    glUseProgram(program);
    const auto set = [program](const char* name, TextureUnit unit) {
        const GLint at = glGetUniformLocation(program, name);
        if (at >= 0) glUniform1i(at, unit);
    };
    set("sea_records", records_unit);
    set("sea_lists", lists_unit);
    set("land_slots", slots_unit);
    set("land_nodes", nodes_unit);
    set("wake_nodes", wakes_unit);
    set("ripple_map", ripples_unit);
    set("bed_map", bed_unit);
    set("patch_directory", directory_unit);
    set("sky_cube", sky_unit);
    set("foam_map", foam_unit);
    set("fft_displacement", fft_unit);
    set("fft_slope", fft_slope_unit);
    set("noise_lattice", noise_unit);
    set("clear_sky", clear_sky_unit);
    set("foam_detail", foam_detail_unit);
    const GLuint block = glGetUniformBlockIndex(program, "Frame");
    if (block != GL_INVALID_INDEX) glUniformBlockBinding(program, block, frame_binding);
    const GLuint others = glGetUniformBlockIndex(program, "OtherSeas");
    if (others != GL_INVALID_INDEX) glUniformBlockBinding(program, others, other_seas_binding);
}

}  // namespace

ShaderProgram::ShaderProgram(std::span<const std::string_view> stages, const Options& options)
    : name_(glCreateProgram()) {
    std::string prelude = "#version 410 core\n";
    prelude += fmt::format("#define TRAIN_ROW {}\n#define OCTAVE_ROW {}\n#define OCTAVE_MEAN_SQUARE {:f}\n",
                           train_row_texels, octave_row_texels, octave_mean_square);
    for (const std::string& define : options.defines) prelude += "#define " + define + "\n";
    for (const std::string_view file : stages) {
        const GLuint shader = compile(file, prelude);
        glAttachShader(name_, shader);
        glDeleteShader(shader);
    }
    if (!options.captured_outputs.empty())
        glTransformFeedbackVaryings(name_, static_cast<GLsizei>(options.captured_outputs.size()),
                                    options.captured_outputs.data(), GL_INTERLEAVED_ATTRIBS);
    glLinkProgram(name_);
    GLint linked = GL_FALSE;
    glGetProgramiv(name_, GL_LINK_STATUS, &linked);
    if (linked != GL_TRUE) refuse_shader(stages.front(), log_of(name_, true), "");
    set_units(name_);
}

}  // namespace trochoid
