#!/usr/bin/env bash
# The part of the guide to accuracy between its markers is what the generator prints from the committed rows.
# usage: readme_check.sh REPORT_TABLES GUIDE PAIRS PRICES [--write]
set -euo pipefail
tables=${1:?} guide=${2:?} pairs=${3:?} prices=${4:?}
begin='<!-- report: begin -->'
end='<!-- report: end -->'
grep -qxF -e "$begin" "$guide" && grep -qxF -e "$end" "$guide" || { echo "$guide: no markers"; exit 1; }
part=$("$tables" readme "$pairs" "$prices")
if [[ ${5:-} == --write ]]; then
  { sed "/^$begin\$/q" "$guide"; printf '%s\n' "$part"; sed -n "/^$end\$/,\$p" "$guide"; } >"$guide.new"
  mv "$guide.new" "$guide"
fi
shown=$(sed -n "/^$begin\$/,/^$end\$/p" "$guide" | sed '1d;$d')
diff -u --label guide --label generator <(printf '%s\n' "$shown") <(printf '%s\n' "$part") || {
  echo "the guide's table is not the generator's; write it with: $0 ... --write"; exit 1; }
