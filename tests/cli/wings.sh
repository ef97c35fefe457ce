#!/usr/bin/env bash
# Verbs in programs of their own show no difference: help, completion, errors, lines. `collide`, the client library and the
# server link none of the wings' libraries.
# usage: wings.sh COLLIDE
set -euo pipefail
collide=${1:?COLLIDE}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() { echo "$*" >&2; exit 1; }
expect() { # EXIT_CODE TEXT COMMAND...
  local code=$1 text=$2 status=0
  shift 2
  "$@" >"$scratch/said" 2>&1 || status=$?
  [[ $status -eq $code ]] || fail "$* ended with $status: $(<"$scratch/said")"
  grep -qF -- "$text" "$scratch/said" || fail "$* said: $(<"$scratch/said")"
}

for verb in draw fleet keys ros view; do
  expect 0 "collide $verb - " "$collide" help $verb
  cp "$scratch/said" "$scratch/help"
  for words in "$verb --help" "--json $verb -h"; do
    # shellcheck disable=SC2086  # words
    "$collide" $words | diff "$scratch/help" - || fail "collide $words prints another help"
  done
  expect 2 "error: $verb: unknown option '--nonsense'" "$collide" $verb --nonsense
done
[[ $("$collide" complete -- view --po) == --port ]] || fail "no completion of view's options"
expect 2 "unknown verb 'veiw'; did you mean 'view'?" "$collide" veiw

# Lines: the options given before them count, a line's own more; what fails has the line's number, and the next one runs.
printf '%s\n' "keys init '$scratch/keys'" 'keys nonsense' "keys check --dir '$scratch/none'" "--plain keys init '$scratch/more' --protection none" \
  >"$scratch/lines"
status=0
"$collide" --json - <"$scratch/lines" >"$scratch/out" 2>"$scratch/err" || status=$?
[[ $status -eq 6 ]] || fail "lines ended with $status: $(<"$scratch/err")"
grep -qF "\"folder\":\"$scratch/keys\"" "$scratch/out" || fail "the first line printed: $(<"$scratch/out")"
grep -qF "error: line 2: keys: 'nonsense' is nothing to do" "$scratch/err" || fail "line 2: $(<"$scratch/err")"
grep -qF "error: line 3: keys: " "$scratch/err" || fail "line 3: $(<"$scratch/err")"
grep -qF "error: line 4: keys: --json, --csv, --plain and --table exclude each other" "$scratch/err" || fail "line 4: $(<"$scratch/err")"

# Without its program a verb says what is missing.
mkdir "$scratch/alone"
cp "$collide" "$scratch/alone/collide"
expect 2 "error: view: the program collide-view was not found" env PATH=/usr/bin:/bin "$scratch/alone/collide" view
grep -qF "unless this build leaves it out" "$scratch/said" || fail "no remedy: $(<"$scratch/said")"

expect 2 "error: watch: --post needs collided-http.so, which is not in " "$scratch/alone/collide" watch --post http://127.0.0.1:1/

build=$(dirname "$collide")/../..
for file in "$collide" "$build/client/libcollided_client.so.2" "$build/server/collided"; do
  [[ -e $file ]] || continue
  needed=$(readelf -d "$file" | grep NEEDED)
  for library in png curl edit crypto; do
    ! grep -q "lib$library" <<<"$needed" || fail "$file itself needs lib$library"
  done
done
