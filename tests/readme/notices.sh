#!/usr/bin/env bash
# The check of documents notices what it is there for: output that is not what the document shows, and commands that are gone.
# usage: notices.sh COLLIDED COLLIDE DOMAIN
set -euo pipefail
check=$(dirname "${BASH_SOURCE[0]}")/console_blocks.py
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
run() { "$check" "$scratch/doc.md" "$collided" "$collide" --domain "$domain" "$@" >"$scratch/said" 2>&1; }
collided=${1:?} collide=${2:?} domain=${3:?}
fail() { echo "$1"; cat "$scratch/said"; exit 1; }

printf '%s\n' 'Text.' '```console' '$ collide ray 0 0 5  0 0 1; echo "exit code $?"' 'hit  something else' '```' 'More.' >"$scratch/doc.md"
! run || fail "a wrong output is not noticed"
grep -q '^-hit  something else' "$scratch/said" || fail "the difference is not shown"
run --write || fail "it writes no outputs"
printf '%s\n' 'Text.' '```console' '$ collide ray 0 0 5  0 0 1; echo "exit code $?"' 'miss  nothing along the ray' 'exit code 1' '```' 'More.' |
  cmp - "$scratch/doc.md" || fail "what it wrote is not what came out"
run || fail "what it wrote does not pass"
! run --least 2 || fail "a command that is gone is not noticed"
! run --least 0 || fail "a console block that should not be there is not noticed"
echo "wrong outputs and commands that are gone are noticed"
