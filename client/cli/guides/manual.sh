#!/bin/sh
# Makes the manual pages in OUTPUT: collide(1) and collided(1) from the programs' own help, and one of section 7
# for each guide. PANDOC, COLLIDE, COLLIDED, COLLIDED_FILES: paths of programs.
# usage: VARIABLES manual.sh DOCS OUTPUT GUIDE...
set -eu
docs=$1 output=$2
shift 2
export COLLIDED_FILES  # it prints the help of some verbs
mkdir -p "$output/man1" "$output/man7"

# page NAME SECTION [PANDOC'S WORDS]: from Markdown in a file, or on standard input
page() {
  name=$1 section=$2
  shift 2
  # No date: pages made twice from the same files are equal.
  "$PANDOC" -s -f commonmark+pipe_tables -t man -M "title=$name" -M "section=$section" -M header=Collided -M "footer=Collided $VERSION" \
    -V adjusting=l -M hyphenate=false -L "$(dirname "$0")/guide.lua" -o "$output/man$section/$name.$section" "$@"
}
as_it_is() { printf '\n```\n' && "$@" && printf '```\n\n'; }
see_also() { printf '# SEE ALSO\n%s(1)' "$1" && shift && printf ', collided-%s(7)' "$@"; }

{
  printf '# NAME\ncollide - ask a collision server about rays, spheres and boxes\n\n'
  printf '# SYNOPSIS\n**collide** [options] *VERB* [arguments]\n\n# DESCRIPTION\n'
  as_it_is "$COLLIDE" help
  printf '# OPTIONS\n'
  as_it_is "$COLLIDE" help options
  printf '# VERBS\n\n'
  for verb in $("$COLLIDE" complete -- ''); do
    why=$("$COLLIDE" help "$verb" 2>&1 >/dev/null) || case $why in
      *'was not found'*) continue ;;  # this build leaves its program out
    esac
    printf '## %s\n' "$verb"
    as_it_is "$COLLIDE" help "$verb"
  done
  printf '# EXIT STATUS\n\n'
  sed -n '/^## Exit codes/,/^## /{/^|/p}' "$docs/asking.md" && echo
  see_also collided "$@"
} | page collide 1
{
  printf '# NAME\ncollided - a collision query service on DDS\n\n# SYNOPSIS\n**collided** [*SCENE* ...]\n\n# DESCRIPTION\n'
  as_it_is "$COLLIDED" --help
  see_also collide "$@"
} | page collided 1
for guide; do
  page "collided-$guide" 7 "$docs/$guide.md"
done
