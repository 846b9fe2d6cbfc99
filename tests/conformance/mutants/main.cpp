#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "protocol/units/operator_error.hpp"
#include "tests/conformance/mutants/command.hpp"
#include "tests/conformance/mutants/mutant.hpp"

namespace trochoid::conformance::mutants {
namespace {

constexpr const char* usage =
    "trochoid-mutant: a program that breaks one requirement, made of one that breaks none and a relay before it\n"
    "  trochoid-mutant --list                               names, requirements, sides and what each does\n"
    "  trochoid-mutant NAME --to ADDRESS --port-file F      relays to the server there, at a free port of its own\n"
    "  trochoid-mutant NAME --to ADDRESS --run COMMAND      the same for a client, which COMMAND starts ({here}: our address)\n"
    "ADDRESS: HOST:PORT; behind tls://, ws:// or wss:// {here} is as well, and bytes pass as they are\n";

struct Options {
    std::string name;
    std::optional<Endpoint> to;
    std::string port_file;
    std::string command;
};

Options read(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const auto value = [&]() -> std::string {
            if (i + 1 == argc) throw OperatorError(fmt::format("{} needs a value", word));
            return argv[++i];
        };
        if (word == "--to") {
            options.to = parse_endpoint(value());
        } else if (word == "--port-file") {
            options.port_file = value();
        } else if (word == "--run") {
            options.command = value();
        } else if (options.name.empty() && !word.starts_with("-")) {
            options.name = word;
        } else {
            throw OperatorError(fmt::format("what is {}? See --help", word));
        }
    }
    if (options.name.empty() || !options.to) throw OperatorError("a NAME and --to are needed: see --help");
    return options;
}

std::string with_address(std::string command, uint16_t port, Transport transport) {
    constexpr std::string_view mark = "{here}";
    const std::string here = to_text({"127.0.0.1", port, transport});
    for (size_t at = 0; (at = command.find(mark, at)) != std::string::npos; at += here.size())
        command.replace(at, mark.size(), here);
    return command;
}

void list() {
    for (const Mutant& mutant : all_mutants())
        fmt::print("{}\tR-{}\t{}\t{}\n", mutant.name, mutant.requirement,
                   mutant.side == Side::server ? "server" : "client", mutant.what);
}

int run_program(int argc, char** argv) {
    const std::string_view first = argc > 1 ? argv[1] : "";
    if (first == "--list") return list(), 0;
    if (first == "--help") return fmt::print("{}", usage), 0;
    const Options options = read(argc, argv);
    const std::vector<Mutant> all = all_mutants();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Mutant& m) { return m.name == options.name; });
    if (found == all.end())
        throw OperatorError(fmt::format("there is no mutant {}: see --list", options.name));
    relay(*options.to, found->make, options.port_file, [&](uint16_t port) {
        if (!options.command.empty()) run_beside(with_address(options.command, port, options.to->transport));
    });
}

}  // namespace
}  // namespace trochoid::conformance::mutants

int main(int argc, char** argv) {
    try {
        return trochoid::conformance::mutants::run_program(argc, argv);
    } catch (const trochoid::OperatorError& error) {
        fmt::print(stderr, "trochoid-mutant: {}\n", error.what());
        return 2;
    }
}
