#!/usr/bin/env bash
# The demo's traffic, recorded once and given again and again, faster than it was: to a primary that is killed again and again
# while a standby is ready, and to a server alone beside it. Both are to tell the same of each pair, in the same order.
# usage: demo_traffic.sh COLLIDED COLLIDE DEPLOY DOMAIN RATE SECONDS SECONDS_BETWEEN_KILLS
set -euo pipefail
collided=$1 collide=$2 deploy=$3 rate=$5 for_s=$6 every_s=$7
export COLLIDED_DOMAIN=$4 COLLIDED_COLOR=never
house=/usr/share/assimp/models/IFC/AC14-FZK-Haus.ifc
walk=/usr/share/assimp/models/BVH/01_01.bvh
for file in "$house" "$walk"; do [[ -r $file ]] || { echo "$file is missing (package assimp-testmodels)"; exit 77; }; done
work=$(mktemp -d)
started=()
finish() {
  for process in "${started[@]}"; do kill "$process" 2>/dev/null || true; done
  wait
  rm -rf "$work"
}
trap finish EXIT
fail() { echo "demo traffic: $*" >&2; tail -n 3 "$work"/*.err >&2; exit 1; }

serve() {  # MEMBER OPTIONS...
  COLLIDED_STATE_DIR=$work/$1 "$collided" "$house" --member "$1" "${@:2}" >"$work/$1.out" 2>"$work/$1.err" &
  server=$!
  started+=("$server")
  for ((i = 0; i < 400; ++i)); do
    ! grep -qs "^ready" "$work/$1.out" || return 0
    sleep 0.05
  done
  fail "'$1' does not start"
}
floor() { "$collide" -q add floor box 40 40 0.2 --at 0 0 -0.1 --static --layers 4 --mask 4 --namespace "$1" >/dev/null; }

# What the demo's four programs publish in 24 s.
serve recorded --namespace recorded
floor recorded
(
  export COLLIDED_NAMESPACE=recorded
  "$collide" record "$work/traffic.mcap" --for 26s >/dev/null 2>"$work/record.err" &
  sleep 1
  "$collide" publish "$walk" --unit 0.056444 --up z --radius 0.12 --name walker --as mocap --layers 4 --mask 4 >/dev/null &
  "$collide" publish --spheres 20 --polygons 256 --size 0.2 --seed 7 --bounce --rate 60 --for 20s --layers 2 --mask 2 \
    --name spheres --as homework >/dev/null &
  "$collide" publish --waypoints '13,2,1.3 10,2,1.3 5,2,1.3 5,5,1.3 9.5,7,1.3 9.5,12,1.3 2,12,1.3 2,7,1.3 2,-2,1.3' \
    --speed 2 --shape sphere:0.15 --name drone --as pilot >/dev/null &
  awk -f "$deploy/carts.awk" >"$work/carts.csv"
  "$collide" publish "$work/carts.csv" --shape sphere:0.5 --layers 8 --mask 8 --as yard >/dev/null &
  wait
) 2>"$work/publish.err"
kill "$server"
wait "$server" || true

serve alone --namespace alone
serve m0 --namespace demo
primary=$server
for namespace in alone demo; do
  floor "$namespace"
  "$collide" watch --json --namespace "$namespace" >"$work/$namespace.json" 2>"$work/watch_$namespace.err" &
  watches+=($!)
  started+=($!)
done
sleep 1
for namespace in alone demo; do
  "$collide" replay "$work/traffic.mcap" --rate "$rate" --loop --namespace "$namespace" >/dev/null 2>"$work/replay_$namespace.err" &
  replays+=($!)
  started+=($!)
done
kills=0
until_s=$((SECONDS + for_s))
while ((SECONDS < until_s)); do
  next_s=$((SECONDS + every_s))
  name=m$((kills + 1))
  serve "$name" --standby-of demo
  for ((i = 0; i < 800; ++i)); do
    ! "$collide" fleet --namespace demo --fields name,role,state 2>/dev/null | grep -qP "^$name\tstandby\tready" || break
    sleep 0.05
  done
  ((i < 800)) || fail "'$name' does not become ready: $("$collide" fleet --namespace demo 2>&1)"
  while ((SECONDS < next_s)); do sleep 0.2; done
  kill -KILL "$primary"
  wait "$primary" 2>/dev/null || true
  primary=$server
  kills=$((kills + 1))
done
sleep 2
kill -INT "${replays[@]}"
wait "${replays[@]}" || true
sleep 1
for namespace in alone demo; do
  "$collide" metrics --namespace "$namespace" | awk -v NAME="$namespace" '/^collided_poses_lost_total/ {print NAME ": " $2 " poses lost"}'
done
kill -INT "${watches[@]}"
wait "${watches[@]}" || true
echo "$kills primaries killed in $for_s s of $rate times the demo's traffic"
python3 "$(dirname "${BASH_SOURCE[0]}")/same_events.py" "$work/alone.json" "$work/demo.json"
