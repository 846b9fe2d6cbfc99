#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tests/conformance/client_trial.hpp"
#include "tests/conformance/target.hpp"

namespace trochoid::conformance {

struct Options {
    Side side = Side::server;
    Target target;                    ///< server: where it is, tokens and waits
    ClientTarget client;              ///< client: how it is started, and waits
    uint16_t listen = 0;              ///< client, started by hand: where the kit listens
    std::vector<std::string> only;    ///< globs of case ids; empty: all
    std::vector<std::string> except;  ///< globs of case ids left out
    bool print_vectors = false;       ///< print golden vectors, test nothing
    bool questions = false;           ///< … without their answers
    std::vector<std::string> groups;  ///< golden vectors: which; none: all
    std::string answers;              ///< golden vectors: file of a stranger's answers, "-": standard input
    bool list = false;
    bool quiet = false;
    std::string junit;
    std::string json;
    std::string html;
    std::string expected_failures;
    bool forgive_passes = false;
    int jobs = 6;
    int connections = 10;
};

/// Reads the command line; nothing where it only asked for help or the version. OperatorError where it is wrong.
std::optional<Options> read_options(int argc, char** argv);

}  // namespace trochoid::conformance
