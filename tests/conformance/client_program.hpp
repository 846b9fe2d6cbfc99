#pragma once
#include <sys/types.h>

#include <string>

#include "tests/conformance/case.hpp"

namespace trochoid::conformance {

/// The client under test as a process of its own: a shell command in a process group of its own. What it writes is kept for reports of
/// failures only.
class ClientProgram {
public:
    /// OperatorError where no shell can be started.
    explicit ClientProgram(const std::string& command);
    ClientProgram(const ClientProgram&) = delete;
    ClientProgram& operator=(const ClientProgram&) = delete;
    /// Ends it if it still runs.
    ~ClientProgram();

    /// Asks it to end (SIGTERM), kills it where it does not within `patience`. Nothing where it ended well; else what went wrong: killed
    /// by a signal that was not ours.
    std::string end(Milliseconds patience);
    /// Whether it has ended by itself within that time.
    bool ended(Milliseconds within);
    /// The last lines it wrote, at most so many bytes.
    std::string last_words(size_t most) const;

private:
    bool reap();

    pid_t pid_ = -1;
    int output_ = -1;  // an unnamed file
    int status_ = 0;
    bool running_ = true;
    bool asked_to_end_ = false;
};

}  // namespace trochoid::conformance
