#!/usr/bin/env bash
# deploy/progress shows how far a build or a test run is, and passes on what else ninja and ctest print.
# usage: progress.sh REPOSITORY_ROOT
set -euo pipefail
progress=${1:?repository root}/deploy/progress
failures=0
# Where a step takes no time, the estimate depends on whether a second begins meanwhile.
any_time() { sed 's/about [0-9]* s/about N s/'; }
expect() { # WHAT EXPECTED GOT
  [[ $2 == "$3" ]] && return
  printf '%s:\nexpected: %s\ngot:      %s\n' "$1" "$2" "$3"
  failures=$((failures + 1))
}

build='ninja: Entering directory `build'\''
[0/2] Re-checking globbed directories...
[1/40] Building CXX object a.o
[2/40] Building CXX object b.o
[20/40] Building CXX object c.o
FAILED: c.o
c.cpp:1:1: error: no such thing
[21/40] Linking d'
expect 'a build' 'built 20 of 40, about N s left
FAILED: c.o
c.cpp:1:1: error: no such thing' "$("$progress" built <<<"$build" | any_time)"

run='Test project build
      Start  7: unit/One
 1/10 Test  #7: unit/One .........   Passed    0.01 sec
      Start 12: unit/Two
 2/10 Test #12: unit/Two .........***Failed    0.02 sec
it was 3, expected 4
 3/10 Test #13: unit/Three .......***Skipped   0.00 sec

90% tests passed, 1 tests failed out of 10'
expect 'a test run' 'tested 1 of 10, about N s left
 2/10 Test #12: unit/Two .........***Failed    0.02 sec
tested 2 of 10, about N s left
it was 3, expected 4
 3/10 Test #13: unit/Three .......***Skipped   0.00 sec
tested 3 of 10, about N s left

90% tests passed, 1 tests failed out of 10' "$("$progress" tested <<<"$run" | any_time)"

# On a terminal one line rewrites itself, and is gone before anything else is printed. `script` starts $SHELL, which must read bash.
shown=$(SHELL=$BASH script -qec "$(printf '%q built <<<%q' "$progress" "$build")" /dev/null | tr -d '\r')
expect 'the lines on a terminal' 3 "$(grep -c '' <<<"$shown")"
expect 'what a terminal shows last' 'c.cpp:1:1: error: no such thing' "$(sed -n 2p <<<"$shown")"
grep -qF $'\e[Kbuilt 2 of 40' <<<"$shown" || { echo "a terminal does not show each step: $shown"; failures=$((failures + 1)); }

# Where each step takes a second, what is left is known.
slow=$(for i in 1 2 3; do sleep 1; echo "[$i/6] Building"; done | "$progress" built | tail -1)
grep -qE '^built 3 of 6, about ([3-9]|[1-9][0-9]) s left$' <<<"$slow" || { echo "the time that is left: $slow"; failures=$((failures + 1)); }
exit $((failures > 0))
