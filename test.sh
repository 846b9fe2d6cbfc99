#!/usr/bin/env bash
# Builds Trochoid and tests it; closes with the line "N passed, N failed". Installs the Debian packages that are missing.
#
#   ./test.sh              the quick tests, on a Release build
#   ./test.sh --all        all of them, and format, lint, sanitizers and other architectures
#   ./test.sh --leg NAME   only this leg (may be given several times):
#       release        Release build and its quick and end-to-end tests (with --all: every test, the thorough ones too)
#       format         clang-format on every source file
#       architectures  one hash of every scene on compilers, levels and emulated machines (tests/determinism/matrix)
#       lint           clang-tidy on what changed since the main branch, or else in the last commit
#       asan-ubsan     build with address and undefined behaviour sanitizers, quick and end-to-end tests
#       tsan           build with the thread sanitizer, quick and end-to-end tests
#       fuzz           every parser under libFuzzer, 10 s each (tests/fuzz/run)
#   ./test.sh --help
#
# Logs are in build/logs. Exit: 0 all passed, 1 something failed, 2 bad options, 130 interrupted.
# TROCHOID_BASE=COMMIT tells lint what to compare with. TROCHOID_SKIP_DEPENDENCIES=1 installs nothing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

log_dir=$PWD/build/logs
source docker/progress.sh

all_legs=(format release architectures lint asan-ubsan tsan fuzz)
legs=() everything=
while [ $# -gt 0 ]; do
    case "$1" in
        --all) everything=1 && legs=("${all_legs[@]}") && shift ;;
        --leg)
            [[ " ${all_legs[*]} " == *" ${2:-} "* ]] || {
                echo "test.sh: --leg wants one of: ${all_legs[*]}" >&2
                exit 2
            }
            legs+=("$2")
            shift 2
            ;;
        -h | --help)
            sed -n '2,/^set -/{/^set -/d;s/^# \{0,1\}//;p}' "$0"
            exit 0
            ;;
        *)
            echo "test.sh: unknown option '$1' (see ./test.sh --help)" >&2
            exit 2
            ;;
    esac
done
[ ${#legs[@]} -gt 0 ] || legs=(release)

passed=0 failed=0 skipped=0 failures=() test_launcher=()

# Counts one check that is not a ctest test: check NAME STATUS.
count() {
    if [ "$2" -eq 0 ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        failures+=("$1")
    fi
}

interrupted() {
    trap - INT TERM
    echo
    echo "test.sh: interrupted"
    stop_stage
    exit 130
}
trap interrupted INT TERM

# Shows what matters of a log: the lines that name errors, or else its end.
show_failure() {
    local log=$log_dir/$1.log errors
    errors=$(grep -nE '(error|FAILED|Error|fatal|warning:)' "$log" | head -n "${2:-25}" || true)
    if [ -n "$errors" ]; then echo "$errors"; else tail -n "${2:-25}" "$log"; fi
    echo "   (all of it: build/logs/$1.log)"
}

# build PRESET: configures and builds; on failure counts one failed check.
build() {
    stage "$1 configure" cmake --preset "$1" -DTROCHOID_TESTS=ON || {
        tail -n 25 "$log_dir/$1-configure.log"
        count "$1 configure" 1
        return 1
    }
    stage "$1 build" cmake --build "build/$1" --parallel "$(build_jobs)" || {
        show_failure "$1-build"
        count "$1 build" 1
        return 1
    }
}

# run_tests PRESET CTEST_ARGUMENTS…: runs ctest, adds what its report says to the count, shows what failed.
run_tests() {
    local preset=$1 report=$log_dir/$1-tests.xml log=$log_dir/$1-tests.log status=0 numbers here
    shift
    rm -f "$report"
    stage "$preset tests" "${test_launcher[@]}" ctest --test-dir "build/$preset" --output-junit "$report" --output-on-failure \
        --no-tests=error --timeout 300 --parallel "$(nproc)" "$@" || status=$?
    # passed, failed, skipped; the names of the failed ones follow. A test whose program is missing has failed.
    numbers=$(python3 - "$report" <<'PYTHON' || true
import sys, xml.etree.ElementTree as xml
outcome = {"passed": [], "failed": [], "skipped": []}
for case in xml.parse(sys.argv[1]).getroot().iter("testcase"):
    note = case.find("skipped")
    if case.get("status") == "run":
        kind = "passed"
    elif case.get("status") == "disabled" or (note is not None and note.get("message", "").startswith("SKIP_")):
        kind = "skipped"
    else:
        kind = "failed"
    outcome[kind].append(case.get("name"))
print(*(len(names) for names in outcome.values()), *outcome["failed"])
PYTHON
    )
    read -ra here <<<"$numbers"
    if [ ${#here[@]} -lt 3 ]; then
        tail -n 25 "$log"
        count "$preset tests (ctest left no report)" 1
        return
    fi
    passed=$((passed + here[0])) failed=$((failed + here[1])) skipped=$((skipped + here[2]))
    failures+=("${here[@]:3}")
    echo "   ${here[0]} passed, ${here[1]} failed, ${here[2]} skipped under $preset"
    if [ "${here[1]}" -gt 0 ]; then
        grep -vE '^ *[0-9]+/[0-9]+ Test .* Passed|^ *Start ' "$log" | tail -n 150
    elif [ "$status" -ne 0 ] || [ "${here[0]}" -eq 0 ]; then
        tail -n 25 "$log"
        count "$preset tests (ctest ended with $status)" 1
    fi
}

leg_release() {
    build release || return 0
    if [ -n "$everything" ]; then
        run_tests release
    else
        run_tests release -L '^(quick|e2e|conformance)$' -LE '^thorough$'
    fi
}

# Instrumented code under software OpenGL is too slow to say anything: tests labelled gpu stay out.
leg_sanitizer() {
    build "$1" || return 0
    run_tests "$1" -L '^(quick|e2e)$' -LE '^gpu$'
}
leg_asan-ubsan() {
    export ASAN_OPTIONS=detect_stack_use_after_return=1:strict_string_checks=1 UBSAN_OPTIONS=print_stacktrace=1
    leg_sanitizer asan-ubsan
}
leg_tsan() {
    export TSAN_OPTIONS=second_deadlock_stack=1:halt_on_error=1
    # Its shadow memory does not fit every random layout that newer kernels choose.
    if setarch --addr-no-randomize true 2>/dev/null; then test_launcher=(setarch --addr-no-randomize); fi
    leg_sanitizer tsan
    test_launcher=()
}

leg_fuzz() {
    local status=0
    # The fuzzers alone, with what they test.
    stage "fuzz configure" cmake --preset fuzz && stage "fuzz build" cmake --build build/fuzz --target trochoid-fuzzers --parallel "$(build_jobs)" || {
        show_failure fuzz-build
        count "fuzz build" 1
        return 0
    }
    stage "fuzz self-test" tests/fuzz/run --build build/fuzz --self-test || status=$?
    count "fuzz self-test" "$status"
    status=0
    stage fuzz tests/fuzz/run --build build/fuzz --seconds 10 || status=$?
    cat "$log_dir/fuzz.log"
    count fuzz "$status"
}

sources() { find protocol server client tests -name '*.cpp' -o -name '*.hpp' | sort; }

leg_format() {
    local status=0
    sources >"$log_dir/format-files"
    stage format xargs -a "$log_dir/format-files" clang-format-14 --dry-run --Werror --ferror-limit=1 || status=$?
    count format "$status"
    [ "$status" -eq 0 ] || {
        grep -oE '^[^ ]+: error' "$log_dir/format.log" | head -n 25 || true
        echo "   to mend: clang-format-14 -i FILE…"
    }
}

leg_architectures() {
    local status=0
    stage "architectures self-test" tests/determinism/self-test.sh || status=$?
    [ "$status" -eq 0 ] || cat "$log_dir/architectures-self-test.log"
    count "architectures self-test" "$status"
    status=0
    # CI has two minutes; at a desk, and nightly, all of it.
    stage architectures tests/determinism/matrix ${CI:+--quick} || status=$?
    cat "$log_dir/architectures.log"
    count architectures "$status"
}

leg_lint() {
    local status=0
    build release || return 0 # clang-tidy reads the generated headers too
    stage "lint" .ci/lint build/release || status=$?
    count lint "$status"
    if [ "$status" -eq 0 ]; then tail -n 1 "$log_dir/lint.log"; else show_failure lint 40; fi
}

# Clones of one machine share what ccache holds (not at a desk: debuggers want true paths).
if [ -n "${CI:-}" ]; then export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1; fi

groups=build,view,test
[[ " ${legs[*]} " =~ \ (format|architectures|lint|fuzz)\  ]] && groups+=,all
if docker/dependencies.sh --group "$groups"; then
    mkdir -p "$log_dir"
    for leg in "${legs[@]}"; do "leg_$leg"; done
else
    count dependencies 1
fi

for failure in "${failures[@]}"; do echo "failed: $failure"; done
[ "$skipped" -eq 0 ] || echo "skipped: $skipped"
echo "all took $SECONDS s"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
