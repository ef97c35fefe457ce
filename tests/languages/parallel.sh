#!/usr/bin/env bash
# Blocks of rays that GNU parallel deals out to three servers are answered like all of them by one.
# usage: parallel.sh COLLIDE DOMAIN
set -euo pipefail
collide=${1:?} domain=${2:?}
command -v parallel >/dev/null || { echo "skipped: GNU parallel is not installed"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
awk 'BEGIN { srand(5); for (i = 0; i < 20000; ++i) {
  printf "%.3f %.3f %.3f ", 18 * rand() - 9, 18 * rand() - 9, 3 * rand() + 0.5
  printf "%.3f %.3f %.3f\n", 2 * rand() - 1, 2 * rand() - 1, 2 * rand() - 1.0005 } }' >"$scratch/rays"
fields=(--plain --fields answer,object,distance,error,triangle)
COLLIDED_DOMAIN=$domain "$collide" ray - "${fields[@]}" <"$scratch/rays" >"$scratch/one"
export collide domain
parallel --will-cite --pipe -N 1700 -k -j 3 \
  "COLLIDED_DOMAIN={= \$_ = $domain + (seq() - 1) % 3 =} $collide ray - ${fields[*]}" <"$scratch/rays" >"$scratch/many"
[[ $(grep -c '^hit' "$scratch/one") -gt 5000 ]] || { echo "hardly a ray hit"; exit 1; }
[[ $(wc -l <"$scratch/many") -eq 20000 ]] || { echo "answers were lost"; exit 1; }
cmp "$scratch/one" "$scratch/many"
