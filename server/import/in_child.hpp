#pragma once

#include <filesystem>
#include <functional>

namespace trochoid {

/// Does `work`, which reads `input`, in a child process and returns what it returns (0 to 255): the libraries that read rasters die
/// of some damaged files. Throws OperatorError where the child dies. Not for programs with threads of their own; where no child
/// can be had, the work is done here. The child ends with the program, and without its destructors.
int in_child(const std::filesystem::path& input, const std::function<int()>& work);

}  // namespace trochoid
