#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "tests/fuzz/fuzz_target.hpp"

// Every seed and every input that once broke something, and mutations of them, without a fuzzer: on any compiler.
namespace {

using trochoid::Bytes;
using trochoid::Dice;
using trochoid::FuzzTarget;

const FuzzTarget* const targets[] = {
    &trochoid::frames_target, &trochoid::client_target,  &trochoid::server_target,  &trochoid::event_target,
    &trochoid::planes_target, &trochoid::session_target, &trochoid::store_target,   &trochoid::terrain_target,
    &trochoid::scene_target,  &trochoid::png_target,     &trochoid::geotiff_target, &trochoid::http_target,
    &trochoid::login_target};

int usage(int code) {
    fmt::print(
        "usage: trochoid-fuzz-replay [--mutations N]   replay corpus and regressions, and N mutations a target (default 2000)\n"
        "       trochoid-fuzz-replay TARGET FILE…      run single inputs, as fuzzers leave them\n"
        "       trochoid-fuzz-replay --list            name the targets\n");
    return code;
}

/// Lines "NAME HEX"; '#' begins a comment.
std::vector<Bytes> inputs_in(const std::filesystem::path& file) {
    std::vector<Bytes> inputs;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream words(line);
        std::string name;
        std::string hex;
        words >> name >> hex;
        Bytes bytes;
        for (size_t i = 0; i + 1 < hex.size(); i += 2)
            bytes.push_back(static_cast<uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
        inputs.push_back(std::move(bytes));
    }
    return inputs;
}

Bytes with_bytes_changed(Bytes input, Dice& dice) {
    for (int64_t changes = dice.between(1, 4); changes > 0 && !input.empty(); --changes) {
        const auto at = dice.between(0, static_cast<int64_t>(input.size()) - 1);
        switch (dice.between(0, 3)) {
            case 0: input[static_cast<size_t>(at)] = dice.any<uint8_t>(); break;
            case 1: input[static_cast<size_t>(at)] ^= static_cast<uint8_t>(1 << dice.between(0, 7)); break;
            case 2: input.insert(input.begin() + at, dice.any<uint8_t>()); break;
            default: input.erase(input.begin() + at);
        }
    }
    return input;
}

void run_mutations(const FuzzTarget& target, const std::vector<Bytes>& inputs, int mutations) {
    Dice dice(77);
    for (int i = 0; i < mutations && !inputs.empty(); ++i) {
        Bytes input = inputs[static_cast<size_t>(dice.between(0, static_cast<int64_t>(inputs.size()) - 1))];
        for (int64_t steps = dice.between(1, 3); steps > 0; --steps) {
            Bytes next = target.mutate != nullptr && dice.coin() ? target.mutate(input, dice, target.longest)
                                                                 : with_bytes_changed(input, dice);
            if (!next.empty() && next.size() <= target.longest) input = std::move(next);
            if (target.repair != nullptr && dice.coin()) target.repair(input);
        }
        target.run(input);
    }
}

int replay(int mutations) {
    const std::filesystem::path home = TROCHOID_SOURCE_DIR "/tests/fuzz";
    int empty = 0;
    for (const FuzzTarget* target : targets) {
        auto inputs = inputs_in(home / "corpus" / fmt::format("{}.txt", target->name));
        if (inputs.empty()) {
            fmt::print(stderr,
                       "tests/fuzz/corpus/{}.txt: missing or empty: make it with tests/fuzz/seeds.py\n",
                       target->name);
            ++empty;
        }
        const auto regressions = inputs_in(home / "regressions" / fmt::format("{}.txt", target->name));
        inputs.insert(inputs.end(), regressions.begin(), regressions.end());
        for (const Bytes& input : inputs) target->run(input);
        run_mutations(*target, inputs, mutations);
        fmt::print("{:<16} {:>5} inputs, {} of them regressions, {} mutations\n", target->name, inputs.size(),
                   regressions.size(), mutations);
    }
    return empty == 0 ? 0 : 1;
}

int run_files(std::string_view name, int count, char** files) {
    const auto* const target = std::find_if(std::begin(targets), std::end(targets),
                                            [&](const FuzzTarget* t) { return t->name == name; });
    if (target == std::end(targets)) return usage(2);
    for (int i = 0; i < count; ++i) {
        std::ifstream in(files[i], std::ios::binary);
        const Bytes input{std::istreambuf_iterator<char>(in), {}};
        (*target)->run(input);
        fmt::print("{}: {} bytes, nothing wrong\n", files[i], input.size());
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    const std::string_view first = argc > 1 ? argv[1] : "";
    if (first == "--help") return usage(0);
    if (first == "--list") {
        for (const FuzzTarget* target : targets) fmt::print("{} {}\n", target->name, target->longest);
        return 0;
    }
    if (first == "--mutations" && argc == 3) return replay(std::stoi(argv[2]));
    if (first.empty()) return replay(2000);
    return first.starts_with("-") || argc < 3 ? usage(2) : run_files(first, argc - 2, argv + 2);
}
