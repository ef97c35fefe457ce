#!/usr/bin/env bash
# Each name that `deploy/test --label` promises is a label of some test.
# usage: labels.sh REPOSITORY_ROOT BUILD
set -euo pipefail
promised=$(sed -n '/^# NAME:/,/^set /{/^#/p}' "${1:?repository root}/deploy/test" | tr -d '#\n' | grep -oE '\([^)]*\)|without it: .*' |
           sed 's/^without it//' | tr -c 'a-z\n' ' ')
# A build has the studies and their peers by an option.
grep -qs '^COLLIDED_STUDIES:BOOL=ON' "${2:?build folder}/CMakeCache.txt" || promised=$(sed -E 's/ (studies|peers)\>//g' <<<"$promised")
labels=$(ctest --test-dir "$2" --print-labels)
missing=0
for name in $promised; do
  grep -qE "^  $name\$" <<<"$labels" || { echo "deploy/test promises the label '$name'; no test has it"; missing=$((missing + 1)); }
done
count=$(wc -w <<<"$promised")
echo "$count labels, $missing missing"
[[ $count -ge 16 && $missing -eq 0 ]]
