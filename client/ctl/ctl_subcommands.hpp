#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "client/ctl/ctl_options.hpp"
#include "client/ctl/ctl_token_subcommands.hpp"

namespace trochoid {

/// The subcommands of trochoid-ctl: their options with units and ranges, and what was typed as an action. Lives as long as
/// the parser that it adds to.
class CtlSubcommands {
public:
    explicit CtlSubcommands(CLI::App& app);
    CtlSubcommands(const CtlSubcommands&) = delete;
    CtlSubcommands& operator=(const CtlSubcommands&) = delete;

    /// Of the subcommand that was given, once the parser has parsed. OperatorError where none was, where values do not fit
    /// together, and for whatever the standard refuses besides.
    CtlAction action() const;

private:
    /// Options as they are typed; 0 or empty where none were.
    struct Typed {
        double speed = 0.0;
        double towards = 0.0;
        std::vector<double> place;
        double fetch_km = 0.0;
        double width_km = 0.0;
        double life_s = 0.0;
        unsigned trains = 16;
        uint64_t seed = 0;
        std::string spectrum = "automatic";
        std::string spreading = "automatic";
        unsigned directions = 0;
        double reference_depth = 0.0;
        double round = 0.0;
        double irregular = 0.0;
        double noise = 0.0;
        double move_towards = 0.0;
        double move_speed = 0.0;
        double length = 100.0;
        double beam = 0.0;
        std::string name;
        unsigned box = 0;
        std::vector<std::string> points;
        double width = 20.0;
        double crest = 3.0;
        bool dig = false;
        double rate = 1.0;
        double skip_s = 0.0;
        AskedTime when;
    };

    void add_start_wind(CLI::App& app);
    void add_waves(CLI::App& start_wind);
    void add_start_ship(CLI::App& app);
    void add_steer(CLI::App& app);
    void add_stop(CLI::App& app);
    void add_breakwater(CLI::App& app);
    void add_list_and_time(CLI::App& app);
    void add_when(CLI::App& command);
    void add_towards(CLI::App& command, const char* help);
    void add_box(CLI::App& command, const char* help);

    StartWind wind() const;
    StartShip ship() const;
    ChangeLand breakwater() const;

    Typed typed_;
    CLI::App* start_wind_ = nullptr;
    CLI::App* start_ship_ = nullptr;
    CLI::App* steer_ = nullptr;
    CLI::App* stop_ = nullptr;
    CLI::App* breakwater_ = nullptr;
    CLI::App* list_ = nullptr;
    CLI::App* time_ = nullptr;
    std::optional<CtlTokenSubcommands> token_;
};

}  // namespace trochoid
