#include "client/ctl/ctl_token_subcommands.hpp"

#include <fmt/format.h>

#include <charconv>
#include <map>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

const std::map<std::string, Role> roles{
    {"viewer", Role::viewer}, {"director", Role::director}, {"admin", Role::admin}};

std::string refuse_empty(const std::string& value) { return value.empty() ? "is empty: give a value" : ""; }

}  // namespace

uint64_t token_life_of(const std::string& text) {
    uint64_t number = 0;
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    const std::string unit(rest, end);
    const uint64_t seconds = unit.empty() || unit == "s" ? 1 : unit == "m" ? 60 : unit == "h" ? 3600 : 0;
    if (error != std::errc() || number < 1 || number > longest_token_life || seconds == 0 ||
        number * seconds > longest_token_life)
        throw OperatorError(fmt::format(
            "--for wants 1 s to 1 h, as in 60s, 10m or 1h, not '{}' (see trochoid-ctl --help)", text));
    return number * seconds;
}

CtlTokenSubcommands::CtlTokenSubcommands(CLI::App& app) {
    token_ = app.add_subcommand("token", "Make keys, and the tokens that let others in; needs no server");
    token_->require_subcommand(0, 1);
    new_key_command_ = token_->add_subcommand(
        "new-key", "Make a key that signs tokens, and the public key that a server checks them with");
    new_key_command_
        ->add_option("KEYFILE", new_key_.file, "New file for the private key; the public one: KEYFILE.pub")
        ->required()
        ->check(refuse_empty);
    new_key_command_->footer(
        "Example:\n  trochoid-ctl token new-key director-key\n  trochoid-server --token-key director-key.pub --scene …");
    add_make();
    add_show();
    token_->footer("Example:\n  trochoid-ctl token new-key director-key");
}

void CtlTokenSubcommands::add_make() {
    make_command_ = token_->add_subcommand("make", "Sign a token: it is good for one connection");
    make_command_->add_option("--key", make_.key_file, "File of the private key")
        ->required()
        ->check(refuse_empty);
    make_command_->add_option("--role", role_, "viewer, director (winds, ships, land) or admin (and time)")
        ->required()
        ->check(CLI::IsMember(roles).description(""));
    make_command_
        ->add_option("--world", make_.world, "Name of the world that it is for, as the scene file has it")
        ->required()
        ->check(refuse_empty);
    make_command_->add_option("--for", life_, "How long it is good, 1 s to 1 h")->capture_default_str();
    make_command_->add_option("--out", make_.out, "Write it to this file instead of standard output")
        ->check(refuse_empty);
    make_command_->footer(
        "Example:\n  trochoid-ctl token make --key director-key --role director --world scilly --for 5m --out token\n"
        "  trochoid-ctl --token-file token stop-wind 3");
}

void CtlTokenSubcommands::add_show() {
    show_command_ = token_->add_subcommand("show", "Show what a token says, and check who signed it");
    show_command_->add_option("TOKEN", show_.token, "The token, or a file that holds it")
        ->required()
        ->check(refuse_empty);
    show_command_
        ->add_option("--pub", show_.key_file, "Public key that it should be signed with; exit 1 if it is not")
        ->check(refuse_empty);
    show_command_->footer("Example:\n  trochoid-ctl token show token --pub director-key.pub");
}

CtlToken CtlTokenSubcommands::action() const {
    if (new_key_command_->parsed()) return new_key_;
    if (show_command_->parsed()) return show_;
    if (make_command_->parsed()) {
        MakeToken make = make_;
        make.role = roles.at(role_);
        make.life_s = token_life_of(life_);
        return make;
    }
    throw OperatorError(
        "say what to do: token new-key, token make or token show (see trochoid-ctl token --help)");
}

}  // namespace trochoid
