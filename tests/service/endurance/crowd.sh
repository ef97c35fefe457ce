#!/usr/bin/env bash
# So many programs that all start at once and each ask so many rays: every one is answered, and answered alike. The processors
# are few, the server's buffer is one: whoever sends more than the server can take has it thrown away and sends it again.
# usage: crowd.sh COLLIDED COLLIDE DOMAIN PROGRAMS RAYS
set -euo pipefail
collided=$1 collide=$2 domain=$3 programs=$4 rays=$5
export COLLIDED_DOMAIN=$domain
work=$(mktemp -d)
server=
finish() {
  [[ -z $server ]] || kill "$server" 2>/dev/null || true
  wait
  rm -rf "$work"
}
trap finish EXIT
COLLIDED_STATE_DIR=$work/state "$collided" >"$work/server.log" 2>&1 &
server=$!
awk -v n="$rays" 'BEGIN {srand(17); for (i = 0; i < n; ++i)
  printf "%.4f %.4f 5 %.4f %.4f -1\n", 12 * rand() - 4, 12 * rand() - 4, rand() - 0.5, rand() - 0.5}' >"$work/rays"
ask() { "$collide" ray - --only 'warehouse/*' --fields answer,object,distance --timeout 120s <"$work/rays"; }
"$collide" --wait 20s status >/dev/null
ask >"$work/alone" || [[ $? -eq 1 ]]
[[ $(wc -l <"$work/alone") -ge $rays ]] || { echo "one program alone: $(wc -l <"$work/alone") lines for $rays rays"; exit 1; }
started=$SECONDS
pids=()
for ((i = 0; i < programs; ++i)); do
  ask >"$work/out.$i" 2>"$work/error.$i" &
  pids+=($!)
done
failed=0 different=0
for ((i = 0; i < programs; ++i)); do
  status=0
  wait "${pids[i]}" || status=$?
  if [[ $status -gt 1 ]]; then
    failed=$((failed + 1))
    head -1 "$work/error.$i"
  elif ! cmp -s "$work/alone" "$work/out.$i"; then
    different=$((different + 1))
  fi
done
echo "programs=$programs rays=$rays failed=$failed different=$different seconds=$((SECONDS - started))"
[[ $failed -eq 0 && $different -eq 0 ]]
