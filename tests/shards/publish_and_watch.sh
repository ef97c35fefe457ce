#!/usr/bin/env bash
# Objects of a file cross the border of two shards, and the same file is published to one server: `collide watch` of the
# shards tells what that of the one server tells. publish_and_watch.sh COLLIDE COLLIDED
set -euo pipefail
collide=$1 collided=$2
folder=$(mktemp -d)
declare -A pids
end() { for process in "${pids[@]}"; do kill "$process" 2>/dev/null || true; done; wait 2>/dev/null || true; rm -rf "$folder"; }
trap end EXIT
fail() { echo "publish and watch: $*" >&2; cat "$folder"/*.err >&2; exit 1; }
space=$$
map=$folder/map.json
cat >"$map" <<'MAP'
{"margin_m": 0.5, "shards": [{"name": "west", "low": [null, null, null], "high": [0, null, null]},
                             {"name": "east", "low": [0, null, null], "high": [null, null, null]}]}
MAP
# A ball goes to and fro past three that stand in a row, of which the middle one is at the border; another one passes it there.
awk 'BEGIN { print "t,name,x,y,z"
  for (i = 0; i <= 300; ++i) {
    x = i <= 150 ? -3 + 0.04 * i : 3 - 0.04 * (i - 150); t = i * 0.01
    print t ",ball," x ",0,20"; print t ",post_west,-1.5,0.15,20"; print t ",post_middle,0.01,0.15,20"
    print t ",post_east,1.5,0.15,20"; print t ",other," (-x) ",-0.15,20" } }' >"$folder/poses.csv"

# Two pairs, one in each shard, that meet again and again: once a watch tells of both, it hears everything.
{ echo t,name,x,y,z
  for i in 0 1 2 3; do for x in -5 5; do echo "0.0${i}5,canary_$x,$x,0.$((i % 2 * 3)),30"; echo "0.0${i}5,wire_$x,$x,0,30"; done; done
} >"$folder/canaries.csv"

serve() { # NAME OPTIONS...
  local name=$1; shift
  "$collided" --state-dir "$folder/$name" --log error "$@" >/dev/null 2>"$folder/$name.err" &
  pids[$name]=$!
}
serve whole --namespace "whole_$space"
for shard in west east; do serve "$shard" --namespace "city_$space" --shard "$map:$shard"; done
for space_of in "whole_$space" "city_$space/shard_west" "city_$space/shard_east"; do
  "$collide" status --namespace "$space_of" --wait 20s -q >/dev/null || fail "no server in $space_of"
done

told_of() { # NAME OPTIONS...: publishes the file and writes what is told of it
  local name=$1; shift
  : >"$folder/$name.csv"
  "$collide" watch "$@" --csv --fields what,a,b,why --for 60s >"$folder/$name.csv" 2>"$folder/$name.watch.err" &
  pids[watch_$name]=$!
  "$collide" publish "$folder/canaries.csv" --loop --shape sphere:0.1 --as canaries -q "$@" >/dev/null 2>"$folder/$name.canaries.err" &
  pids[canaries]=$!
  until grep -q 'began,canary_-5' "$folder/$name.csv" && grep -q 'began,canary_5' "$folder/$name.csv"; do
    kill -0 "${pids[watch_$name]}" 2>/dev/null || fail "$name: nothing is heard"
    sleep 0.1
  done
  kill -INT "${pids[canaries]}"; wait "${pids[canaries]}" || true
  "$collide" publish "$folder/poses.csv" --shape sphere:0.1 --as pilot --json --fields frames,objects,lost "$@" \
    >"$folder/$name.published" 2>"$folder/$name.publish.err" || fail "$name: the file is not published"
  [[ $(cat "$folder/$name.published") == '{"frames":301,"objects":5,"lost":0}' ]] || fail "$(cat "$folder/$name.published")"
  for _ in $(seq 100); do [[ $(grep -v canary "$folder/$name.csv" | grep -c ^ended) -ge 8 ]] && break; sleep 0.1; done
  kill -INT "${pids[watch_$name]}"; wait "${pids[watch_$name]}" || true
  grep -v canary "$folder/$name.csv" >"$folder/$name.events"
}
told_of whole --namespace "whole_$space"
told_of city --namespace "city_$space" --shards "$map"
# Three posts there and back, and the other ball twice.
[[ $(grep -c '^began' "$folder/whole.events") -eq 8 && $(grep -c '^ended.*separated' "$folder/whole.events") -eq 8 ]] ||
  fail "one server told $(cat "$folder/whole.events")"
diff "$folder/whole.events" "$folder/city.events" >"$folder/difference" || fail "the shards told otherwise: $(cat "$folder/difference")"
grep -q ' 0 lost' "$folder/city.watch.err" || fail "the watch lost something"
! grep -q 'a shard was silent' "$folder/city.watch.err" || fail "a shard was silent"
echo "8 contacts across a border, told as by one server"
