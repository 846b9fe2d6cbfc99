#pragma once
#include <CLI/CLI.hpp>
#include <string>

#include "client/net/token_source.hpp"
#include "protocol/units/operator_error.hpp"

namespace trochoid {

/// How a program that only looks logs in: --token-file, or --sign-with and --world.
inline void describe_login(CLI::App& app, TokenWords& words, const std::string& group) {
    const auto refuse_empty = [](const std::string& value) {
        return value.empty() ? "is empty: give a value" : "";
    };
    CLI::Option* key =
        app.add_option("--sign-with", words.key_file, sign_with_help)->check(refuse_empty)->group(group);
    CLI::Option* world =
        app.add_option("--world", words.world, "The world that it is for")->check(refuse_empty)->group(group);
    key->needs(world);
    world->needs(key);
    app.add_option("--token-file", words.token_file, token_file_help)->check(refuse_empty)->group(group);
}

}  // namespace trochoid
