#!/usr/bin/env bash
# The server's engine and event protocol under loss, repeats, reordering, clock jumps, crashes and restarts, without
# network, thread or clock: run.sh PROGRAMS COUNT [FIRST_SEED] [fleet]. fleet: of a server and one that stands by. Prints one line; fails where the contract was broken.
set -euo pipefail
programs=${1:?where the programs are}
count=${2:?how many seeds}
first=${COLLIDED_SEED:-${3:-1}}
"$programs/simulation_world" "$first" "$count" ${4:+"$4"} | "$programs/simulation_watchers"
