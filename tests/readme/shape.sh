#!/usr/bin/env bash
# README can be read in a minute, every guide is found from it and by a test, no link leads nowhere, and every script of
# deploy says how it is called.
# usage: shape.sh ROOT
set -euo pipefail
cd "${1:?ROOT}"
faults=0
say() { printf '%s\n' "$1"; faults=$((faults + 1)); }

lines=$(wc -l <README.md)
((lines <= 150)) || say "README.md has $lines lines, allowed are 150"

# The blocks of each start, without the fences.
starts=$(awk '/^## /{ inside = ($0 == "## Three starts") } inside && /^### /{ name = $0; count[name] = 0 }
  inside && /^```/{ code = !code; next } inside && code { ++count[name] }
  END { for (name in count) print count[name], name }' README.md)
[[ $(wc -l <<<"$starts") -eq 3 ]] || say "README.md has these starts, not three: $starts"
while read -r count name; do
  ((count >= 2 && count <= 10)) || say "README.md: '$name' has $count lines of commands and output, allowed are 2 to 10"
done <<<"$starts"

# The part of a heading after '#' in a link, as GitHub makes it.
anchors() { grep -E '^#+ ' "$1" | sed -E 's/^#+ +//' | tr '[:upper:]' '[:lower:]' | sed -E 's/[^a-z0-9 _-]//g; s/ /-/g'; }

for document in README.md deploy/docs/*.md; do
  # Tables may be wide; the measured ones, between their marks, are written by a program.
  long=$(sed '/^<!-- report: begin/,/^<!-- report: end/s/.*//' "$document" | LC_ALL=C.UTF-8 grep -nE '^[^|].{160}' | cut -c1-40 || true)
  [[ -z $long ]] || say "$document: more than 160 columns: $long"
  # What a reader wants to do comes first, below the title.
  [[ $document == README.md || $(sed -n 3p "$document") == 'You want '* ]] || say "$document does not begin with 'You want ...'"
  folder=$(dirname "$document")
  while IFS= read -r link; do
    [[ $link == http* ]] && continue
    path=${link%%#*}
    target=${path:+$folder/$path}
    target=${target:-$document}
    [[ -e $target ]] || { say "$document: the link $link leads nowhere"; continue; }
    [[ $link != *'#'* ]] || anchors "$target" | grep -qxF -- "${link#*#}" || say "$document: $link has no such heading"
  done < <(awk '/^```/{ code = !code } !code' "$document" | grep -oE '\]\([^) ]+\)' | sed 's/^](//; s/)$//')
done

for guide in deploy/docs/*.md; do
  grep -qF "]($guide)" README.md || say "README.md has no link to $guide"
  grep -qF "$guide " tests/readme/CMakeLists.txt || say "no test runs $guide"
done
for script in deploy/*; do
  [[ -f $script && -x $script ]] || continue
  said=$("$script" --help </dev/null 2>&1) || say "$script --help fails: $said"
  [[ $said == *"  $script"* ]] || say "$script --help does not say how it is called: $said"
done
echo "README.md: $lines lines; $(ls deploy/docs/*.md | wc -l) guides; $faults faults"
[[ $faults -eq 0 ]]
