#!/usr/bin/env bash
# `collide explain ... --recording FILE` says of a recording what the live server said: explain_recording.sh COLLIDE COLLIDED.
set -euo pipefail
collide=$1
export COLLIDED_SERVER=$2 COLLIDED_NAMESPACE=live_$$
folder=$(mktemp -d)
server= pilot=
end() { for process in $pilot $server; do kill "$process" 2>/dev/null || true; done; wait 2>/dev/null || true; rm -rf "$folder"; }
trap end EXIT
export TMPDIR=$folder XDG_STATE_HOME=$folder/state
fail() { echo "explain from a recording: $*" >&2; exit 1; }
run=$folder/run.mcap
# The exit code is a part of the answer.
explain() { code=0; "$collide" explain "$@" --table --color never 2>"$folder/err" || code=$?; echo "exit code $code"; }
same() {  # WHAT, of which "$folder/live" and "$folder/then" hold the answers
  diff "$folder/live" "$folder/then" >"$folder/difference" ||
    fail "$1 differs: $(cat "$folder/difference" "$folder/err")"
}

"$COLLIDED_SERVER" --namespace "$COLLIDED_NAMESPACE" --state-dir "$folder/state" --memory 300s --log error >/dev/null &
server=$!
"$collide" status --wait 60s -q >/dev/null || fail "no server"
"$collide" add tower box 1 1 4 --at 12 1.032 2 -q >/dev/null
"$collide" fence add yard box 11 -1 0 13 1.5 2 --only 'drone*' --keep -q >/dev/null
"$collide" nearest add who 'drone*' tower 50 --keep -q >/dev/null
"$collide" fence add gone sphere 0 0 0 1 --keep -q >/dev/null
"$collide" fence rm gone -q >/dev/null
# A drone on its way into the tower and out again, and then at rest for as long as is asked here.
awk 'BEGIN { print "t,name,x,y,z"; for (i = 0; i <= 9000; ++i) { t = i * 0.04; y = t < 1 ? -2 + 2.4 * t : 0.4 - 2.4 * (t - 1); print t ",drone,12," (y < -2 ? -2 : y) ",1" } }' >"$folder/poses.csv"
"$collide" publish "$folder/poses.csv" --shape sphere:0.5 -q >/dev/null &
pilot=$!
for _ in $(seq 300); do [[ -n $("$collide" ls drone --plain --fields name -q 2>/dev/null) ]] && break; sleep 0.1; done
sleep 4
"$collide" record "$run" --last 20s -q >/dev/null || fail "nothing was recorded"
"$collide" events "$run" --only drone -q --csv --fields what,sequence >"$folder/events" 2>"$folder/err" ||
  fail "no events: $(cat "$folder/err")"
sequence=$(awk -F, '$1 == "began" { print $2 }' "$folder/events" | head -1)
[[ -n $sequence ]] || fail "no contact in $(cat "$folder/events")"
"$collide" explain event "$sequence" --json >"$folder/event.json" || fail "the live server explains no event $sequence"
at=$(grep -o '"high_ns":[0-9]*' "$folder/event.json" | head -1 | cut -d: -f2)
instant=${at:0:10}.${at:10}

explain event "$sequence" >"$folder/live"
explain event "$sequence" --recording "$run" >"$folder/then"
grep -q "event $sequence: began" "$folder/then" || fail "of the event it said $(cat "$folder/then" "$folder/err")"
same "the event"
for question in "ray 12 -3 1 0 1 0 --only drone*" "ray 12 0 6 0 0 -1"; do
  explain $question --as-of "$instant" >"$folder/live"
  explain $question --as-of "$instant" --recording "$run" >"$folder/then"
  # How many nodes are opened depends on the order in which objects came.
  sed -i 's/; [0-9]* nodes\? and/;/' "$folder/live" "$folder/then"
  same "'$question'"
done
# 400 ms before, the two are a metre apart; how near they came is found to a micrometre, and the stretch begins at a pose.
earlier=$((at - 400000000)) earlier=${earlier:0:10}.${earlier:10}
for where in live then; do
  [[ $where == live ]] && from=() || from=(--recording "$run")
  explain pair drone tower --last 500ms --as-of "$earlier" "${from[@]}" | sed -E 's/0\.9(59[0-9]*|60*[0-9]{0,3}) m/0.96 m/g; s/, [^,]* before.*//; s/last [0-9.]* ms/last/' >"$folder/$where"
done
same "the pair"
grep -q '^drone and tower: ' "$folder/then" || fail "of the pair it said $(cat "$folder/then")"
grep -q 'nearest  0.96 m at ' "$folder/then" || fail "of how near the two came it said $(cat "$folder/then")"
# What is asked about the recording's end is asked about its newest state.
explain ray 12 1 6 0 0 -1 --recording "$run" >"$folder/then"
grep -q '^hit  tower' "$folder/then" || fail "at its end it said $(cat "$folder/then" "$folder/err")"
[[ $(explain event 999999 --recording "$run") == "exit code 1" ]] || fail "an event that it lacks: $(cat "$folder/err")"
[[ $(explain ray 0 0 1 1 0 0 --recording "$run" --as-of 5) == "exit code 2" ]] || fail "of 1970: $(cat "$folder/err")"
# A fence and a question for the nearest, of a drone that rests by then; and of when it was in.
for question in "fence yard" "nearest who" "fence yard --why-not tower"; do
  explain $question >"$folder/live"
  explain $question --recording "$run" >"$folder/then"
  same "'$question'"
done
grep -q '^  event .* exit drone  (separated)  seq [0-9]*$' "$folder/live" || fail "the fence reported $(cat "$folder/live")"
explain fence yard --recording "$run" --as-of "$instant" >"$folder/then"
grep -q '^yard: a box, 1 in it' "$folder/then" || fail "of the fence then it said $(cat "$folder/then" "$folder/err")"
grep -q '^  inside   drone  .* deep  since ' "$folder/then" || fail "of what was in it said $(cat "$folder/then")"
grep -q ' enter drone  seq [0-9]*$' "$folder/then" || fail "of what was reported until then it said $(cat "$folder/then")"
! grep -q ' exit ' "$folder/then" || fail "it reports what came later: $(cat "$folder/then")"
[[ $(explain fence gone --recording "$run") == "exit code 5" ]] || fail "a fence that was gone: $(cat "$folder/err")"
grep -q "run.mcap: server refused: no standing question 'gone'" "$folder/err" || fail "of a fence that was gone it said $(cat "$folder/err")"
[[ $(explain fence yard --as-of "$instant") == "exit code 2" ]] || fail "the live fence then: $(cat "$folder/err")"
[[ -z $(ls "$folder" | grep '^collide-' || true) ]] || fail "it left $(ls "$folder")"

kill "$pilot"; wait "$pilot" 2>/dev/null || true
pilot=

# Without a server, and of one that had loaded a file.
kill "$server"; wait "$server" 2>/dev/null || true
printf 'name,x,y,z,sx,sy,sz\ntank,0,0,0,1,1,1\n' >"$folder/plant.csv"
"$COLLIDED_SERVER" --namespace "$COLLIDED_NAMESPACE" --state-dir "$folder/other" --log error "$folder/plant.csv" >/dev/null &
server=$!
"$collide" status --wait 60s -q >/dev/null || fail "no second server"
"$collide" record "$run" --last 5s -q >/dev/null
kill "$server"; wait "$server" 2>/dev/null || true
server=
[[ $(explain ray 0 0 5 0 0 -1 --recording "$run") == "exit code 2" ]] || fail "no scene was asked for"
grep -q "had loaded plant" "$folder/err" || fail "of the scene it said $(cat "$folder/err")"
explain ray 0 0 5 0 0 -1 --recording "$run" --scene "$folder/plant.csv" >"$folder/then"
grep -q '^hit  plant/tank  4.5 m' "$folder/then" || fail "of the scene it said $(cat "$folder/then" "$folder/err")"
