#!/usr/bin/env bash
# kill_loop with a terrain of CELLS x CELLS x 2 triangles, saved with its index: kill_loop.sh PROGRAM SERVER CLI CELLS KILLS
set -euo pipefail
program=$1 server=$2 cli=$3 cells=$4 kills=$5
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
awk -v n="$cells" 'BEGIN {
  for (y = 0; y <= n; ++y) for (x = 0; x <= n; ++x) printf "v %.3f %.3f %.3f\n", x / 10, y / 10, sin(x / 9) * cos(y / 7) - 50
  for (y = 0; y < n; ++y) for (x = 0; x < n; ++x) { a = y * (n + 1) + x + 1
    printf "f %d %d %d\nf %d %d %d\n", a, a + 1, a + n + 2, a, a + n + 2, a + n + 1 } }' >"$work/terrain.obj"
"$cli" convert "$work/terrain.obj" "$work/terrain.cscene" >/dev/null
"$program" "$server" "$work/terrain.cscene" "$kills"
