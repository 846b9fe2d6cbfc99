#!/usr/bin/env bash
# Computes the goldens' hash with several compilers, optimisation levels and instruction sets, and fails if two differ.
#
#   tests/determinism/run-architectures.sh [--only LEG]… [--list] [--help]
#
# A leg builds trochoid-goldens (static where the program is emulated) in build/architectures/LEG, and runs
# "trochoid-goldens check" over the sea goldens in tests/golden: exit 0 and a line with the hash, the same in all legs.
# Needs what docker/dependencies.sh --group build,all installs.
# Exit: 0 all agree, 1 a leg failed or differs (it is named), 2 bad options or a tool is missing.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# Another tree than our own can be given, for this script's own test.
cd "${TROCHOID_ROOT:-$here/../..}"

# leg | compiler | options | emulator. s390x is big-endian; native legs also try every fused multiply-add there is.
legs='
gcc-O0           | g++-12                  | -O0               |
gcc-O3           | g++-12                  | -O3               |
gcc-O3-native    | g++-12                  | -O3 -march=native |
clang-O0         | clang++-14              | -O0               |
clang-O3         | clang++-14              | -O3               |
clang-O3-native  | clang++-14              | -O3 -march=native |
aarch64-O2       | aarch64-linux-gnu-g++   | -O2 -static       | qemu-aarch64-static
riscv64-O2       | riscv64-linux-gnu-g++   | -O2 -static       | qemu-riscv64-static
s390x-O2         | s390x-linux-gnu-g++     | -O2 -static       | qemu-s390x-static
'
# Everything below protocol/units and protocol/model, and the checker itself; GoogleTest programs (*_test.cpp) are not part
# of it. Nothing here may need a library that is not header-only: see "headers".
source_patterns=(protocol/units/*.cpp protocol/model/*.cpp tests/golden/*.cpp)
# Folders of /usr/include that hold header-only libraries, the only ones a cross compiler is shown.
headers=(fmt)
flags=(-std=c++20 -ffp-contract=off -I. -DFMT_HEADER_ONLY '-DTROCHOID_VERSION="determinism"')
out=build/architectures

# The wire's golden messages need FlatBuffers: test_codec reads those.
mapfile -t goldens < <(find tests/golden -name '*.txt' ! -name CMakeLists.txt ! -name 'wire_*' | sort)

leg_names() { awk -F'|' 'NF > 1 {gsub(/ /, "", $1); print $1}' <<<"$legs"; }
# The field (2 compiler, 3 options, 4 emulator) of a leg.
leg_field() {
    awk -F'|' -v leg="$1" -v field="$2" \
        '{name = $1; gsub(/ /, "", name)} name == leg {gsub(/^ +| +$/, "", $field); print $field}' <<<"$legs"
}

sources() {
    local file
    for file in "${source_patterns[@]}"; do
        case "$file" in
            *_test.cpp | *'*'*) ;;
            *) echo "$file" ;;
        esac
    done
}

# Builds and runs one leg. Leaves $out/LEG/{log,result}; the result is the checker's line.
work() {
    local leg=$1 dir=$out/$1 cxx emulator file object objects=() options launcher=() status=0
    cxx=$(leg_field "$leg" 2) emulator=$(leg_field "$leg" 4)
    read -ra options <<<"$(leg_field "$leg" 3)"
    command -v ccache >/dev/null && launcher=(ccache)
    mkdir -p "$dir"
    rm -f "$dir/result" "$dir/trochoid-goldens"
    {
        while read -r file; do
            object=$dir/${file//\//_}.o
            "${launcher[@]}" "$cxx" "${flags[@]}" "${options[@]}" -I"$out/include" -c "$file" -o "$object" || return 1
            objects+=("$object")
        done < <(sources)
        "$cxx" "${options[@]}" "${objects[@]}" -pthread -o "$dir/trochoid-goldens" || return 1
        # The emulator, if any, is one word.
        ${emulator:+"$emulator"} "$dir/trochoid-goldens" check "${goldens[@]}" >"$dir/output" || status=$?
        cat "$dir/output"
        [ "$status" -eq 0 ] || {
            echo "trochoid-goldens ended with status $status"
            return 1
        }
    } >"$dir/log" 2>&1 </dev/null
    grep -q . "$dir/output" || {
        echo "trochoid-goldens printed nothing" >>"$dir/log"
        return 1
    }
    paste -sd ';' "$dir/output" >"$dir/result"
}

die() {
    echo "run-architectures: $1" >&2
    exit 2
}

chosen=()
while [ $# -gt 0 ]; do
    case "$1" in
        --work) # one leg, as xargs below calls it
            start=$SECONDS
            if work "$2"; then
                printf '%-16s %4d s  %s\n' "$2" $((SECONDS - start)) "$(cat "$out/$2/result")"
            else
                printf '%-16s %4d s  FAILED (log: %s)\n' "$2" $((SECONDS - start)) "$out/$2/log"
            fi
            exit 0
            ;;
        --only)
            [ -n "$(leg_field "${2:-}" 2)" ] || die "--only wants one of: $(leg_names | xargs)"
            chosen+=("$2")
            shift 2
            ;;
        --list) leg_names && exit 0 ;;
        -h | --help) sed -n '2,/^set -/{/^set -/d;s/^# \{0,1\}//;p}' "$0" && exit 0 ;;
        *) die "unknown option '$1' (see --help)" ;;
    esac
done
if [ ${#chosen[@]} -eq 0 ]; then mapfile -t chosen < <(leg_names); fi

for leg in "${chosen[@]}"; do
    for tool in "$(leg_field "$leg" 2)" "$(leg_field "$leg" 4)"; do
        [ -z "$tool" ] || command -v "$tool" >/dev/null ||
            die "leg $leg needs $tool: run docker/dependencies.sh --group build,all"
    done
done
[ -n "$(sources)" ] || die "no sources match ${source_patterns[*]}"
[ ${#goldens[@]} -gt 0 ] || die "tests/golden has no golden files (*.txt)"
mkdir -p "$out/include"
for library in "${headers[@]}"; do ln -sfn "/usr/include/$library" "$out/include/$library"; done

echo "run-architectures: ${#chosen[@]} legs, $(sources | wc -l) sources, $(nproc) at a time"
printf '%s\n' "${chosen[@]}" | xargs -P "$(nproc)" -I{} bash "$here/run-architectures.sh" --work {}

# Agreement is with what most legs say, so that the odd one is named.
common=$(for leg in "${chosen[@]}"; do cat "$out/$leg/result" 2>/dev/null || true; done |
    sort | uniq -c | sort -rn | sed -n '1s/^ *[0-9]* //p')
bad=()
echo
for leg in "${chosen[@]}"; do
    if [ ! -f "$out/$leg/result" ]; then
        verdict=FAILED
        bad+=("$leg")
    elif [ "$(cat "$out/$leg/result")" != "$common" ]; then
        verdict=DIFFERS
        bad+=("$leg")
    else
        verdict=agrees
    fi
    printf '%-16s %-8s %s\n' "$leg" "$verdict" "$(cat "$out/$leg/result" 2>/dev/null || tail -n 1 "$out/$leg/log")"
done
if [ ${#bad[@]} -gt 0 ]; then
    echo "run-architectures: not one sea: ${bad[*]}"
    for leg in "${bad[@]}"; do
        echo "--- $out/$leg/log"
        tail -n 20 "$out/$leg/log"
    done
    exit 1
fi
echo "run-architectures: ${#chosen[@]} legs agree"
