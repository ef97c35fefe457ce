#!/usr/bin/env bash
# The README's part between its markers is what the generator prints from the committed rows.
# usage: readme_check.sh REPORT_TABLES README PAIRS PRICES [--write]
set -euo pipefail
tables=${1:?} readme=${2:?} pairs=${3:?} prices=${4:?}
begin='<!-- report: begin -->'
end='<!-- report: end -->'
grep -qxF -e "$begin" "$readme" && grep -qxF -e "$end" "$readme" || { echo "README: no markers"; exit 1; }
part=$("$tables" readme "$pairs" "$prices")
if [[ ${5:-} == --write ]]; then
  { sed "/^$begin\$/q" "$readme"; printf '%s\n' "$part"; sed -n "/^$end\$/,\$p" "$readme"; } >"$readme.new"
  mv "$readme.new" "$readme"
fi
shown=$(sed -n "/^$begin\$/,/^$end\$/p" "$readme" | sed '1d;$d')
diff -u --label README --label generator <(printf '%s\n' "$shown") <(printf '%s\n' "$part") || {
  echo "the README's table is not the generator's; write it with: $0 ... --write"; exit 1; }
