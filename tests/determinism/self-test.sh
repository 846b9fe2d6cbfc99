#!/usr/bin/env bash
# Proves that matrix passes programs that compute the same everywhere, and names the leg that differs from the reference, ends with an
# error, depends on its threads or does not compile. Builds small programs of its own in a temporary folder.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tree=$(mktemp -d "${TMPDIR:-/tmp}/trochoid-legs.XXXXXX")
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/{protocol/units,protocol/model,tests/golden,tests/determinism,server/scenes/one}
echo golden >"$tree/tests/golden/one.txt"
echo '# not a golden file' >"$tree/tests/golden/CMakeLists.txt"
echo 'name = "one"' >"$tree/server/scenes/one/scene.toml"
echo 'int answer() { return 42; }' >"$tree/protocol/units/answer.cpp"
# Names that two files hide from each other: in the usual layout they go to two batches, in another they are found out by compiling.
for i in 1 2; do
    printf 'namespace {\nint hidden() { return %s; }\n}  // namespace\nint use_%s() { return hidden(); }\n' $i $i \
        >"$tree/protocol/units/usual_$i.cpp"
    printf 'namespace { int well_hidden() { return %s; } }\nint use_more_%s() { return well_hidden(); }\n' $i $i \
        >"$tree/protocol/model/unusual_$i.cpp"
done
echo '#error a GoogleTest program is no part of the checker' >"$tree/tests/golden/golden_test.cpp"
honest_check='int main(int argc, char**) { std::printf("%d\n", answer()); return argc == 3 ? 0 : 1; }'
honest_trace='int main(int argc, char**) { std::printf("one world %d 1\n", answer()); return argc == 4 || argc == 5 ? 0 : 1; }'

# expect STATUS TEXT NAME CHECKER TRACER: the verdict on programs with these main() functions.
expect() {
    local status=0 output head='#include <bit>\n#include <cstdio>\n#include <cstdlib>\nint answer();\n%s\n'
    # shellcheck disable=SC2059
    printf "$head" "$4" >"$tree/tests/golden/main.cpp"
    # shellcheck disable=SC2059
    printf "$head" "$5" >"$tree/tests/determinism/main.cpp"
    output=$(TROCHOID_ROOT=$tree "$here/matrix" --only gcc-O0 --only s390x-O2) || status=$?
    if [ "$status" -ne "$1" ] || ! grep -qF -- "$2" <<<"$output"; then
        echo "self-test: $3: status $status, and not the expected '$2' with $1 in:"
        echo "$output"
        exit 1
    fi
    echo "self-test: $3: ok"
}

expect 0 '3 legs agree over 1 scenes' 'the same everywhere' "$honest_check" "$honest_trace"
expect 0 'gcc-O0: build/determinism/batches/sea-0.cpp compiles only file by file' 'files that cannot stand together' \
    "$honest_check" "$honest_trace"
expect 1 'not one sea: s390x-O2 x1, s390x-O2 x2, s390x-O2 x7, s390x-O2 x16 (' 'byte order shows in the goldens' \
    'int main() { std::printf("%d\n", answer() + (std::endian::native == std::endian::big)); }' "$honest_trace"
expect 1 "first line that differs: 'one world 43 1' instead of 'one world 42 1'" 'byte order shows in a scene' "$honest_check" \
    'int main() { std::printf("one world %d 1\n", answer() + (std::endian::native == std::endian::big)); }'
expect 1 'not one sea: gcc-O2 x16, s390x-O2 x16 (' 'threads show' "$honest_check" \
    'int main(int, char** words) { std::printf("one world %d 1\n", answer() + (std::atoi(words[2]) == 16)); }'
expect 1 'not one sea: gcc-O0 (' 'a level fails' "$honest_check" '
    #ifdef __OPTIMIZE__
    int main() { std::printf("one world 42 1\n"); }
    #else
    int main() { std::printf("one world 42 1\n"); return 1; }
    #endif'
expect 1 'not one sea: gcc-O0, gcc-O2, s390x-O2 (' 'nothing compiles' 'int main() { return missing; }' "$honest_trace"
expect 1 'the goldens fail' 'no output' 'int main() { return answer() - 42; }' "$honest_trace"
