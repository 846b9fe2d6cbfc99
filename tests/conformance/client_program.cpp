#include "tests/conformance/client_program.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <system_error>
#include <thread>

#include "protocol/units/operator_error.hpp"
#include "tests/conformance/framed_stream.hpp"

namespace trochoid::conformance {

namespace {

constexpr Milliseconds nap{5};
constexpr int shell_signal = 128;  // a shell's status for a program that a signal ended: this and the signal

/// The signal that ended it, whether it was the command itself or what a shell ran for it; 0: none.
int signal_of(int status) {
    if (WIFSIGNALED(status)) return WTERMSIG(status);
    if (WIFEXITED(status) && WEXITSTATUS(status) > shell_signal) return WEXITSTATUS(status) - shell_signal;
    return 0;
}

bool is_crash(int signal) {
    return signal == SIGSEGV || signal == SIGABRT || signal == SIGBUS || signal == SIGFPE ||
           signal == SIGILL || signal == SIGTRAP || signal == SIGSYS || signal == SIGPIPE;
}

}  // namespace

ClientProgram::ClientProgram(const std::string& command)
    : output_(memfd_create("client-output", MFD_CLOEXEC)) {
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, output_, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&files, output_, STDERR_FILENO);
    // Connections of cases beside this one would not end while this client holds them too.
    posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    std::string text = command;
    char shell[] = "/bin/sh";
    char option[] = "-c";
    char* arguments[] = {shell, option, text.data(), nullptr};
    const int failed = posix_spawn(&pid_, shell, &files, &attributes, arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    if (failed != 0)
        throw OperatorError(
            fmt::format("cannot start {}: {}: check --run", shell, std::generic_category().message(failed)));
}

ClientProgram::~ClientProgram() {
    constexpr Milliseconds patience{500};
    end(patience);
    if (output_ >= 0) close(output_);
}

bool ClientProgram::reap() {
    if (running_ && waitpid(pid_, &status_, WNOHANG) == pid_) running_ = false;
    return !running_;
}

bool ClientProgram::ended(Milliseconds within) {
    const Deadline deadline(within);
    while (!reap()) {
        if (deadline.passed()) return false;
        std::this_thread::sleep_for(nap);
    }
    return true;
}

std::string ClientProgram::end(Milliseconds patience) {
    if (!reap() && !asked_to_end_) {
        kill(-pid_, SIGTERM);
        asked_to_end_ = true;
    }
    if (!ended(patience)) {
        kill(-pid_, SIGKILL);
        waitpid(pid_, &status_, 0);
        running_ = false;
    }
    const int signal = signal_of(status_);
    return is_crash(signal) ? fmt::format("the client crashed: signal {}", signal) : "";
}

std::string ClientProgram::last_words(size_t most) const {
    const off_t size = lseek(output_, 0, SEEK_END);
    if (size <= 0) return {};
    const size_t count = std::min(most, static_cast<size_t>(size));
    std::string text(count, '\0');
    const ssize_t read = pread(output_, text.data(), count, size - static_cast<off_t>(count));
    text.resize(read > 0 ? static_cast<size_t>(read) : 0);
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

}  // namespace trochoid::conformance
