# The viewer: its loop as a library, so that tests run it over a fixture, and the program over a session.
if(NOT TROCHOID_VIEWER)
    return()
endif()
find_package(nlohmann_json REQUIRED)
pkg_check_modules(TOMLPLUSPLUS REQUIRED IMPORTED_TARGET tomlplusplus)
trochoid_library(client_viewer
    SOURCES recording.cpp video_pipe.cpp viewer_loop.cpp viewer_options.cpp viewer_presets.cpp viewer_settings.cpp viewer_state.cpp
            viewer_summary.cpp viewer_words.cpp viewing.cpp
    LINKS client_scene client_gpu protocol_units PkgConfig::TOMLPLUSPLUS CLI11::CLI11 spdlog::spdlog nlohmann_json::nlohmann_json)
trochoid_program(trochoid-viewer SOURCES viewer_main.cpp LINKS client_viewer client_session)
