#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "tests/golden/edge_fields.hpp"
#include "tests/golden/edge_sea.hpp"
#include "tests/golden/golden_file.hpp"

namespace {

int usage(std::FILE* out, int code) {
    fmt::print(
        out,
        "usage: trochoid-goldens check FILE…   compare golden vectors with what this build computes\n"
        "       trochoid-goldens write sea|edges|fields FILE   write them anew (only with a commit that says why)\n");
    return code;
}

int check(int count, char** files) {
    int wrong_files = 0;
    for (int i = 0; i < count; ++i) {
        std::ifstream in(files[i]);
        if (!in) {
            fmt::print(stderr, "trochoid-goldens: cannot read {}: check the path\n", files[i]);
            return 2;
        }
        const trochoid::GoldenReport report = trochoid::check_goldens(in);
        // An empty or foreign file must not pass for want of lines.
        const bool good = report.wrong == 0 && report.checked > 0;
        fmt::print("{:016x} {} of {} lines right\n", report.hash,
                   report.checked - std::min(report.checked, report.wrong), report.checked);
        if (!good) {
            ++wrong_files;
            fmt::print(stderr, "{}: {}\n", files[i],
                       report.checked == 0 ? "holds no golden lines" : report.first_wrong);
        }
    }
    return wrong_files == 0 ? 0 : 1;
}

int write(const std::string& which, const char* file) {
    void (*writer)(std::ostream&) = nullptr;
    if (which == "sea") writer = trochoid::write_goldens;
    if (which == "edges") writer = trochoid::write_edges;
    if (which == "fields") writer = trochoid::write_fields;
    if (writer == nullptr) return usage(stderr, 2);
    std::ofstream out(file);
    writer(out);
    if (!out.flush()) {
        fmt::print(stderr, "trochoid-goldens: cannot write {}: check the folder\n", file);
        return 2;
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    const std::string command = argc > 1 ? argv[1] : "";
    if (command == "--help") return usage(stdout, 0);
    if (command == "check" && argc > 2) return check(argc - 2, argv + 2);
    if (command == "write" && argc == 4) return write(argv[2], argv[3]);
    return usage(stderr, 2);
}
