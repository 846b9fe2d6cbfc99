#include "server/import/in_child.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <cerrno>
#include <csignal>
#include <cstdio>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

int in_child(const std::filesystem::path& input, const std::function<int()>& work) {
    std::fflush(nullptr);
    // Whoever started us may ignore it, and then a child cannot be waited for.
    std::signal(SIGCHLD, SIG_DFL);
    const pid_t parent = getpid();
    const pid_t child = fork();
    if (child < 0) return work();
    if (child == 0) {
#ifdef __linux__
        prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
        if (getppid() != parent) _exit(2);
        const int code = work();
        std::fflush(nullptr);
        _exit(code);
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            throw OperatorError(
                fmt::format("{}: lost sight of the process that reads it: try again", input.string()));
    if (WIFEXITED(status)) return WEXITSTATUS(status);
    if (WTERMSIG(status) == SIGKILL)
        throw OperatorError(
            fmt::format("{}: the process that read it was killed, perhaps for its memory: give a "
                        "smaller --extent or a coarser --spacing",
                        input.string()));
    const int signal = WTERMSIG(status);
    // What somebody sent, or a closed pipe, says nothing of the file: we end of it too.
    if (signal != SIGSEGV && signal != SIGBUS && signal != SIGFPE && signal != SIGILL && signal != SIGABRT) {
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }
    throw OperatorError(
        fmt::format("{}: the library that reads it died of it (signal {}): the file is damaged: fetch it "
                    "again, or convert it with gdal_translate -of GTiff",
                    input.string(), signal));
}

}  // namespace trochoid
