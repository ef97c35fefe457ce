#!/usr/bin/env bash
# A recording of a server's last seconds, read by the reader of the format's authors (@mcap/core from npm, in
# COLLIDED_NODE_DIR or the folder where this runs). Exit status 77 where node or the package is not there.
# usage: foreign_reader.sh COLLIDED COLLIDE
set -euo pipefail
collided=${1:?collided} collide=${2:?collide} here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
command -v node >/dev/null || { echo "skipped: no node"; exit 77; }
cd "${COLLIDED_NODE_DIR:-.}"
scratch=$(mktemp -d)
export COLLIDED_STATE_DIR=$scratch
"$collided" >"$scratch/server.out" 2>&1 &
server=$!
trap 'kill -TERM $server 2>/dev/null; wait $server 2>/dev/null; rm -rf "$scratch"' EXIT
for ((i = 0; i < 400; ++i)); do
  grep -qs '^ready' "$scratch/server.out" && break
  sleep 0.05
done
"$collide" ray 0 0 5  0 0 -1 >/dev/null
"$collide" record "$scratch/last.mcap" --last 30s >/dev/null
node "$here/foreign_reader.mjs" "$scratch/last.mcap" 4
# Channels that are there only when used: described between chunks, some of them in JSON.
"$collide" fence add dock sphere 0 0 5 2 --keep -q >/dev/null
"$collide" record "$scratch/run.mcap" --for 6s -q >/dev/null &
recorder=$!
while kill -0 "$recorder" 2>/dev/null; do
  "$collide" add ball sphere 0.2 --at 0 0 5 -q >/dev/null && "$collide" rm ball -q >/dev/null
done
wait "$recorder"
node "$here/foreign_reader.mjs" "$scratch/run.mcap" 4 | tee "$scratch/read"
grep -q '[ ,]/fences [1-9]' "$scratch/read" && grep -q 'standing_event_v3 [1-9]' "$scratch/read" || { echo "no fences in it"; exit 1; }
