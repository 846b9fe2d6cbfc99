#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <optional>

#include "client/app/session_sea_source.hpp"
#include "client/app/viewer_loop.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"

namespace {

volatile std::sig_atomic_t interrupted = 0;

void interrupt(int /*signal*/) { interrupted = 1; }

int view(const trochoid::ViewerOptions& options) {
    std::signal(SIGINT, interrupt);
    std::signal(SIGTERM, interrupt);
    trochoid::SessionOptions session;
    session.server = trochoid::parse_endpoint(options.connect);
    session.software = fmt::format("trochoid-viewer {}", trochoid::software_version());
    session.token = options.token;
    session.view = trochoid::view_of(options.camera, glm::dvec3(0));
    session.view.accepted_error_px = trochoid::draw_options_of(options).error_px;
    trochoid::SessionSeaSource source(session);
    const trochoid::ViewerSummary summary =
        trochoid::run_viewer(source, options, [] { return interrupted != 0; });
    fmt::print("trochoid-viewer: {}\n", trochoid::summary_line(summary));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const std::optional<trochoid::ViewerOptions> options = trochoid::parse_viewer_options(argc, argv);
        return options ? view(*options) : 0;
    } catch (const trochoid::OperatorError& error) {
        fmt::print(stderr, "trochoid-viewer: {}\n", error.what());
        return 2;
    }
}
