#!/bin/sh
# Proves every filter constant, as the product has it, with gappa, and that a sixteenth of it can't be proved.
# Exit 77 where gappa is not installed.
# usage: run.sh SOURCE_FOLDER CONSTANTS_PROGRAM WORK_FOLDER
set -eu
command -v gappa > /dev/null || exit 77
mkdir -p "$3"
"$2" > "$3/constants.sed"
"$2" 0.0625 > "$3/too_small.sed"
prove() { gappa -Eprecision=256 "$1" > "$1.log" 2>&1 && ! grep -qi "warning\|failed\|error" "$1.log"; }

failed=0
for template in "$1"/*.g.in; do
  name=$(basename "$template" .g.in)
  sed -f "$3/constants.sed" "$template" > "$3/$name.g"
  sed -f "$3/too_small.sed" "$template" > "$3/$name.too_small.g"
  if ! prove "$3/$name.g"; then
    echo "NOT proved: $name"
    cat "$3/$name.g.log"
    failed=1
  elif prove "$3/$name.too_small.g"; then
    echo "$name is proved of any constant"
    failed=1
  else
    echo "proved: $name"
  fi
done
exit $failed
