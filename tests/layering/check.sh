#!/usr/bin/env bash
# Fails on a callback passed as a function and a void* context, and on an include that runs against the arrows:
#   geometry <- intake, broad_phase, exact_phase <- world <- service <- fleet <- main;  client -> idl, never server.
#   vcollide, the engine in a caller's process, stands beside service. programs/ stand above the rooms they use.
# usage: check.sh REPOSITORY_ROOT [--no-format]
set -euo pipefail
cd "${1:?repository root}"

# A file obeys its room and, where the room has rooms of its own, that one too. "room/." is what lies in the room itself.
declare -A may=(
  [server/geometry]="server/geometry"
  [server/intake]="server/intake server/geometry idl/scene_tables.hpp idl/tiles_generated.h idl/unit_quaternion.hpp idl/question_rules.hpp idl/base64.hpp idl/voxel_blocks.hpp"
  [server/broad_phase]="server/broad_phase server/geometry"
  [server/exact_phase]="server/exact_phase server/geometry"
  [server/world]="server/world server/exact_phase server/broad_phase server/intake server/geometry collided/codes.hpp idl/glob.hpp idl/clocks.hpp idl/question_rules.hpp idl/answers/measured.hpp"
  [server/vcollide]="server/world server/exact_phase server/broad_phase server/geometry"
  [server/service]="server/service server/world server/exact_phase server/broad_phase server/intake server/geometry idl"
  [server/fleet]="server/fleet server/service server/world server/geometry idl"
  [server/programs]="server/programs server/world server/exact_phase server/broad_phase server/intake server/geometry"
  [client]="client collided idl"
  [client/library]="client/library collided idl"
  [idl]="idl collided/codes.hpp"
)
# What a room may not include of what stands above: optional parts that it does not know.
declare -A never=(
  [server/service]="idl/etcd idl/shards"
)
# Which rooms of the same room: an arrow that is not here is not wanted.
declare -A within=(
  [broad_phase/hierarchy]="."
  [broad_phase/sweep_and_prune]=". hierarchy"
  [broad_phase/grid]=". hierarchy sweep_and_prune"
  [exact_phase/arithmetic]=""
  [exact_phase/kernels]="arithmetic"
  [exact_phase/ray]="kernels arithmetic"
  [exact_phase/round_solids]="distance overlap kernels arithmetic"
  [exact_phase/distance]="round_solids overlap ray kernels arithmetic"  # a contact's depth begins with the yes or no
  [exact_phase/overlap]="distance kernels arithmetic"      # general shapes decide by the nearest point
  [exact_phase/solid]="kernels arithmetic"
  [exact_phase/motion]="given . round_solids overlap distance kernels arithmetic"
  [exact_phase/given]=". round_solids overlap distance ray kernels arithmetic"
  [intake/polygons]=". readers"
  [intake/mesh]=". polygons readers"
  [intake/simplify]=". mesh polygons"
  [intake/readers]=". mesh polygons"
  [intake/scene_file]=". mesh readers"
  [intake/tiles]=". mesh readers scene_file"
  [world/objects]=""
  [world/solids]="objects"
  [world/events]="objects"
  [world/step]=". objects solids events"
  [world/fences]="objects solids events step query groups"
  [world/query]=". objects solids step"
  [world/groups]=". objects solids query"
  [world/explain]="objects query groups fences events"
  [world/audit]=". objects solids step query"
  [service/runtime]=""
  [service/roles]="runtime"
  [service/recording]="durability runtime"
  [service/events]="recording runtime"
  [service/questions]="events recording roles runtime"
  [service/durability]="runtime"
  [service/ingest]="questions recording roles runtime"
  [service/commands]=". durability ingest questions roles runtime"
  [service/options]="commands questions"
  [fleet/authority]=""
  [fleet/shards]=""
)
violations=0
say() { echo "$1"; violations=$((violations + 1)); }
while IFS=$'\t' read -r file target; do
  for room in "${!may[@]}"; do
    [[ $file == "$room"/* ]] || continue
    allowed=no
    for prefix in ${may[$room]}; do [[ $target == "$prefix"/* || $target == "$prefix" ]] && allowed=yes; done
    [[ $allowed == yes ]] || say "$file includes \"$target\": $room may include only: ${may[$room]}"
    for prefix in ${never[$room]:-}; do
      [[ $target != "$prefix"/* ]] || say "$file includes \"$target\": $room may not include $prefix"
    done
  done
  [[ $file =~ ^server/([a-z_]+/[a-z_]+)/ ]] || continue
  inner=${BASH_REMATCH[1]}
  [[ -n ${within[$inner]+set} && $target == server/"${inner%%/*}"/* ]] || continue
  other=${target#server/"${inner%%/*}"/}
  [[ $other == */* ]] && other=${other%/*} || other=.  # no process for each line
  [[ $other == "${inner#*/}" || " ${within[$inner]} " == *" $other "* ]] ||
    say "$file includes \"$target\": $inner may include of its room only: ${within[$inner]}"
done < <(grep -rE '^ *#include "' server client idl --include='*.hpp' --include='*.cpp' |
         sed -E 's/^([^:]+): *#include "([^"]+)".*/\1\t\2/')
while IFS= read -r folder; do
  [[ -n ${within[${folder#server/}]+set} || $folder =~ ^server/(vcollide|programs)/ ]] ||
    say "$folder has no arrows in this script"
done < <(find server -mindepth 2 -maxdepth 2 -type d)
files=$(find server client idl -name '*.hpp' -o -name '*.cpp' | wc -l)
# One door a package.
door() { # PATTERN ALLOWED_REGEX NAME
  while IFS= read -r file; do
    [[ $file =~ $2 ]] || say "$file includes $3 past its door"
  done < <(grep -rlE "$1" server client idl --include='*.hpp' --include='*.cpp' || true)
}
door '#include [<"]fcl/' '^server/programs/opinion/' FCL
door '#include [<"]dds/' '^idl/dds' 'Cyclone DDS'
door '#include [<"](flatbuffers/|idl/(scene_tables|(scene|geometry|tiles)_generated))' '^(idl/scene_tables\.hpp|server/intake/scene_file/scene_(file\.cpp|(en|de)coder\.hpp)|server/intake/tiles/tile_format\.cpp|server/service/commands/geometry_encoding\.cpp|client/library/(publishing/shape_encoding|commands/geometry_decoding|recordings/recorded_shape)\.cpp)$' FlatBuffers
door '#include <boost/(asio|beast)' '^client/view/web_server\.cpp$' 'Boost.Beast'
door '#include <openssl/' '^(idl/keys/(key_module\.cpp|openssl_owners\.)|client/keys/certificates\.cpp)' OpenSSL
door '#include <curl/' '^idl/http/http_module\.cpp$' libcurl
door '#include <assimp/' '^server/programs/import/' Assimp
# Who calls back takes a FunctionRef, not a function and what it is to be given.
while IFS= read -r line; do
  say "$line: a callback is a FunctionRef (server/geometry/function_ref.hpp)"
done < <(grep -rnwE 'void ?\* ?context' server client idl tests --include='*.hpp' --include='*.cpp' || true)
# A tolerance has a name: a bare power of two stands in the definition of a constant only, or in the broad phase, whose
# kernels derive the bound of each float operation where it is made.
while IFS= read -r line; do
  say "$line: a bare tolerance; name it, in server/geometry/tolerance.hpp where others use it"
done < <(grep -rnE '0x1(\.[0-9a-f]+)?p[-+]?[0-9]+' server client idl --include='*.hpp' --include='*.cpp' |
         grep -vE '^server/broad_phase/|constexpr|^[^:]+:[0-9]+: *//|//[^"]*0x1' || true)
# The same of decimal ones, in the rooms that decide: smaller than a thousandth, neither a named constant nor the named
# default of an option.
while IFS= read -r line; do
  say "$line: a bare tolerance; name it, in server/geometry/tolerance.hpp or guess_tolerance.hpp where others use it"
done < <(grep -rnE '\b[0-9.]+e-0*([4-9]|[1-9][0-9])' server/{geometry,intake,exact_phase,world,vcollide} --include='*.hpp' --include='*.cpp' |
         sed -E 's/"[^"]*"//g; s://.*::' | grep -E '[0-9.]e-[0-9]' |
         grep -vE 'constexpr|^[^:]+:[0-9]+: *double [a-z_]+ = [0-9.e-]+;' || true)
# Tests run beside each other: a DDS domain is claimed, and a file in the temporary folder has the process in its name.
while IFS= read -r line; do
  say "$line: two tests may share this domain; start it by tests/in_own_domain.py"
done < <(grep -rnE 'COLLIDED_DOMAIN=[0-9]|--domain[ =][0-9]|with_server\.sh \$<TARGET_FILE:collided> [0-9]' tests --include='*.sh' --include='*.mjs' --include='*.py' --include='CMakeLists.txt' |
         grep -v '^tests/layering/' | grep -v -- '--domain 7 --namespace hall' || true)
while IFS= read -r line; do
  say "$line: two tests may share this file; add the process number or use ScratchFile (tests/cli/scratch_file.hpp)"
done < <(grep -rnE -A1 '(TempDir|temp_directory_path)\(\)\)? *(\+|/) *"[a-z_.]+"' tests --include='*.cpp' --include='*.hpp' |
         grep -E '"[a-z_]+\.[a-z]+"' || true)
# A type's name stands in one file: two that mean different things cost every reader. Those that are the same word on
# both sides of the wire (collided::Hit..., collided::engine::...) and a class whose inner part is defined in its .cpp are
# in the count; it may fall, never rise.
most_shared_names=74
shared_names=$(grep -rnE '\b(struct|class|enum class|enum|union) ' server client idl --include='*.hpp' --include='*.cpp' |
               sed -nE 's,^([^:]+):[0-9]+:([^/]*[^/a-z_])?(struct|class|enum|union) (\[\[[^]]*\]\] )?(alignas\([^)]*\) )?([A-Z][A-Za-z0-9_]*)( final)?( *:[^;{]*)? *\{.*,\6 \1,p' |
               sort -u | cut -d' ' -f1 | uniq -d)
[[ $(wc -w <<<"$shared_names") -le $most_shared_names ]] ||
  say "$(wc -w <<<"$shared_names") names of types stand in more than one file, allowed $most_shared_names: "$shared_names
# A file that a comment or the server's README names must be there; what cmake generates is not in the tree.
named=$(grep -rhoE '//.*' server client idl tests --include='*.hpp' --include='*.cpp' | grep -oE '[A-Za-z0-9_.-]+\.(cpp|hpp|idl|fbs)\b'
        grep -oE '[A-Za-z0-9_.-]+\.(cpp|hpp|idl|csv|sh)\b' server/README.md)
while IFS= read -r name; do
  say "'$name' is named in a comment or in server/README.md, and is not there"
done < <(comm -23 <(sort -u <<<"$named") <(find server client idl tests deploy -type f -printf '%f\n' | sort -u))
while IFS= read -r path; do
  [[ -e server/$path || -e $path ]] || say "'$path' is named in server/README.md, and is not there"
done < <(grep -oE '`(geometry|broad_phase|exact_phase|intake|world|service|client|tests|idl)/[A-Za-z0-9_./-]+`' server/README.md | tr -d '`')
# Formatted by .clang-format, where the version that it is written for is installed; another one differs in details.
if [[ ${2:-} == --no-format ]]; then
  :
elif [[ $(clang-format --version 2>/dev/null) == *" 14."* ]]; then
  while IFS= read -r line; do
    say "$line"
  done < <(find server client idl tests \( -name '*.hpp' -o -name '*.cpp' \) -print0 |
           xargs -0 -n60 -P2 clang-format --dry-run 2>&1 | grep -E 'warning: code should be clang-formatted' | cut -d: -f1 | sort -u |
           sed 's/$/: not formatted; run clang-format -i/')
else
  echo "clang-format 14 is not installed: formatting is not checked"
fi
echo "$files files, $violations violations"
[[ $files -gt 20 && $violations -eq 0 ]]
