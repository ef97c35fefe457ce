#!/usr/bin/env bash
# Runs every line that starts with "$ " in the README's console blocks against a fresh server on the embedded scene, and
# compares what comes out, errors included, with what the README shows.
# usage: check.sh README COLLIDED COLLIDE
set -euo pipefail
readme=${1:?README}
PATH=$(dirname "${2:?collided}"):$(dirname "${3:?collide}"):$PATH
scratch=$(mktemp -d)
export COLLIDED_DOMAIN=$((201 + $$ % 15)) COLLIDED_STATE_DIR=$scratch NO_COLOR=1
collided >"$scratch/server.out" 2>&1 &
server=$!
trap 'kill -TERM $server 2>/dev/null; wait $server 2>/dev/null; rm -rf "$scratch"' EXIT
for ((i = 0; i < 200; ++i)); do
  grep -qs '^ready' "$scratch/server.out" && break
  sleep 0.05
done
grep -q '^ready' "$scratch/server.out" || { cat "$scratch/server.out"; exit 1; }

awk '/^```console/ { inside = 1; next } /^```/ { inside = 0 } inside' "$readme" >"$scratch/shown"
: >"$scratch/seen"
commands=0
while IFS= read -r line; do
  [[ $line == '$ '* ]] || continue
  commands=$((commands + 1))
  printf '%s\n' "$line" >>"$scratch/seen"
  # Errors and data in one stream, as on a terminal; statistics of a batch are not shown off a terminal's width.
  (bash -c "${line:2}" 2>&1 || true) | grep -vE '^ [0-9]+ (rays|spheres|boxes|points) |^     [0-9.]+ (us|ms|s): ' \
    >>"$scratch/seen" || true
done <"$scratch/shown"
if ! diff -u --label README --label "what came out" "$scratch/shown" "$scratch/seen"; then
  echo "the README shows what the programs do not say"
  exit 1
fi
# The drawing that it shows is the one that its command has just made.
cmp "$(dirname "$readme")/deploy/drawing.svg" /tmp/scene.svg
echo "$commands commands of the README give what it shows"
[[ $commands -ge 10 ]]
