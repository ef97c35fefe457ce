#!/usr/bin/env bash
# `collide demo` and `collide shell` as a newcomer meets them: demo.sh COLLIDE COLLIDED. The server that the demo starts
# answers while it runs and is gone after it; the shell at a terminal takes lines and keeps its history.
set -euo pipefail
collide=$1
export COLLIDED_SERVER=$2 COLLIDED_NAMESPACE=demo_$$
folder=$(mktemp -d)
demo=
end() { [[ -z $demo ]] || kill "$demo" 2>/dev/null || true; rm -rf "$folder"; }
trap end EXIT
fail() { echo "demo: $*" >&2; exit 1; }

"$collide" demo --for 600s >"$folder/out" 2>"$folder/err" &
demo=$!
for _ in $(seq 600); do
  grep -q 'Try in another terminal' "$folder/out" && break
  kill -0 "$demo" 2>/dev/null || fail "ended: $(cat "$folder/err")"
  sleep 0.1
done
grep -q 'a ray straight down meets warehouse/' "$folder/out" || fail "said $(cat "$folder/out")"
[[ $(cat "$folder/out" "$folder/err" | grep -ci 'another terminal') -eq 1 ]] || fail "says twice what to try: $(cat "$folder/err")"
"$collide" ray 0 0 5  0 0 -1 -q >"$folder/ray" || fail "no answer while it runs"
: >"$folder/shell"
# In order, in what the shell has printed so far.
await() { for _ in $(seq 600); do grep -qz -- "$1" "$folder/shell" && return; sleep 0.1; done; }
# Each line is typed at its prompt: what is typed before one is there may be lost, and then script would wait for ever.
HOME=$folder XDG_STATE_HOME='' script -qefc "$collide shell" /dev/null >"$folder/shell" \
  < <(await 'collide>'; echo "ray 0 0 5  0 0 -1"; await 'hit.*warehouse.*collide>'; echo "rya"
    await 'did you mean.*collide>'; echo "exit"; sleep 1)
grep -q 'hit.*warehouse/' "$folder/shell" || fail "the shell printed $(cat "$folder/shell")"
grep -q "did you mean 'ray'" "$folder/shell" || fail "the shell let 'rya' pass: $(cat "$folder/shell")"
grep -q 'ray' "$folder/.local/state/collide/history" || fail "no history"
server=$(pgrep -P "$demo" || true)
[[ -n $server ]] || fail "no server of its own"
kill -INT "$demo"
wait "$demo" || [[ $? == 130 ]] || fail "ended badly after Ctrl-C: $(cat "$folder/err")"
demo=
! kill -0 "$server" 2>/dev/null || fail "its server outlived it"
