#include <fmt/format.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "tests/fuzz/hostile/hostile_vectors.hpp"

// Bar R3: 5,000 hostile vectors that the FlatBuffers verifier accepts, all rejected with the code of the standard.
namespace {

constexpr size_t bar = 5000;

struct Tally {
    size_t rejected = 0;
    size_t all = 0;
};

void write_figures(const std::string& file, size_t rejected, size_t all, bool holds) {
    nlohmann::json figures;
    figures["figure"] =
        fmt::format("hostile vectors: {} of {} rejected with the expected code", rejected, all);
    figures["checks"] = {{{"name", "hostile vectors, all rejected as expected"},
                          {"value", rejected},
                          {"bar", bar},
                          {"holds", holds}}};
    figures["figures"] = {{"hostile_vectors", all}, {"rejected_as_expected", rejected}};
    std::ofstream(file) << figures.dump(2) << "\n";
}

}  // namespace

int main(int argc, char** argv) {
    std::string figures;
    for (int i = 1; i < argc; ++i) {
        const std::string_view option = argv[i];
        if (option == "--figures" && i + 1 < argc) {
            figures = argv[++i];
        } else if (option != "--quick") {
            fmt::print("usage: trochoid-bench-hostile [--quick] [--figures FILE]\n");
            return option == "--help" ? 0 : 2;
        }
    }
    size_t unverified = 0;
    size_t shown = 0;
    std::map<std::string, Tally> table;
    Tally sum;
    for (const trochoid::HostileVector& v : trochoid::hostile_vectors()) {
        // Not what this corpus is about: the verifier finds it.
        if (!verifies(v)) {
            if (++unverified <= 10)
                fmt::print("the verifier refuses: {}: {}\n", name_of(v.direction), v.what);
            continue;
        }
        const trochoid::Error error = refusal(v);
        const bool right = error.code == v.code && !error.message.empty();
        for (Tally* tally : {&table[name_of(v.direction) + ", " + v.kind], &sum})
            tally->all += 1, tally->rejected += right ? 1 : 0;
        if (!right && ++shown <= 40)
            fmt::print("{}: {}: wanted {}, got {} ({})\n", name_of(v.direction), v.what,
                       static_cast<int>(v.code), static_cast<int>(error.code), error.message);
    }
    fmt::print("{:<28} {:>8} {:>8}\n", "", "vectors", "right");
    for (const auto& [kind, tally] : table)
        fmt::print("{:<28} {:>8} {:>8}\n", kind, tally.all, tally.rejected);
    const bool holds = sum.all >= bar && sum.rejected == sum.all && unverified == 0;
    fmt::print("hostile vectors: {} of {} rejected with the expected code (bar {}, all) {}\n", sum.rejected,
               sum.all, bar, holds ? "holds" : "short");
    if (figures.empty()) return holds ? 0 : 1;
    write_figures(figures, sum.rejected, sum.all, holds);
    return 0;  // the verdict is in the file
}
