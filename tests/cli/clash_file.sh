#!/usr/bin/env bash
# `collide clash FILE` looks at a file with a server of its own and leaves nothing behind: clash_file.sh COLLIDE COLLIDED.
set -euo pipefail
collide=$1
export COLLIDED_SERVER=$2 COLLIDED_NAMESPACE=other_$$
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export TMPDIR=$folder XDG_STATE_HOME=$folder/state
fail() { echo "clash of a file: $*" >&2; exit 1; }

cat >"$folder/plant.csv" <<'END'
name,x,y,z,sx,sy,sz
tank,0,0,0,1,1,1
pipe,0.9,0,0,1,0.1,0.1
lamp,0,0,2,1,1,1
far,9,9,9,1,1,1
END
code=0
"$collide" clash "$folder/plant.csv" --csv --fields a,b,answer >"$folder/out" 2>"$folder/err" || code=$?
[[ $code == 0 ]] || fail "ended with $code: $(cat "$folder/err")"
[[ $(tail -n +2 "$folder/out" | sort) == "plant/tank,plant/pipe,touching" || $(tail -n +2 "$folder/out") == "plant/pipe,plant/tank,touching" ]] ||
  fail "told $(cat "$folder/out")"
# In millimetres the lamp is a millimetre from the tank, and some more from the pipe.
"$collide" clash "$folder/plant.csv" --unit mm --nearer 1.1mm --csv --fields a,b,answer -q >"$folder/out" || fail "in millimetres"
[[ $(wc -l <"$folder/out") == 3 ]] || fail "in millimetres it told $(cat "$folder/out")"
# Other tests look at files at the same time, on other domains.
! pgrep -f -- "--domain $COLLIDED_DOMAIN --namespace clash_" >/dev/null || fail "its server outlived it"
[[ -z $(ls "$folder" | grep '^collide-' || true) ]] || fail "it left $(ls "$folder")"
code=0
echo "not a scene" >"$folder/bad.obj.csv"
"$collide" clash "$folder/bad.obj.csv" >"$folder/out" 2>"$folder/err" || code=$?
[[ $code == 5 ]] || fail "a bad file ended with $code: $(cat "$folder/err")"
grep -q 'bad.obj.csv' "$folder/err" || fail "of a bad file it said $(cat "$folder/err")"
