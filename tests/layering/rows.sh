#!/usr/bin/env bash
# Compares tests/rows.txt with the tests: every row that is shown stands by its number in a comment of a test, no row that is
# marked as missing does, no test names a row that there is not, and no row is lost from the list.
# usage: rows.sh REPOSITORY_ROOT
set -euo pipefail
cd "${1:?repository root}"

violations=0
say() { echo "$1"; violations=$((violations + 1)); }

# Tests name rows; what they are compared with and the scenes they share do not show anything.
mapfile -t named < <(find tests -type f \( -name '*.cpp' -o -name '*.hpp' -o -name '*.mjs' -o -name '*.sh' \) \
                       -not -path 'tests/oracle/*' -not -path 'tests/scenes/*' -not -path 'tests/layering/*' -print0 |
                     xargs -0 grep -hE '//|^ *#' | grep -oE '(//|#).*' | grep -owE '[ABU][1-9][0-9]?' | sort -u)
declare -A is_named=()
for row in "${named[@]}"; do is_named[$row]=1; done

declare -A is_listed=()
shown=0
missing=0
nothing=0
while read -r row mark words; do
  [[ -z ${is_listed[$row]:-} ]] || say "tests/rows.txt: $row stands there twice"
  is_listed[$row]=1
  case $mark in
    -)
      missing=$((missing + 1))
      [[ -n $words ]] || say "tests/rows.txt: $row is missing without a reason"
      [[ -z ${is_named[$row]:-} ]] || say "$row is marked as missing and a test names it: take the mark away" ;;
    =)
      nothing=$((nothing + 1))
      [[ -z ${is_named[$row]:-} ]] || say "$row has nothing to show and a test names it" ;;
    '') say "tests/rows.txt: $row has no words" ;;
    *)
      shown=$((shown + 1))
      [[ -n ${is_named[$row]:-} ]] || say "$row ($mark $words) is named in no test: show it, or mark it with - and the reason" ;;
  esac
done < <(grep -vE '^(#|$)' tests/rows.txt)

for row in "${named[@]}"; do
  [[ -n ${is_listed[$row]:-} ]] || say "a test names $row, which is no row of tests/rows.txt"
done
for series in A:74 B:22 U:4; do
  for ((i = 1; i <= ${series#*:}; ++i)); do
    [[ -n ${is_listed[${series%:*}$i]:-} ]] || say "tests/rows.txt has lost ${series%:*}$i"
  done
done
[[ $((shown + missing)) -eq 99 && $nothing -eq 1 ]] ||
  say "$((shown + missing)) rows to show and $nothing with nothing to show: there are 99 and 1"
echo "$shown rows shown, $missing missing, $nothing with nothing to show, $violations violations"
[[ $violations -eq 0 ]]
