#include "client/gpu/gl_health.hpp"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include "client/gpu/graphics_error.hpp"

namespace trochoid {

namespace {

const char* reset_cause(GLenum status) {
    switch (status) {
        case GL_GUILTY_CONTEXT_RESET: return "what this viewer drew made the graphics device hang";
        case GL_INNOCENT_CONTEXT_RESET: return "another program made the graphics device hang";
        default: return "the driver does not know why";
    }
}

const char* text(GLenum name) {
    const auto* bytes = reinterpret_cast<const char*>(glGetString(name));
    return bytes != nullptr ? bytes : "?";
}

}  // namespace

std::string describe_gl() { return fmt::format("OpenGL {} on {}", text(GL_VERSION), text(GL_RENDERER)); }

bool is_software_gl() {
    const std::string renderer = text(GL_RENDERER);
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "SWR", "Software"})
        if (renderer.find(name) != std::string::npos) return true;
    return false;
}

void begin_drawing() {
    // Asked once: a driver with threads of its own would stop for the question.
    static const bool software = is_software_gl();
    if (software) glFlush();
}

GlHealth::GlHealth()
    : tells_resets_(epoxy_gl_version() >= 45 || epoxy_has_gl_extension("GL_KHR_robustness")) {}

std::string GlHealth::check() {
    if (tells_resets_) {
        const GLenum status = glGetGraphicsResetStatus();
        if (status != GL_NO_ERROR)
            throw GraphicsError(fmt::format(
                "The graphics context is lost: {}. Start the viewer again; if that happens often, update the "
                "driver, take --quality low, or draw without the device (LIBGL_ALWAYS_SOFTWARE=1).",
                reset_cause(status)));
    }
    std::string news;
    for (GLenum error = glGetError(); error != GL_NO_ERROR; error = glGetError()) {
        if (error == GL_OUT_OF_MEMORY)
            throw GraphicsError(
                "The graphics memory is used up. Take a smaller --size, --samples 1 or --quality low.");
        if (error == GL_CONTEXT_LOST)
            throw GraphicsError(
                "The graphics context is lost. Start the viewer again; if that happens often, update the driver.");
        // The errors lie side by side from GL_INVALID_ENUM on.
        const uint32_t bit = 1U << ((error - GL_INVALID_ENUM) & 31U);
        if ((told_ & bit) != 0) continue;
        told_ |= bit;
        news += fmt::format("{}OpenGL error 0x{:x}, told once", news.empty() ? "" : "; ", error);
    }
    return news;
}

}  // namespace trochoid
