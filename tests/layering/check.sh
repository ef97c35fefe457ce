#!/usr/bin/env bash
# Fails on a callback passed as a function and a void* context, and on an include that runs against the arrows:
#   geometry <- intake, broad_phase, exact_phase <- world <- service <- main;  client -> idl, never server.
#   vcollide, the engine in a caller's process, stands beside service. intake/files is the program that checks and converts files.
# usage: check.sh REPOSITORY_ROOT
set -euo pipefail
cd "${1:?repository root}"

declare -A may=(
  [server/geometry]="server/geometry"
  [server/intake]="server/intake server/geometry idl"
  [server/intake/files]="server/world server/exact_phase server/broad_phase server/intake server/geometry"  # a program: above the rooms it uses
  [server/broad_phase]="server/broad_phase server/geometry"
  [server/exact_phase]="server/exact_phase server/geometry"
  [server/world]="server/world server/exact_phase server/broad_phase server/intake server/geometry idl"
  [server/vcollide]="server/world server/exact_phase server/broad_phase server/geometry"
  [server/service]="server/service server/world server/exact_phase server/broad_phase server/intake server/geometry idl"
  [client]="client collided idl"
  [idl]="idl"
)
violations=0
files=0
for room in "${!may[@]}"; do
  while IFS=: read -r file _ include; do
    target=$(sed -E 's/^ *#include "([^"]+)".*/\1/' <<<"$include")
    allowed=no
    for prefix in ${may[$room]}; do [[ $target == "$prefix"/* ]] && allowed=yes; done
    if [[ $allowed == no ]]; then
      echo "$file includes \"$target\": $room may include only: ${may[$room]}"
      violations=$((violations + 1))
    fi
  done < <(grep -rnE '^ *#include "' "$room" --include='*.hpp' --include='*.cpp' | grep -v "^$room/files/" || true)
  files=$((files + $(find "$room" -name '*.hpp' -o -name '*.cpp' | wc -l)))
done
# One door a package.
door() { # PATTERN ALLOWED_REGEX NAME
  while IFS= read -r file; do
    [[ $file =~ $2 ]] || { echo "$file includes $3 past its door"; violations=$((violations + 1)); }
  done < <(grep -rlE "$1" server client idl --include='*.hpp' --include='*.cpp' || true)
}
door '#include [<"]fcl/' '^$' FCL  # has none: a yardstick of the tests alone
door '#include [<"]dds/' '^idl/dds' 'Cyclone DDS'
door '#include [<"](flatbuffers/|idl/(scene|geometry)_generated)' '^(server/intake/scene_(file\.cpp|encoder\.hpp)|server/service/geometry_encoding\.cpp|client/library/(shape_encoding|geometry_decoding)\.cpp)$' FlatBuffers
door '#include <boost/(asio|beast)' '^client/view/web_server\.cpp$' 'Boost.Beast'
door '#include <assimp/' '^server/intake/import/' Assimp
# Who calls back takes a FunctionRef, not a function and what it is to be given.
while IFS= read -r line; do
  echo "$line: a callback is a FunctionRef (server/geometry/function_ref.hpp)"
  violations=$((violations + 1))
done < <(grep -rnwE 'void ?\* ?context' server client idl tests --include='*.hpp' --include='*.cpp' || true)
# A file that a comment or the server's README names must be there; what cmake generates is not in the tree.
named=$(grep -rhoE '//.*' server client idl tests --include='*.hpp' --include='*.cpp' | grep -oE '[A-Za-z0-9_.-]+\.(cpp|hpp|idl|fbs)\b'
        grep -oE '[A-Za-z0-9_.-]+\.(cpp|hpp|idl|csv|sh)\b' server/README.md)
while IFS= read -r name; do
  echo "'$name' is named in a comment or in server/README.md, and is not there"
  violations=$((violations + 1))
done < <(comm -23 <(sort -u <<<"$named") <(find server client idl tests deploy -type f -printf '%f\n' | sort -u))
echo "$files files, $violations violations"
[[ $files -gt 20 && $violations -eq 0 ]]
