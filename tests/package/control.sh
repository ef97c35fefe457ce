#!/usr/bin/env bash
# The Debian source package asks for every library that the product needs to build: deploy/packages.txt says what each is for.
# usage: control.sh ROOT
set -euo pipefail
cd "${1:?ROOT}"
# What only tests, benchmarks and the development machine need, by the purposes in that file.
not_to_build='tests|benchmarks|peer|proofs|demo:|second builds|deploy/package|C\+\+20 compiler|.*at run time'
needed=$(grep -vE '^#|^$' deploy/packages.txt | grep -vE "^[^ ]+ +($not_to_build)" | cut -d' ' -f1 | sort)
missing=$(comm -23 <(echo "$needed") <(sed -n '/^Build-Depends:/,/^[A-Z]/s/^ \([a-z0-9.+-]*\),$/\1/p' deploy/debian/control | sort))
[[ $(wc -l <<<"$needed") -ge 20 ]] || { echo "deploy/packages.txt names only: $needed"; exit 1; }
[[ -z $missing ]] || { echo "Build-Depends of deploy/debian/control lacks: $missing"; exit 1; }
