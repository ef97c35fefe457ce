#!/usr/bin/env bash
# check.sh, includes.py, header_weights.py and english.py find what they are there to find: each line below, added to a
# copy of the tree or taken from it, is refused for its reason.
# usage: bites.sh REPOSITORY_ROOT
set -euo pipefail
cd "${1:?repository root}"
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
cp -r server client idl tests deploy "$copy"
missed=0
expected=()
# plant FILE LINE REASON: the reason is part of what check.sh says about the file
plant() {
  printf '%s\n' "$2" >>"$copy/$1"
  expected+=("$1"$'\t'"$3")
}
plant server/world/query/near_question.cpp 'const double margin = 3 * 1e-9;' 'a bare tolerance'
plant server/exact_phase/manifold.cpp 'bool is_flat(double x) { return x < 2.5e-12; }' 'a bare tolerance'
plant server/world/step/candidates.cpp 'const double margin = 1 + 0x1p-40;' 'a bare tolerance'
plant server/geometry/pose.cpp '#include "server/world/world.hpp"' 'server/geometry may include only'
plant server/service/server.cpp '#include "server/fleet/fleet_place.hpp"' 'server/service may include only'
plant server/service/options/options.cpp '#include "idl/etcd/etcd_address.hpp"' 'may not include idl/etcd'
plant client/library/client.cpp '#include "server/geometry/pose.hpp"' 'client may include only'
plant client/library/asking/ask.cpp '#include "client/fleet/replicas.hpp"' 'client/library may include only'
plant server/world/world.cpp '#include <dds/dds.h>' 'past its door'
plant idl/columns.cpp 'void call(void* context);' 'a callback is a FunctionRef'
plant tests/cli/demo.sh 'export COLLIDED_DOMAIN=219' 'two tests may share this domain'
plant tests/cli/pair_test.cpp 'const auto file = std::filesystem::path(testing::TempDir()) / "arm.urdf";' 'two tests may share this file'
said=$("$copy/tests/layering/check.sh" "$copy" --no-format || true)
for item in "${expected[@]}"; do
  file=${item%%$'\t'*}
  reason=${item#*$'\t'}
  grep -F "$file" <<<"$said" | grep -qF "$reason" || { echo "not found: $file: $reason"; missed=$((missed + 1)); }
done
# Named ones, units and text are no tolerances.
cat >>"$copy/server/world/query/near_question.cpp" <<'END'
constexpr double kFine = 1e-9;
// 1e-9 in a comment, "1e-9" in a text
END
if "$copy/tests/layering/check.sh" "$copy" --no-format | grep -qE 'kFine|1e-9 in a comment'; then
  echo "a named constant or a comment was refused"
  missed=$((missed + 1))
fi
# drop FILE INCLUDE NAME: without the include, the file uses a name that nothing brings.
drop() {
  grep -qF "#include $2" "$copy/$1" || { echo "$1 has no #include $2"; missed=$((missed + 1)); }
  grep -vF "#include $2" "$1" >"$copy/$1"
  dropped+=("$1: uses $3 and")
}
dropped=()
drop client/cli/output/standing_output.cpp '"client/cli/input/number.hpp"' format_duration
drop server/service/commands/standing_definition.cpp '"server/world/solids/declared.hpp"' DeclaredMesh
drop server/service/runtime/supervisor.cpp '<string_view>' std::string_view
said=$(python3 "$copy/tests/layering/includes.py" "$copy" || true)
for line in "${dropped[@]}"; do
  grep -qF "$line" <<<"$said" || { echo "not found: $line"; missed=$((missed + 1)); }
done
# A library, or too much text, in a header.
heavy=()
weigh() { # FILE INCLUDE REASON
  printf '#include %s\n' "$2" >>"$copy/$1"
  heavy+=("$1: $3")
}
weigh server/service/options/options.hpp '<fmt/format.h>' 'includes fmt/'
weigh client/library/connection/connection.hpp '<regex>' 'kB, '
said=$(python3 "$copy/tests/layering/header_weights.py" "$copy" || true)
for line in "${heavy[@]}"; do
  grep -F "${line%%: *}" <<<"$said" | grep -qF "${line#*: }" || { echo "not found: $line"; missed=$((missed + 1)); }
done
# A sentence with a habit in a comment; the same words in a text or in backquotes are not one.
spoken=()
speak() { # FILE COMMENT HABIT
  printf '%s\n' "$2" >>"$copy/$1"
  spoken+=("$1"$'\t'"$3")
}
speak server/geometry/pose.cpp '// The pose is kept for whoever asks.' 'people for things'
speak server/geometry/pose.cpp '// Of three poses the first counts.' 'Of or For as opener'
speak server/geometry/aabb.cpp '/// The box is told to the grid.' 'speaking software'
speak server/geometry/aabb.cpp '// Where the box is empty, the answer is no.' 'where for if'
speak server/geometry/mesh.hpp '/// A mesh without triangles is no surface.' 'is no'
speak server/geometry/ray.hpp 'struct Planted {};  // null: none; likewise' 'likewise'
speak server/geometry/shape.hpp $'// The hull is built\n// anew for each shape.' 'anew'
speak server/geometry/shapes.hpp '// What is kept is kept.' 'headless clause'
cat >>"$copy/server/geometry/pose.cpp" <<'END'
const char* const kSpoken = "nobody // says so anew";
// `told` is a name, and there is no habit in "a user who asks".
END
said=$(python3 "$copy/tests/layering/english.py" "$copy" || true)
for item in "${spoken[@]}"; do
  grep -F "${item%%$'\t'*}" <<<"$said" | grep -qF ": ${item#*$'\t'}: " || { echo "not found: $item"; missed=$((missed + 1)); }
done
if grep -qE 'says so anew|is a name' <<<"$said"; then
  echo "a text, or a name in backquotes, was refused"
  missed=$((missed + 1))
fi
echo "$((${#expected[@]} + ${#dropped[@]} + ${#heavy[@]} + ${#spoken[@]})) planted, $missed missed"
[[ $missed -eq 0 ]]
