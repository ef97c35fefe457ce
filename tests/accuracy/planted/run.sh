#!/bin/sh
# Builds the exact phase and the census with one bug planted, and succeeds when the census finds wrong decisions.
# usage: run.sh SOURCE_DIR WORK_DIR COMPILER EIGEN_INCLUDE ENGINE BUG
set -eu
source=$1 work=$2/$6 compiler=$3 eigen=$4 engine=$5 bug=$6
mkdir -p "$work"
flags="-std=c++20 -O2 -DNDEBUG -ffp-contract=off -fno-tree-slp-vectorize"

# The planted copy of a header stands first on the include path.
plant() {
  mkdir -p "$work/planted/$(dirname "$1")"
  sed "$2" "$source/$1" > "$work/planted/$1"
  if cmp -s "$source/$1" "$work/planted/$1"; then echo "nothing was planted in $1"; exit 2; fi
}

part=0.001
sources="$(find "$source/server/exact_phase" -name "*.cpp" | tr "\n" " ") $source/server/geometry/pose.cpp $source/tests/accuracy/census/*.cpp"
# Where one file reads a constant, only that file is built anew; the rest comes out of the engine.
readers_of() { sources="$(grep -rl --include="*.cpp" "$1" "$source/server/exact_phase" | tr "\n" " ") $source/tests/accuracy/census/*.cpp"; }
case $bug in
  none) ;;
  triple_product) plant server/geometry/tolerance.hpp 's/kTripleProductError = 11 \*/kTripleProductError = 0.1 */'
    readers_of kTripleProductError ;;
  separation) plant server/geometry/tolerance.hpp 's/kSeparationError = 96 \*/kSeparationError = 0.1 */'
    readers_of kSeparationError ;;
  bounded) plant server/geometry/bounded.hpp 's/kRoundoff \* std::abs(value)/0x1p-58 * std::abs(value)/' ;;
  traced) plant server/geometry/bounded.hpp 's/(a.error + b.error) + std::abs(lost)/(a.error + b.error)/' ;;
  box_ulp) plant server/exact_phase/kernels/box_kernel.hpp 's/height\[i\] = half\[i\] \* abs(determinant)/height[i] = half[i] * abs(determinant) * N(1 - 0x1p-52)/' ;;
  contraction)
    # Fused products break the error-free transformations that the second rung stands on.
    flags="-std=c++20 -O2 -DNDEBUG -mfma -ffp-contract=fast -ffast-math -fno-finite-math-only"
    if ! grep -q fma /proc/cpuinfo; then echo "no fma on this machine"; exit 77; fi ;;
  *) echo "no such bug: $bug"; exit 2 ;;
esac

objects=
for file in $sources; do
  object=$work/$(basename "$file" .cpp).o
  # shellcheck disable=SC2086
  $compiler $flags -I"$work/planted" -I"$source" -isystem "$eigen" -c "$file" -o "$object"
  objects="$objects $object"
done
# An engine that was compiled in groups brings the file that was built anew along with its neighbours: the first counts.
# shellcheck disable=SC2086
$compiler $objects -Wl,--allow-multiple-definition "$engine" -lgmpxx -lgmp -lhwy -o "$work/census"

status=0
"$work/census" --part $part > "$work/census.txt" || status=$?
grep -E "^WRONG" "$work/census.txt" | head -5 || true
wrong=$(grep -c "^WRONG" "$work/census.txt" || true)
if [ "$bug" = none ]; then exit $status; fi
if [ "$wrong" -gt 0 ]; then echo "$bug: caught in $wrong rows"; exit 0; fi
echo "$bug: not caught"
exit 1
