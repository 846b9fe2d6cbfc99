#pragma once
#include "client/gpu/gl_health.hpp"

namespace trochoid {

/// An OpenGL 4.1 core context without a window or display server: surfaceless EGL (Mesa), else the first EGL device. Draw
/// into a framebuffer object. Throws OperatorError where no such context can be had.
class OffscreenContext {
public:
    OffscreenContext();
    OffscreenContext(const OffscreenContext&) = delete;
    OffscreenContext& operator=(const OffscreenContext&) = delete;
    ~OffscreenContext();

private:
    void* display_ = nullptr;
    void* context_ = nullptr;
};

}  // namespace trochoid
