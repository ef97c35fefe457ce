#!/usr/bin/env bash
# Runs a command while a server of its own serves the built-in warehouse on a DDS domain of its own.
# usage: with_server.sh COLLIDED DOMAIN COMMAND...
set -euo pipefail
collided=${1:?} domain=${2:?}
shift 2
scratch=$(mktemp -d)
server=
# shellcheck disable=SC2317  # trap
leave() {
  [[ -z $server ]] || { kill -TERM "$server" 2>/dev/null; wait "$server" 2>/dev/null; } || true
  rm -rf "$scratch"
}
trap leave EXIT
"$collided" --domain "$domain" --state-dir "$scratch/state" >"$scratch/said" 2>&1 &
server=$!
for _ in $(seq 300); do
  grep -q '^ready:' "$scratch/said" && break
  kill -0 "$server" 2>/dev/null || break
  sleep 0.1
done
grep -q '^ready:' "$scratch/said" || { echo "the server is not ready:"; cat "$scratch/said"; exit 1; }
status=0
"$@" || status=$?
kill -0 "$server" 2>/dev/null || { echo "the server did not live through it:"; tail -5 "$scratch/said"; exit 1; }
exit "$status"
