#!/usr/bin/env bash
# Shows a moving sea at a real coast: installs the Debian packages that are missing, builds Trochoid, starts its server
# with the shipped scene, and opens the viewer on it. Without a display it draws offscreen and leaves a picture.
#
#   ./demo.sh [OPTION]… [-- VIEWER_OPTION…]
#
#   --offscreen     no window even if there is a display: write a picture and a summary
#   --seconds N     end after N seconds (1 to 86400; offscreen 10 if not given, a window stays until closed)
#   --picture FILE  where the picture goes (offscreen: trochoid.png if not given)
#   --port N        the server's TCP port on 127.0.0.1 (0 to 65535; 0, the default, takes a free one)
#   --scene FILE    another scene than server/scenes/scilly/scene.toml
#   --preset NAME   calm, breeze, gale, storm or harbour: a scene with its camera and light
#   --build-only    install and build, start nothing
#   --help
#
# Ctrl-C, or closing the window, ends viewer and server. Logs of the build are in build/logs.
# Exit: 0 all ended well, 1 something failed, 2 bad options. TROCHOID_SKIP_DEPENDENCIES=1 installs nothing.
set -euo pipefail
called_from=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")"

die() {
    echo "demo.sh: $1" >&2
    exit "${2:-1}"
}

# whole_number OPTION TEXT LOWEST HIGHEST: prints it, or ends with what is wanted.
whole_number() {
    if [[ $2 =~ ^[0-9]{1,9}$ ]] && ((10#$2 >= $3 && 10#$2 <= $4)); then
        echo "$((10#$2))"
    else
        die "$1 wants a whole number from $3 to $4, not '$2'" 2
    fi
}
from_caller() { case "$1" in /*) echo "$1" ;; *) echo "$called_from/$1" ;; esac }

offscreen='' seconds='' picture='' port=0 scene=$PWD/server/scenes/scilly/scene.toml preset='' build_only='' viewer_options=()
while [ $# -gt 0 ]; do
    case "$1" in
        --seconds | --picture | --port | --scene | --preset)
            [ -n "${2:-}" ] || die "$1 wants a value (see ./demo.sh --help)" 2
            ;;&
        --seconds) seconds=$(whole_number "$1" "$2" 1 86400) || exit 2 ;;&
        --port) port=$(whole_number "$1" "$2" 0 65535) || exit 2 ;;&
        --picture) picture=$(from_caller "$2") ;;&
        --scene) scene=$(from_caller "$2") ;;&
        --preset) preset=$2 ;;&
        --seconds | --picture | --port | --scene | --preset) shift 2 ;;
        --offscreen) offscreen=1 && shift ;;
        --build-only) build_only=1 && shift ;;
        --) shift && viewer_options=("$@") && break ;;
        -h | --help)
            sed -n '2,/^set -/{/^set -/d;s/^# \{0,1\}//;p}' "$0"
            exit 0
            ;;
        *) die "unknown option '$1' (see ./demo.sh --help)" 2 ;;
    esac
done
[ -z "$preset" ] || [ "$scene" = "$PWD/server/scenes/scilly/scene.toml" ] || die "--preset brings its own scene: give it or --scene" 2
# As `trochoid-viewer --list-presets` names them once it is built; a test compares.
presets='calm breeze gale storm harbour'
[ -z "$preset" ] || [[ " $presets " == *" $preset "* ]] || die "--preset $preset: there are ${presets// /, }" 2
[ -f "$scene" ] || die "there is no scene file $scene" 2
if [ -n "$picture" ] && ! [ -w "$(dirname "$picture")" ]; then
    die "cannot write a picture into $(dirname "$picture")" 2
fi

# GLFW is built either for X11 (Debian's default) or for Wayland.
has_display() {
    [ -n "${DISPLAY:-}" ] || { [ -n "${WAYLAND_DISPLAY:-}" ] &&
        dpkg-query -W -f='${db:Status-Status}' libglfw3-wayland 2>/dev/null | grep -qx installed; }
}
if [ -z "$offscreen" ] && ! has_display; then
    echo "demo.sh: no display here, so drawing offscreen"
    offscreen=1
fi

log_dir=$PWD/build/logs
mkdir -p "$log_dir"
source docker/progress.sh

bin=$PWD/build/release/bin
work_dir='' server='' viewer='' server_failed=''

# end PROCESS SECONDS: asks a process group of ours to end, then makes it. Returns the process's status.
end() {
    local tries
    kill -TERM -- "-$1" 2>/dev/null || true
    for ((tries = 0; tries < $2 * 10; tries++)); do
        kill -0 "$1" 2>/dev/null || break
        sleep 0.1
    done
    kill -KILL -- "-$1" 2>/dev/null || true
    wait "$1" 2>/dev/null
}

finish() {
    local status=$? process
    trap - EXIT INT TERM HUP
    stop_stage
    if [ -n "$viewer" ]; then
        process=$viewer viewer=''
        end "$process" 5 || true
    fi
    if [ -n "$server" ]; then
        process=$server server=''
        end "$process" 10 || {
            server_failed="the server ended with status $?"
        }
    fi
    if [ -n "$server_failed" ]; then
        echo "demo.sh: $server_failed; the end of its log:" >&2
        tail -n 20 "$work_dir/server.log" >&2
        status=1
    fi
    [ -z "$work_dir" ] || rm -rf "$work_dir"
    exit "$status"
}
interrupted() {
    echo
    [ -n "$viewer" ] || exit 130
    echo "demo.sh: stopping"
    exit 0
}
trap finish EXIT
trap interrupted INT TERM HUP

docker/dependencies.sh --group build,view || exit 1
# A first build here goes without the tests, whose packages demo.sh does not install; test.sh turns them on.
tests=()
[ -f build/release/CMakeCache.txt ] || tests=(-DTROCHOID_TESTS=OFF)
rm -f "$log_dir/configure.log" "$log_dir/build.log"
{
    stage configure cmake --preset release "${tests[@]}" &&
        stage build cmake --build build/release --target trochoid-demo --parallel "$(build_jobs)"
} || {
    cat "$log_dir/configure.log" "$log_dir/build.log" 2>/dev/null | tail -n 25 >&2
    die "the build failed (see above)"
}
[ -z "$build_only" ] || exit 0

if [ -n "$preset" ]; then
    # The viewer knows their scenes: name, scene and what it shows, parted by tabs.
    preset_scene=$("$bin/trochoid-viewer" --list-presets | awk -F'\t' -v name="$preset" '$1 == name { print $2 }')
    scene=$PWD/$preset_scene
    viewer_options=(--preset "$preset" "${viewer_options[@]}")
fi

work_dir=$(mktemp -d "${TMPDIR:-/tmp}/trochoid-demo.XXXXXX")
key=$work_dir/key
"$bin/trochoid-ctl" token new-key "$key" >/dev/null

# Each in a process group of its own, so that Ctrl-C reaches only this script, which then ends them in order.
set -m
"$bin/trochoid-server" --scene "$scene" --port "$port" --port-file "$work_dir/port" \
    --token-key "$key.pub" >"$work_dir/server.log" 2>&1 </dev/null &
server=$!
set +m

for ((tries = 0; ; tries++)); do
    [ ! -s "$work_dir/port" ] || break
    if ! kill -0 "$server" 2>/dev/null; then
        status=0
        wait "$server" || status=$?
        server='' server_failed="the server did not start (status $status)"
        exit 1
    fi
    [ "$tries" -lt 600 ] || { server_failed="the server opened no port within a minute" && exit 1; }
    sleep 0.1
done
address=127.0.0.1:$(tr -cd '0-9' <"$work_dir/port")

cat <<TEXT
demo.sh: the server runs on $address with $scene
         To change the weather, in another terminal, while this runs:
           ${bin#"$PWD"/}/trochoid-ctl --connect $address --sign-with $key list
           ${bin#"$PWD"/}/trochoid-ctl --help
TEXT

arguments=(--connect "$address")
# Off St Agnes, looking north: swell from the left bends round the island. --camera among VIEWER_OPTIONs wins.
if [ -z "$preset" ] && [ "$scene" = "$PWD/server/scenes/scilly/scene.toml" ] && [[ " ${viewer_options[*]} " != *" --camera"* ]]; then
    arguments+=(--camera -1500,40,3700,10,-8)
fi
if [ -n "$offscreen" ]; then
    arguments+=(--offscreen --seconds "${seconds:-10}" --picture "${picture:=$called_from/trochoid.png}")
else
    [ -z "$seconds" ] || arguments+=(--seconds "$seconds")
    [ -z "$picture" ] || arguments+=(--picture "$picture")
fi
set -m
"$bin/trochoid-viewer" "${arguments[@]}" "${viewer_options[@]}" </dev/null &
viewer=$!
set +m
status=0
wait "$viewer" || status=$?
viewer=''
[ "$status" -eq 0 ] || die "the viewer ended with status $status"
if [ -n "$picture" ]; then
    [ "$picture" -nt "$key" ] || die "the viewer wrote no picture to $picture"
    echo "demo.sh: the picture is $picture"
fi
