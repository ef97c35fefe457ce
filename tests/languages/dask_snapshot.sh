#!/usr/bin/env bash
# Dask's workers that serve a snapshot each answer as the server does of whose world it is.
# usage: dask_snapshot.sh COLLIDE COLLIDED DOMAIN PYTHON dask_rays.py ARGUMENTS
set -euo pipefail
collide=${1:?} collided=${2:?} domain=${3:?}
shift 3
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$collide" add crate box 0.4 0.4 0.4 --at 1 2 0.2 --domain "$domain" >/dev/null
"$collide" snapshot "$scratch/now.cscene" --domain "$domain"
PATH=$(dirname "$collided"):$PATH "$@" --snapshot "$scratch/now.cscene"
