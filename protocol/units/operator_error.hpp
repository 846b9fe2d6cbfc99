#pragma once
#include <stdexcept>

namespace trochoid {

/// The operator's mistake (a file, an option, a port that is taken). The message is one sentence that says what to do;
/// main prints it to standard error and exits 2.
class OperatorError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace trochoid
