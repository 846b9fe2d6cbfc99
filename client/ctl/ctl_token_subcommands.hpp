#pragma once
#include <CLI/CLI.hpp>
#include <string>

#include "client/ctl/ctl_token.hpp"

namespace trochoid {

/// `trochoid-ctl token` and what it can do. Lives as long as the parser that it adds to.
class CtlTokenSubcommands {
public:
    explicit CtlTokenSubcommands(CLI::App& app);
    CtlTokenSubcommands(const CtlTokenSubcommands&) = delete;
    CtlTokenSubcommands& operator=(const CtlTokenSubcommands&) = delete;

    bool parsed() const { return token_->parsed(); }
    /// Once the parser has parsed. OperatorError where no subcommand of `token` was given.
    CtlToken action() const;

private:
    void add_make();
    void add_show();

    NewKey new_key_;
    MakeToken make_;
    std::string role_;
    std::string life_ = "60s";
    ShowToken show_;
    CLI::App* token_ = nullptr;
    CLI::App* new_key_command_ = nullptr;
    CLI::App* make_command_ = nullptr;
    CLI::App* show_command_ = nullptr;
};

/// Seconds of "90", "90s", "10m" or "1h". OperatorError for anything else, and beyond 1 s to 1 h.
uint64_t token_life_of(const std::string& text);

}  // namespace trochoid
