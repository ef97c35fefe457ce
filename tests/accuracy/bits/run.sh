#!/bin/sh
# Builds the exact phase anew with the given compiler and flags, and compares its bits with the expected ones.
# usage: run.sh SOURCE_DIR WORK_DIR EIGEN_INCLUDE HASH COMPILER FLAGS...
set -eu
source=$1 work=$2 eigen=$3 hash=$4 compiler=$5
shift 5
command -v "$compiler" > /dev/null || exit 77
if [ "$*" != "${*#*x86-64-v3}" ] && ! grep -q avx2 /proc/cpuinfo; then exit 77; fi
mkdir -p "$work"
objects=
for file in $(find "$source/server/exact_phase" -name "*.cpp") "$source/server/geometry/aabb.cpp" "$source/server/geometry/pose.cpp" \
    "$source/tests/accuracy/bits/main.cpp"; do
  object=$work/$(basename "$file" .cpp).o
  "$compiler" -std=c++20 -DNDEBUG -ffp-contract=off "$@" -I"$source" -isystem "$eigen" -c "$file" -o "$object"
  objects="$objects $object"
done
# shellcheck disable=SC2086
"$compiler" $objects -lgmpxx -lgmp -lhwy -o "$work/bits"
"$work/bits" --expect "$hash"
