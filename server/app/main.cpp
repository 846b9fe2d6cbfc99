#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "protocol/units/operator_error.hpp"
#include "server/app/server.hpp"
#include "server/app/server_config.hpp"

int main(int argc, char** argv) {
    try {
        if (const auto config = trochoid::parse_command_line(argc, argv)) trochoid::run_server(*config);
        return 0;
    } catch (const trochoid::OperatorError& mistake) {
        fmt::print(stderr, "trochoid-server: {}\n", mistake.what());
        return 2;
    } catch (const std::exception& failure) {
        fmt::print(stderr, "trochoid-server: internal error: {}\n", failure.what());
        return 1;
    }
}
