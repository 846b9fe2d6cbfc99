# Sourced by demo.sh and test.sh: runs long commands as stages, one line each with its time, and ends them on Ctrl-C.
# The sourcing script may set log_dir (a folder that exists) first.
# shellcheck shell=bash

: "${log_dir:=build/logs}"
stage_pid=

# stage NAME COMMAND…: runs the command in a process group of its own, its output in $log_dir/NAME.log. While it runs, shows
# the last line of the log (on a terminal; else one line every 30 s). Returns the command's status.
stage() {
    local name=$1 log start status=0 shown
    shift
    log=$log_dir/${name// /-}.log
    start=$SECONDS shown=$SECONDS
    [ -t 1 ] || echo "== $name"
    set -m
    "$@" >"$log" 2>&1 </dev/null &
    stage_pid=$!
    set +m
    while kill -0 "$stage_pid" 2>/dev/null; do
        if [ -t 1 ]; then
            printf '\r\033[K== %s (%d s) %.60s' "$name" $((SECONDS - start)) "$(last_line "$log")"
        elif [ $((SECONDS - shown)) -ge 30 ]; then
            shown=$SECONDS
            echo "   … $((SECONDS - start)) s: $(last_line "$log")"
        fi
        sleep 0.2
    done
    wait "$stage_pid" || status=$?
    stage_pid=
    if [ -t 1 ]; then printf '\r\033[K'; fi
    if [ "$status" -eq 0 ]; then
        echo "== $name: done in $((SECONDS - start)) s"
    else
        echo "== $name: FAILED after $((SECONDS - start)) s (log: $log)"
    fi
    return "$status"
}

# The last line of a log that says something, without control characters.
last_line() { tail -n 5 "$1" | tr '\r' '\n' | tr -d '\000-\011\013-\037' | grep . | tail -n 1 || true; }

# Ends the stage that runs, with everything it started.
stop_stage() {
    [ -n "$stage_pid" ] || return 0
    kill -TERM -- "-$stage_pid" 2>/dev/null || true
    local tries
    for tries in {1..50}; do
        kill -0 -- "-$stage_pid" 2>/dev/null || break
        sleep 0.1
    done
    [ "$tries" -lt 50 ] || kill -KILL -- "-$stage_pid" 2>/dev/null || true
    stage_pid=
}

# Compile jobs that fit: one a core, and one for every 2 GiB of free memory.
build_jobs() {
    local cores free
    cores=$(nproc)
    free=$(awk '/^MemAvailable:/ {print int($2 / 2097152)}' /proc/meminfo 2>/dev/null) || free=
    free=${free:-$cores}
    [ "$free" -ge 1 ] || free=1
    echo $((cores < free ? cores : free))
}
