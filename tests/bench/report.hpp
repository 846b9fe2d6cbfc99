#pragma once
#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/units/operator_error.hpp"

namespace trochoid::bench {

/// What a benchmark found, in the form that tests/bench/run reads.
class Report {
public:
    /// Takes --quick and --figures FILE from the command line; anything else is an OperatorError.
    Report(int argc, char** argv) {
        for (int i = 1; i < argc; ++i) {
            const std::string_view option = argv[i];
            if (option == "--quick")
                quick_ = true;
            else if (option == "--figures" && i + 1 < argc)
                file_ = argv[++i];
            else
                throw OperatorError(
                    fmt::format("unknown option '{}': take --quick or --figures FILE", option));
        }
    }
    bool quick() const { return quick_; }

    void at_least(std::string name, double value, double bar, std::string_view unit = "") {
        check(std::move(name), fmt::format("{:.4g}{}", value, unit), fmt::format(">= {:g}{}", bar, unit),
              value >= bar);
    }
    void at_most(std::string name, double value, double bar, std::string_view unit = "") {
        check(std::move(name), fmt::format("{:.4g}{}", value, unit), fmt::format("<= {:g}{}", bar, unit),
              value <= bar);
    }
    void check(std::string name, std::string value, std::string bar, bool holds) {
        json_["checks"].push_back({{"name", std::move(name)},
                                   {"value", std::move(value)},
                                   {"bar", std::move(bar)},
                                   {"holds", holds}});
    }
    /// Words to keep beside the figures, such as the graphics device.
    void text(const std::string& name, const std::string& words) { json_[name] = words; }
    void figure(const std::string& name, double value) { json_["figures"][name] = value; }
    double kept(const std::string& name) const { return json_.at("figures").at(name).get<double>(); }
    void plot(nlohmann::json one) { json_["plots"].push_back(std::move(one)); }

    /// Writes the file, if one was asked for. `words`: the figure of the last line.
    void write(const std::string& words) {
        json_["figure"] = words;
        if (file_.empty()) {
            fmt::print("{}\n", json_.dump(1));
            return;
        }
        std::ofstream out(file_);
        out << json_.dump(1) << '\n';
        if (!out.flush()) throw OperatorError(fmt::format("cannot write {}", file_));
    }

private:
    bool quick_ = false;
    std::string file_;
    nlohmann::json json_ = {{"checks", nlohmann::json::array()}};
};

/// main() of a benchmark: prints the one clear message of an error.
template <class Body>
int run(int argc, char** argv, Body body) {
    try {
        Report report(argc, argv);
        body(report);
        return 0;
    } catch (const std::exception& error) {
        std::cerr << "bench: " << error.what() << '\n';
        return 2;
    }
}

}  // namespace trochoid::bench
