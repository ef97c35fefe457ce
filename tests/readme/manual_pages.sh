#!/usr/bin/env bash
# Every manual page is shown without a warning, says its name, and has what the guide or the help that it is made of has.
# usage: manual_pages.sh MANUAL COLLIDE DOCS
set -euo pipefail
manual=${1:?} collide=${2:?} docs=${3:?}
command -v man >/dev/null && command -v groff >/dev/null || { echo "skipped: no man"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export LC_ALL=C.UTF-8 MANWIDTH=100 MAN_KEEP_FORMATTING=
faults=0
say() { printf '%s\n' "$1"; faults=$((faults + 1)); }

# Shows the page FILE; every further word must stand in it.
shown() { # FILE NAME TEXT...
  local file=$1 name=$2 page
  page=$(man -l --warnings "$file" 2>"$scratch/warnings" | col -bx)
  [[ ! -s $scratch/warnings ]] || say "$name: $(head -3 "$scratch/warnings")"
  shift 2
  for text in "$name - " "$@"; do
    [[ $page == *"$text"* ]] || say "$name: '$text' is not in it"
  done
}

options=$(for verb in $("$collide" complete -- ''); do "$collide" complete -- "$verb" --; done | sort -u)
shown "$manual/man1/collide.1" collide "collide sweep SHAPE NUMBERS --from X Y Z --to X Y Z" "--fields NAMES" "interrupted" $options \
  --encodings  # of `check`, whose help is another program's
shown "$manual/man1/collided.1" collided "--print-config" "COLLIDED_MAX_OBJECTS"
for guide in "$docs"/*.md; do
  name=$(basename "$guide" .md)
  # The last heading and the first command show that nothing is cut off and that code is code.
  heading=$(awk '/^```/ { code = !code } !code && /^## /' "$guide" | tail -1)
  command=$(grep -m1 '^\$ ' "$guide" | cut -c1-60 || true)
  shown "$manual/man7/collided-$name.7" "collided-$name" "${heading#\#\# }" "$command"
  "$collide" help "$name" >"$scratch/help"
  grep -qF -- "${heading#\#\# }" "$scratch/help" || say "collide help $name: its last heading is not there"
done
echo "$(ls "$docs"/*.md | wc -l) guides and 2 programs have manual pages; $faults faults"
[[ $faults -eq 0 ]]
