// determinism-trace: what this build computes of scenes, as hashes and, on request, value by value.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "protocol/model/self_check.hpp"
#include "protocol/units/operator_error.hpp"
#include "tests/determinism/fast_path.hpp"
#include "tests/determinism/stages.hpp"

namespace {

using namespace trochoid;

constexpr const char* usage =
    "determinism-trace [--threads N] [--lines FILE] [--coarse-land] SCENE.toml…\n"
    "  Prints \"SCENE STAGE HASH VALUES\" for each scene and stage; exit 1 where two ways of computing differ on this machine.\n"
    "  --threads N   1 to 64 (default 1); never changes a bit\n"
    "  --coarse-land doubles the distance of the land fields' nodes: a quarter of the work, for slow machines\n"
    "  --lines FILE  writes every value too, for first_difference\n";

struct FileClose {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

int run(const std::vector<std::string>& words) {
    uint32_t threads = 1;
    bool coarse_land = false;
    std::unique_ptr<std::FILE, FileClose> lines;
    std::vector<std::string> scenes;
    for (size_t i = 0; i < words.size(); ++i) {
        const bool has_value = i + 1 < words.size();
        if (words[i] == "--threads" && has_value) {
            threads = static_cast<uint32_t>(std::strtoul(words[++i].c_str(), nullptr, 10));
        } else if (words[i] == "--lines" && has_value) {
            lines.reset(std::fopen(words[++i].c_str(), "w"));
            if (!lines) throw OperatorError(fmt::format("cannot write {}: check the path", words[i]));
        } else if (words[i] == "--coarse-land") {
            coarse_land = true;
        } else if (words[i].starts_with("-")) {
            throw OperatorError(fmt::format("unknown option '{}'\n{}", words[i], usage));
        } else {
            scenes.push_back(words[i]);
        }
    }
    if (threads < 1 || threads > 64 || scenes.empty()) throw OperatorError(usage);
    fmt::print("self-check {:016x}\n", reference_hash(1, 4096));
    fmt::print(stderr, "instruction sets of the fast path: {}\n", fast_path_targets());
    uint64_t disagreements = 0;
    for (const std::string& scene : scenes) {
        const std::filesystem::path path(scene);
        Trace trace(path.parent_path().filename().string(), lines.get());
        trace_stages(trace, fold_scene(path, threads, coarse_land), threads);
        disagreements += trace.disagreements();
    }
    return disagreements == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    spdlog::set_level(spdlog::level::off);
    try {
        return run({argv + 1, argv + argc});
    } catch (const OperatorError& error) {
        fmt::print(stderr, "determinism-trace: {}\n", error.what());
    }
    return 2;
}
