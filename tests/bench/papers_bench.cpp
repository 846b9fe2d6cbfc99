// P9: all papers' tables in one run.
#include "tests/bench/papers.hpp"

#include "client/gpu/offscreen_context.hpp"

namespace trochoid::bench {
namespace {

void bench(Report& report) {
    const OffscreenContext context;
    const std::string device = describe_gl();
    fmt::print("{}\n", device);
    report.text("device", device);
    paper_a(report);
    paper_b(report);
    paper_c(report);
    paper_d(report);
    report.write(fmt::format("{:.0f}% of 60 trains a vertex on 500^2 (paper B: 50%), {};",
                             report.kept("B: 500^2, 60 trains: share evaluated, %"), device));
}

}  // namespace
}  // namespace trochoid::bench

int main(int argc, char** argv) { return trochoid::bench::run(argc, argv, trochoid::bench::bench); }
