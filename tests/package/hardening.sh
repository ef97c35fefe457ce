#!/usr/bin/env bash
# Usage: hardening.sh BUILD
# What reads bytes of strangers is built with stack protector, _FORTIFY_SOURCE, immediate binding, read-only relocations and
# position-independent, and no stack is executable.
set -euo pipefail
build=${1:?BUILD}
bad=0
for file in server/collided server/collided-import server/collided-files server/collided-opinion server/collided-handshake.so lib/collided/collided-{http,keys}.so \
  client/cli/collide client/cli/collide-{draw,fleet,keys,ros,shell,view} client/libcollided_client.so.2; do
  [[ -e $build/$file ]] || continue  # without FCL there is no opinion
  header=$(readelf -hW "$build/$file") segments=$(readelf -lW "$build/$file") dynamic=$(readelf -dW "$build/$file")
  symbols=$(readelf -sW "$build/$file")
  lacks() { echo "$file lacks $1"; bad=1; }
  grep -q DYN <<<"$header" || lacks "position independence"
  grep -q GNU_RELRO <<<"$segments" || lacks "read-only relocations"
  grep -qE 'BIND_NOW|FLAGS_1.*NOW' <<<"$dynamic" || lacks "immediate binding"
  grep -q __stack_chk_fail <<<"$symbols" || lacks "a stack protector"
  # In small libraries every size is a constant, so that no call is left for a check at run time.
  [[ $file == */collided-*.so ]] || grep -qE '__[a-z]+_chk(@|$)' <<<"$symbols" || lacks "_FORTIFY_SOURCE"
  ! grep GNU_STACK <<<"$segments" | grep -q RWE || lacks "a stack that is not executable"
done
exit $bad
