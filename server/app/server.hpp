#pragma once
#include "server/app/server_config.hpp"

namespace trochoid {

/// Runs the server until SIGINT or SIGTERM, then says goodbye to every client. Throws OperatorError at start only.
void run_server(const ServerConfig& config);

}  // namespace trochoid
