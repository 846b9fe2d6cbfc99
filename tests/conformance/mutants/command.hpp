#pragma once
#include <string>

namespace trochoid::conformance::mutants {

/// Starts a shell's command beside this program, in its process group. When the command ends, this program ends in the same way, a
/// moment later: with its status, or by its signal. OperatorError where no shell can be started.
void run_beside(std::string command);

}  // namespace trochoid::conformance::mutants
