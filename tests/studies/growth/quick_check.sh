#!/usr/bin/env bash
# usage: quick_check.sh DEPLOY_REPORT BUILD OUT
# The quick form makes a whole table: each knob is there, each law has theory's exponent beside a fitted one.
set -euo pipefail
"${1:?}" growth --quick --no-build --build "${2:?}" --out "${3:?}"
for knob in triangles movers contacts objects scenes pile clients subscribers; do
  grep -qE "^$knob .* \+- .* (constant|n|log n|n log n): [0-9.]+" "$3/growth.txt" || { echo "no law of $knob in growth.txt" >&2; exit 1; }
  grep -q "Growth with $knob" "$3/growth.html" || { echo "no plot of $knob" >&2; exit 1; }
done
if grep -E "nan|inf|unknown" "$3/growth.txt"; then echo "a law without a number" >&2; exit 1; fi
[[ $(wc -l <"$3/growth.csv") -gt 60 ]] || { echo "rows are missing" >&2; exit 1; }
