#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <cstdio>
#include <optional>

#include "client/app/session_sea_source.hpp"
#include "client/app/viewer_loop.hpp"
#include "client/gpu/graphics_error.hpp"
#include "protocol/units/operator_error.hpp"
#include "protocol/units/version.hpp"

namespace {

volatile std::sig_atomic_t interrupted = 0;

void interrupt(int /*signal*/) { interrupted = 1; }

int view(const trochoid::ViewerOptions& options, const std::filesystem::path& settings) {
    std::signal(SIGINT, interrupt);
    std::signal(SIGTERM, interrupt);
    trochoid::SessionOptions session;
    session.server = trochoid::endpoint_from_options(options.connect, options.ca_file);
    session.software = fmt::format("trochoid-viewer {}", trochoid::software_version());
    const trochoid::TokenSource login(options.login);
    if (!login.warning().empty()) spdlog::warn("{}", login.warning());
    session.fresh_token = [&login] { return login.token(trochoid::Role::viewer); };
    session.view = trochoid::view_of(options.camera, glm::dvec3(0));
    session.view.accepted_error_px = options.draw.error_px;
    trochoid::SessionSeaSource source(session);
    const trochoid::ViewerSummary summary = trochoid::run_viewer(
        source, options, [] { return interrupted != 0; }, settings);
    fmt::print("trochoid-viewer: {}\n", trochoid::summary_line(summary));
    return 0;
}

int start(int argc, char** argv) {
    std::filesystem::path settings = trochoid::settings_file();
    const trochoid::KeptSettings kept = trochoid::load_settings(settings);
    const std::optional<trochoid::ViewerOptions> options =
        trochoid::parse_viewer_options(argc, argv, kept.values);
    if (!options) return 0;
    if (options->keeps_settings && !kept.complaint.empty()) {
        spdlog::warn("{}", kept.complaint);
        // What the person wrote there is not to be lost.
        settings.clear();
    }
    return view(*options, settings);
}

int complain(const char* what, int status) {
    fmt::print(stderr, "trochoid-viewer: {}\n", what);
    return status;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return start(argc, argv);
    } catch (const trochoid::OperatorError& error) {
        return complain(error.what(), 2);
    } catch (const trochoid::GraphicsError& error) {
        return complain(error.what(), 3);
    } catch (const trochoid::ServerGone& error) {
        return complain(error.what(), 1);
    }
}
