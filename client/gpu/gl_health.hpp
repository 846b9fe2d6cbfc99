#pragma once
#include <cstdint>
#include <string>

namespace trochoid {

/// "OpenGL 4.5 … on llvmpipe …", of the current context.
std::string describe_gl();
/// Whether the processor draws (Mesa's llvmpipe and the like).
bool is_software_gl();

/// Where the processor draws, it begins only when it is told to, and takes the vertices on one core: what has been told so far is drawn
/// on the others meanwhile. On a GPU, which does so anyway, nothing.
void begin_drawing();

/// Looks after the current context, once a frame.
class GlHealth {
public:
    GlHealth();
    /// Throws GraphicsError where the context is lost (the device was reset or taken away, where the driver tells) or its memory is used up.
    /// Gives what else went wrong in words, once for each kind of error; empty usually.
    std::string check();

private:
    bool tells_resets_;
    uint32_t told_ = 0;  // bits: errors that have been told
};

}  // namespace trochoid
