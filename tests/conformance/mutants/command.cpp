#include "tests/conformance/mutants/command.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <system_error>
#include <thread>

#include "protocol/units/operator_error.hpp"

namespace trochoid::conformance::mutants {

void run_beside(std::string command) {
    char shell[] = "/bin/sh";
    char option[] = "-c";
    char* arguments[] = {shell, option, command.data(), nullptr};
    pid_t child = -1;
    const int failed = posix_spawn(&child, shell, nullptr, nullptr, arguments, environ);
    if (failed != 0)
        throw OperatorError(
            fmt::format("cannot start {}: {}: check --run", shell, std::generic_category().message(failed)));
    std::thread([child] {
        int status = 0;
        waitpid(child, &status, 0);
        // Its last bytes are still on their way through us.
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        if (WIFSIGNALED(status)) {
            std::signal(WTERMSIG(status), SIG_DFL);
            std::raise(WTERMSIG(status));
        }
        std::_Exit(WEXITSTATUS(status));
    }).detach();
}

}  // namespace trochoid::conformance::mutants
