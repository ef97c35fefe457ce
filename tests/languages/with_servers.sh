#!/usr/bin/env bash
# Runs a command while three servers serve the built-in warehouse, on the DDS domains DOMAIN to DOMAIN + 2.
# usage: with_servers.sh COLLIDED DOMAIN COMMAND...
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
collided=${1:?} domain=${2:?}
shift 2
one() { "$here/with_server.sh" "$collided" "$1" "${@:2}"; }
export -f one
export here collided
one "$domain" bash -c 'one "$@"' _ $((domain + 1)) bash -c 'one "$@"' _ $((domain + 2)) "$@"
