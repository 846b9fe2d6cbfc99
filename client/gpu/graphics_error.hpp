#pragma once
#include <stdexcept>

namespace trochoid {

/// The graphics driver let us down: a shader that it does not take, a context that is lost, memory that is used up. The message
/// says what happened and what to do; main prints it and exits 3.
class GraphicsError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace trochoid
