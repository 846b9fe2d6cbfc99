#!/usr/bin/env bash
# Proves that run-architectures.sh passes a program that computes the same everywhere, and names the leg that differs
# from the rest, ends with an error or does not compile. Builds small programs of its own in a temporary folder.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tree=$(mktemp -d "${TMPDIR:-/tmp}/trochoid-legs.XXXXXX")
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree/protocol/units" "$tree/protocol/model" "$tree/tests/golden"
echo golden >"$tree/tests/golden/one.txt"
echo '# not a golden file' >"$tree/tests/golden/CMakeLists.txt"
echo 'int answer() { return 42; }' >"$tree/protocol/units/answer.cpp"
echo '#error a GoogleTest program is no part of the checker' >"$tree/tests/golden/golden_test.cpp"

# expect STATUS TEXT NAME SOURCE: the verdict on a checker with this main().
expect() {
    local status=0 output
    printf '#include <bit>\n#include <cstdio>\nint answer();\n%s\n' "$4" >"$tree/tests/golden/main.cpp"
    output=$(TROCHOID_ROOT=$tree "$here/run-architectures.sh" --only gcc-O0 --only gcc-O3 --only s390x-O2) || status=$?
    if [ "$status" -ne "$1" ] || ! grep -qF -- "$2" <<<"$output"; then
        echo "self-test: $3: status $status, and not the expected '$2' with $1 in:"
        echo "$output"
        exit 1
    fi
    echo "self-test: $3: ok"
}

expect 0 '3 legs agree' 'the same everywhere' \
    'int main(int argc, char**) { std::printf("%d\n", answer()); return argc == 3 ? 0 : 1; }'
expect 1 'not one sea: s390x-O2' 'byte order shows' \
    'int main() { std::printf("%d\n", answer() + (std::endian::native == std::endian::big)); }'
expect 1 'not one sea: gcc-O3' 'a level fails' '
    #ifdef __OPTIMIZE__
    int main() { std::printf("42\n"); return std::endian::native == std::endian::little; }
    #else
    int main() { std::printf("42\n"); }
    #endif'
expect 1 'not one sea: gcc-O0 gcc-O3 s390x-O2' 'nothing compiles' 'int main() { return missing; }'
expect 1 'not one sea: gcc-O0 gcc-O3 s390x-O2' 'no output' 'int main() { return answer() - 42; }'
