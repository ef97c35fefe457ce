#!/usr/bin/env bash
# Installs into a prefix of its own and uses what is there, with nothing of the build tree in any path: files at their
# places, a server started by the unit's own line, a ray, completion, a consumer built by pkg-config.
# usage: prefix.sh BUILD [CXX [FLAGS]]
set -euo pipefail
# In a network of its own where that is allowed: no other server of this machine can answer.
if [[ -z ${COLLIDED_ALONE:-} ]] && command -v ip >/dev/null && unshare --net true 2>/dev/null; then
  COLLIDED_ALONE=1 exec unshare --net bash -c 'ip link set lo up && exec "$@"' - "${BASH_SOURCE[0]}" "$@"
fi
build=${1:?build folder} cxx=${2:-c++} flags=${3:-}
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scratch=$(mktemp -d)
server=
# shellcheck disable=SC2317  # trap
leave() {
  [[ -z $server ]] || { kill -TERM "$server" 2>/dev/null; wait "$server" 2>/dev/null; } || true
  rm -rf "$scratch"
}
trap leave EXIT
fail() { echo "$*" >&2; exit 1; }

# The prefix moves after the installation: what holds then holds anywhere.
cmake --install "$build" --prefix "$scratch/first" >"$scratch/install.log"
[[ $(sed -n 's/^ExecStart=//p' "$scratch/first/lib/systemd/system/collided.service") == \
   "$scratch/first/bin/collided --config $scratch/first/etc/collided/collided.toml" ]] || fail "the unit starts something else"
# A second installation leaves a configuration alone that somebody has edited.
echo '# edited' >>"$scratch/first/etc/collided/collided.toml"
cmake --install "$build" --prefix "$scratch/first" --component server >>"$scratch/install.log"
grep -q '^# edited' "$scratch/first/etc/collided/collided.toml" || fail "installing anew overwrote the configuration"
mv "$scratch/first" "$scratch/prefix"
prefix=$scratch/prefix
lib=$(dirname "$(find "$prefix" -name libcollided_client.so)")

while read -r path; do
  [[ -s $prefix/$path ]] || fail "$path is not installed"
done <<END
bin/collided
bin/collide
libexec/collided/collided-import
libexec/collided/collided-handshake.so
libexec/collided/collided-files
libexec/collided/collide-draw
libexec/collided/collide-fleet
libexec/collided/collide-keys
libexec/collided/collide-ros
libexec/collided/collide-shell
libexec/collided/collide-view
lib/systemd/system/collided.service
etc/collided/collided.toml
share/doc/collided/examples/cyclonedds.xml
share/bash-completion/completions/collide
share/zsh/site-functions/_collide
share/fish/vendor_completions.d/collide.fish
share/collided/idl/collided.idl
share/man/man1/collide.1
share/man/man1/collided.1
share/man/man7/collided-asking.7
include/collided.h
include/collided/client.hpp
lib/python3/dist-packages/collided/__init__.py
include/collided/vcollide.hpp
${lib#"$prefix"/}/cmake/Collided/CollidedConfig.cmake
${lib#"$prefix"/}/pkgconfig/collided.pc
${lib#"$prefix"/}/collided/collided-http.so
${lib#"$prefix"/}/collided/collided-keys.so
${lib#"$prefix"/}/libcollided_client.so.2
${lib#"$prefix"/}/libcollided_vcollide.so.2
END
# A debugger's data may know it; not what is read when programs run and others are built.
grep -rlIF "$build" "$prefix" && fail "the files above know the build tree"
for program in "$prefix"/bin/* "$prefix"/libexec/collided/* "$lib"/*.so "$lib"/collided/*.so; do
  readelf -d "$program" | grep -F "$build" && fail "$program looks for libraries in the build tree"
done
bash -c "source '$prefix/share/bash-completion/completions/collide' && complete -p collide" | grep -q _collide ||
  fail "bash has no completion for collide"

export COLLIDED_STATE_DIR=$scratch/state
"$prefix/bin/collided" --config "$prefix/etc/collided/collided.toml" >"$scratch/server.out" 2>&1 &
server=$!
for ((i = 0; i < 400; ++i)); do
  grep -qs '^ready' "$scratch/server.out" && break
  sleep 0.05
done
answer=$("$prefix/bin/collide" ray 0 0 5  0 0 -1 --fields answer,object) || { cat "$scratch/server.out"; fail "no answer"; }
[[ $answer == $'hit\twarehouse/shelf_3/top' ]] || fail "the installed programs answer '$answer'"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >"$scratch/one.obj"
"$prefix/bin/collide" check "$scratch/one.obj" | grep -q '1 triangle' || fail "collide does not find collided-files"

for verb in draw fleet keys ros view; do
  "$prefix/bin/collide" $verb --help | grep -q "^collide $verb - " || fail "collide does not find collide-$verb"
done

# The Python client finds the library beside itself.
if [[ -x /usr/bin/python3 ]]; then
  answer=$(PYTHONPATH=$prefix/lib/python3/dist-packages PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -c '
import collided
with collided.connect() as c:
    print(c.ray((0, 0, 5), (0, 0, -1)).hits[0].object)') || fail "Python has no client"
  [[ $answer == warehouse/shelf_3/top ]] || fail "Python got '$answer'"
fi

# The library by pkg-config; which prefix it lies in is known from the .pc file alone.
for module in collided collided-vcollide; do
  PKG_CONFIG_PATH=$lib/pkgconfig pkg-config --validate "$module"
done
told=$(PKG_CONFIG_PATH=$lib/pkgconfig pkg-config --cflags --libs collided)
read -ra use <<<"$told"
read -ra extra <<<"$flags"
"$cxx" -std=c++20 "${extra[@]}" "$here/ask.cpp" "${use[@]}" -Wl,-rpath,"$lib" -o "$scratch/ask"
answer=$("$scratch/ask")
[[ $answer == warehouse/shelf_3/top ]] || fail "the consumer got '$answer'"
echo "installed, moved, asked: $answer"
