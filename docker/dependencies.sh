#!/usr/bin/env bash
# Installs the Debian 12 packages that Trochoid needs and that are missing. The one list of packages: demo.sh, test.sh,
# the image and CI all call this script.
#
#   docker/dependencies.sh [--group NAME[,NAME…]]… [--list | --check]
#
# Groups (default: build)
#   run    libraries that trochoid-server needs to run
#   build  compilers and libraries to build everything
#   view   OpenGL at run time (Mesa's software renderer where there is no graphics card) and GLFW's X libraries
#   test   what the quick tests need
#   all    what ./test.sh --all needs beyond these: clang, formatters, cross compilers, emulators
#
#   --list   print the packages of the groups, one a line, and install nothing
#   --check  print the missing ones, install nothing; exit 1 if there are any
#
# Needs root or sudo only when something is missing. Elsewhere than on Debian: install the equivalents by hand and set
# TROCHOID_SKIP_DEPENDENCIES=1.
set -euo pipefail

# libboost1.81-dev cannot stand beside libgdal-dev (which wants Boost 1.74): nothing here may pull that in.
group_run=(libspdlog1.10 libhwy1 libfmt9 libtiff6 libgeotiff5 libproj25 libpng16-16 libnetcdf19 libssl3 ca-certificates)
group_build=(
    g++ cmake ninja-build ccache pkg-config git ca-certificates
    libboost1.81-dev libflatbuffers-dev flatbuffers-compiler libspdlog-dev libfmt-dev libcli11-dev
    libtomlplusplus-dev nlohmann-json3-dev libtiff-dev libgeotiff-dev libproj-dev libpng-dev libnetcdf-dev
    libglm-dev libglfw3-dev libepoxy-dev libegl-dev libimgui-dev libstb-dev libhwy-dev libfftw3-dev libssl-dev
)
group_view=(
    libgl1 libegl1 libegl-mesa0 libglx-mesa0 libgl1-mesa-dri
    libglfw3 libxcursor1 libxi6 libxinerama1 libxrandr2
)
group_test=(libgtest-dev libgmock-dev xvfb xauth python3 python3-flatbuffers openssl)
# The sanitizer presets build with clang 19, twice as fast there as gcc. The cross compilers bring their C library; qemu runs what they link statically.
group_all=(
    clang-19 libclang-rt-19-dev clang-14 clang-tidy-14 clang-format-14 qemu-user-static
    g++-aarch64-linux-gnu g++-riscv64-linux-gnu g++-s390x-linux-gnu g++-i686-linux-gnu g++-arm-linux-gnueabihf
    g++-powerpc64le-linux-gnu g++-powerpc64-linux-gnu g++-mips-linux-gnu
    python3-matplotlib
)

die() {
    echo "dependencies: $1" >&2
    exit "${2:-1}"
}

usage() { sed -n '2,/^set -/{/^set -/d;s/^# \{0,1\}//;p}' "$0"; }

groups=() action=install
while [ $# -gt 0 ]; do
    case "$1" in
        --group)
            [ $# -gt 1 ] || die "--group needs a name: run, build, view, test or all" 2
            IFS=, read -ra names <<<"$2"
            groups+=("${names[@]}")
            shift 2
            ;;
        --list) action=list && shift ;;
        --check) action=check && shift ;;
        -h | --help) usage && exit 0 ;;
        *) die "unknown option '$1' (see --help)" 2 ;;
    esac
done
[ ${#groups[@]} -gt 0 ] || groups=(build)

packages=()
for group in "${groups[@]}"; do
    case "$group" in
        run) packages+=("${group_run[@]}") ;;
        build) packages+=("${group_build[@]}") ;;
        view) packages+=("${group_view[@]}") ;;
        test) packages+=("${group_test[@]}") ;;
        all) packages+=("${group_all[@]}") ;;
        *) die "unknown group '$group': take run, build, view, test or all" 2 ;;
    esac
done

if [ "$action" = list ]; then
    printf '%s\n' "${packages[@]}" | sort -u
    exit 0
fi
if [ -n "${TROCHOID_SKIP_DEPENDENCIES:-}" ]; then
    echo "dependencies: not looked at (TROCHOID_SKIP_DEPENDENCIES is set)"
    exit 0
fi
for tool in dpkg-query apt-get; do
    command -v "$tool" >/dev/null && continue
    die "no $tool here; Trochoid's packages are Debian 12's. Install the equivalents of the following by hand, then set
TROCHOID_SKIP_DEPENDENCIES=1:
  ${packages[*]}"
done

installed=$(dpkg-query -W -f='${Package} ${db:Status-Status}\n' "${packages[@]}" 2>/dev/null || true)
declare -A present=()
while read -r name status; do
    if [ "$status" = installed ]; then present[$name]=1; fi
done <<<"$installed"
missing=()
for name in "${packages[@]}"; do
    [ -n "${present[$name]:-}" ] || { missing+=("$name") && present[$name]=1; }
done

if [ ${#missing[@]} -eq 0 ]; then
    echo "dependencies: all packages of ${groups[*]} are installed"
    exit 0
fi
if [ "$action" = check ]; then
    printf '%s\n' "${missing[@]}"
    exit 1
fi

elevate=()
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || die "missing packages, and this is neither root nor is there sudo. As root, run:
  apt-get update && apt-get install -y --no-install-recommends ${missing[*]}"
    elevate=(sudo)
fi
elevate+=(env DEBIAN_FRONTEND=noninteractive)
options=(-o Acquire::Retries=3 -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0)

log=$(mktemp "${TMPDIR:-/tmp}/trochoid-dependencies.XXXXXX")
trap 'rm -f "$log"' EXIT

# Runs apt-get with these arguments; on failure shows the end of what it said.
apt() {
    "${elevate[@]}" apt-get "${options[@]}" "$@" >"$log" 2>&1 </dev/null && return
    tail -n 15 "$log" >&2
    return 1
}

echo "dependencies: installing ${#missing[@]} missing packages of ${groups[*]}: ${missing[*]}"
apt -q update || die "apt-get update failed (see above): is the network there, and does /etc/apt name a Debian mirror?"
# --no-remove: an installed libgdal-dev must make this fail, not disappear.
apt -q install -y --no-install-recommends --no-remove "${missing[@]}" ||
    die "apt-get install failed (see above). Trochoid wants Debian 12; libgdal-dev and libboost-dev 1.74 must not be installed
beside libboost1.81-dev. Missing: ${missing[*]}"
echo "dependencies: installed"
