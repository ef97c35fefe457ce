#!/usr/bin/env bash
# Says which tests of the last run were skipped and why, from ctest's own log: `N skipped: REASON`. A skip without a reason fails.
# usage: skipped.sh BUILD
set -euo pipefail
log=${1:?build folder}/Testing/Temporary/LastTest.log

awk '
  function close_test() { if (skipped) print (reason == "" ? "no reason given by " name : reason); skipped = 0; reason = "" }
  /^[0-9]+\/[0-9]+ Testing: / { close_test(); name = $3 }
  takes_next { reason = $0; takes_next = 0 }
  /: Skipped$/ { takes_next = 1 }
  /^skipped: / { reason = substr($0, 10) }
  /^Test Skipped\.$/ || /^\[  SKIPPED \]/ { skipped = 1 }
  END { close_test() }
' "$log" | sort | uniq -c | awk '
  { count = $1; $1 = ""; total += count; printf "%d skipped:%s\n", count, $0; if (/no reason given/) silent = 1 }
  END { if (!total) print "0 skipped"; exit silent }'
