#!/usr/bin/env bash
# Makes shoreline.geojson from the GSHHG shore lines of Debian's packages gmt and gmt-gshhg-full, and scilly.terrain from
# that. Usage: server/scenes/scilly/make.sh [path of trochoid-import]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
import=${1:-$here/../../../build/release/bin/trochoid-import}
if ! command -v gmt >/dev/null || [ ! -e /usr/share/gmt-gshhg/binned_GSHHS_f.nc ]; then
    echo "make.sh: GMT's full-resolution shore lines are missing: apt-get install gmt gmt-gshhg-full" >&2
    exit 2
fi
if [ ! -x "$import" ]; then
    echo "make.sh: $import is missing: build trochoid-import, or give its path" >&2
    exit 2
fi

# A box well beyond the islands, so that no polygon is cut by it. GMT writes its history where it runs.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
(cd "$work" && gmt pscoast -R-6.60/-6.05/49.75/50.03 -Df -M -W >lines.txt)

# One polygon a ring, five decimals (about 1 m), the longest ring first.
awk '
function flush_ring() {
    if (points < 3) { points = 0; return }
    if (key[points] != key[1]) { ++points; key[points] = key[1] }
    text = ""
    for (i = 1; i <= points; ++i) text = text (i > 1 ? "," : "") "[" key[i] "]"
    printf "%06d\t[[%s]]\n", points, text
    points = 0
}
/^[>#]/ { flush_ring(); next }
{
    here = sprintf("%.5f,%.5f", $1, $2)
    if (points == 0 || here != key[points]) { ++points; key[points] = here }
}
END { flush_ring() }' "$work/lines.txt" | LC_ALL=C sort -r >"$work/rings.txt"
{
    printf '{"type":"Feature","properties":{"name":"Isles of Scilly","source":"GSHHG 2.3.7, full resolution",'
    printf '"licence":"LGPL-3.0-or-later"},\n"geometry":{"type":"MultiPolygon","coordinates":[\n'
    cut -f2 "$work/rings.txt" | sed '$!s/$/,/'
    printf ']}}\n'
} >"$here/shoreline.geojson"

# The options stand in one file, which the test that compares the shipped files reads too.
mapfile -t options < <(grep -v '^#' "$here/import.options")
"$import" coast "$here/shoreline.geojson" --out "$here/scilly.terrain" "${options[@]}"
