#include "client/gpu/offscreen_context.hpp"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <array>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

constexpr const char* advice =
    "Install Mesa's software renderer (Debian: libegl1 libegl-mesa0 libgl1-mesa-dri) or a driver with OpenGL 4.1.";

bool initialised(EGLDisplay display) {
    return display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE;
}

/// NVIDIA's driver has no surfaceless platform but lists devices.
EGLDisplay first_device() {
    const auto devices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    const auto get =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    std::array<EGLDeviceEXT, 16> known{};
    EGLint count = 0;
    if (devices == nullptr || get == nullptr || devices(known.size(), known.data(), &count) != EGL_TRUE)
        return EGL_NO_DISPLAY;
    for (EGLint i = 0; i < count; ++i) {
        EGLDisplay display = get(EGL_PLATFORM_DEVICE_EXT, known[static_cast<size_t>(i)], nullptr);
        if (initialised(display)) return display;
    }
    return EGL_NO_DISPLAY;
}

EGLDisplay open_display() {
    const auto get =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (get != nullptr) {
        EGLDisplay display = get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
        if (initialised(display)) return display;
    }
    return first_device();
}

/// One that tells when the device was reset, where EGL has such; else a plain one.
EGLContext create_context(EGLDisplay display, EGLConfig config) {
    std::array<EGLint, 9> wanted{EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 1,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                 EGL_LOSE_CONTEXT_ON_RESET,
                                 EGL_NONE};
    if (epoxy_egl_version(display) >= 15) {
        EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, wanted.data());
        if (context != EGL_NO_CONTEXT) return context;
    }
    wanted[6] = EGL_NONE;
    return eglCreateContext(display, config, EGL_NO_CONTEXT, wanted.data());
}

}  // namespace

OffscreenContext::OffscreenContext() {
    display_ = open_display();
    if (display_ == EGL_NO_DISPLAY)
        throw OperatorError(fmt::format(
            "No offscreen OpenGL: EGL offers neither a surfaceless display nor a device. {}", advice));
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE)
        throw OperatorError(fmt::format("EGL here has no desktop OpenGL. {}", advice));
    const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    eglChooseConfig(display_, wanted.data(), &config, 1, &count);
    context_ = create_context(display_, count > 0 ? config : nullptr);
    if (context_ == EGL_NO_CONTEXT ||
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE)
        throw OperatorError(
            fmt::format("EGL gives no OpenGL 4.1 core context (error 0x{:x}). {}", eglGetError(), advice));
}

OffscreenContext::~OffscreenContext() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglTerminate(display_);
}

}  // namespace trochoid
