#!/usr/bin/env bash
# The Debian packages as their users meet them: packed twice from different folders they are equal in every byte, lintian
# finds no error, and in a clean root that has what they say they need, and nothing else, they install, answer a ray as the
# service would be started, and leave nothing when purged. Exit status 77 where a tool is missing or this is not root.
# usage: debian.sh SOURCE BUILD WORK     BUILD: a build tree of packages that is kept; WORK: a scratch folder
set -euo pipefail
source=${1:?source folder} build=${2:?build folder} work=${3:?scratch folder}
for tool in dh lintian unshare ip; do
  command -v "$tool" >/dev/null || { echo "skipped: no $tool"; exit 77; }
done
if [[ $(id -u) -ne 0 ]] || ! unshare --net --mount true 2>/dev/null; then
  echo "skipped: only root may chroot and mount"
  exit 77
fi
if [[ -z ${COLLIDED_ALONE:-} ]]; then
  COLLIDED_ALONE=1 exec unshare --net bash -c 'ip link set lo up && exec "$@"' - "${BASH_SOURCE[0]}" "$@"
fi
rm -rf --one-file-system "$work"
mkdir -p "$work"
clean=$work/root
server=
# shellcheck disable=SC2317  # trap
leave() {
  [[ -z $server ]] || { kill -TERM "$server" 2>/dev/null; wait "$server" 2>/dev/null; } || true
  rm -rf --one-file-system "$work"
}
trap leave EXIT
fail() { echo "$*" >&2; exit 1; }

# The second packing compiles everything anew, under other paths.
"$source/deploy/package" --build "$build" --output "$work/packages"
CCACHE_DISABLE=1 "$source/deploy/package" --build "$work/again" --output "$work/packages-again"
[[ $(find "$work/packages" -name '*.deb' | wc -l) -eq 5 ]] || fail "not five packages"
for package in "$work"/packages/*.deb; do
  cmp "$package" "$work/packages-again/$(basename "$package")" || fail "two packings differ"
done
echo "two packings are equal in every byte"
rm -rf "$work/again"

# They go to nobody's archive: there is no request for a package that the changelog could close.
lintian --allow-root --fail-on error --suppress-tags initial-upload-closes-no-bugs "$work"/packages/*.deb 2>/dev/null ||
  fail "lintian finds errors"

# The clean root: Debian's essential packages and what ours depend on, copied from this machine with their entries of dpkg's
# database. A dependency that is not declared is not there.
declared=$(for package in "$work"/packages/*.deb; do dpkg-deb -f "$package" Pre-Depends Depends; done |
           sed -E 's/^[A-Za-z-]+: //' | tr ',' '\n' | sed -E 's/^ *([^ :|(]+).*/\1/' | grep -v '^libcollided')
mapfile -t closure < <(dpkg-query -W -f '${db:Status-Status}\t${Package}\t${Essential}\t${Provides}\t${Pre-Depends},${Depends}\n' |
  awk -F '\t' -v declared="$declared" '
    function names(list, into) { gsub(/\([^)]*\)|:[a-z0-9]+/, "", list); return split(list, into, /[ ,|\n]+/) }
    function want(name,   of, count, i) {  # and what it needs, by a real or a virtual name
      if (name == "" || name in seen) return
      seen[name] = 1
      count = names(providers[name], of)
      for (i = 1; i <= count; ++i) { if (of[i] != "" && of[i] != name) want(of[i]) }
      if (!(name in needs)) return
      print name
      count = names(needs[name], of)
      for (i = 1; i <= count; ++i) want(of[i])
    }
    $1 == "installed" {
      needs[$2] = $5
      if ($3 == "yes") declared = declared " " $2
      count = names($4, virtual)
      for (i = 1; i <= count; ++i) providers[virtual[i]] = providers[virtual[i]] " " $2
    }
    END { count = names(declared, first); for (i = 1; i <= count; ++i) want(first[i]) }' | sort -u)
database=$clean/var/lib/dpkg
mkdir -p "$clean" "$database"/{info,updates,triggers}
for folder in /bin /sbin /lib*; do  # links into usr, which come before what they point to
  [[ ! -L $folder ]] || mkdir -p "$clean/$(readlink "$folder")"
done
dpkg -L "${closure[@]}" | sed -n 's,^/,./,p' | sort -u | tar -C / --no-recursion --ignore-failed-read -cf - -T - 2>/dev/null |
  tar -C "$clean" -xpf -
dpkg-query -s "${closure[@]}" >"$database/status"
cp /var/lib/dpkg/info/format "$database/info/"
for package in "${closure[@]}"; do
  cp -p /var/lib/dpkg/info/"$package"{.*,:*} "$database/info/" 2>/dev/null || true
done
cp /etc/passwd /etc/group "$clean/etc/"
mkdir -p "$clean"/{proc,dev,tmp,var/lib/private}
mknod -m 666 "$clean/dev/null" c 1 3
mknod -m 666 "$clean/dev/urandom" c 1 9
ldconfig -r "$clean"
echo "a clean root of ${#closure[@]} packages"

# /proc is mounted for this one program only: nothing that is removed later can lie under a mount.
in_root() { # PROGRAM ARGUMENT...
  # shellcheck disable=SC2016  # the inner shell's
  exec unshare --mount bash -c 'mount --bind /proc "$1/proc" && exec chroot "$@"' - "$clean" "$@"
}
contents() {
  (cd "$clean" && find . \( -path ./var/lib/dpkg -o -path ./var/log -o -path ./var/cache/ldconfig \) -prune -o \
    ! -path ./etc/ld.so.cache -printf '%y %m %p %l\n' | sort)
}
as_dpkg() {
  DEBIAN_FRONTEND=noninteractive dpkg --root="$clean" "$@" >"$work/dpkg.log" 2>&1 || { cat "$work/dpkg.log"; fail "dpkg $1"; }
}

contents >"$work/before"
as_dpkg --install "$work"/packages/*.deb
[[ -L $clean/etc/systemd/system/multi-user.target.wants/collided.service ]] || fail "the service is not enabled"
dpkg-query --admindir="$database" -W -f '${Conffiles}' collided | grep -q /etc/collided/collided.toml || fail "no conffile"
unit=$clean/lib/systemd/system/collided.service
if command -v systemd-analyze >/dev/null; then
  mkdir -p "$work/verified"
  sed 's,^ExecStart=.*,ExecStart=/bin/true,' "$unit" >"$work/verified/collided.service"  # the program is in the clean root
  systemd-analyze verify --man=no "$work/verified/collided.service" || fail "systemd finds mistakes in the unit"
fi

# As the unit starts it: its line, its environment, the state folder as systemd makes it for a dynamic user.
read -ra start < <(sed -n 's/^ExecStart=//p' "$unit")
read -ra environment < <(sed -n 's/^Environment=//p' "$unit")
mkdir "$clean/var/lib/private/collided"
ln -s private/collided "$clean/var/lib/collided"
(in_root /usr/bin/env "${environment[@]}" COLLIDED_DOMAIN="$COLLIDED_DOMAIN" "${start[@]}") >"$work/server.out" 2>&1 &
server=$!
for ((i = 0; i < 400; ++i)); do
  grep -qs '^ready' "$work/server.out" && break
  sleep 0.05
done
answer=$(in_root /usr/bin/env COLLIDED_DOMAIN="$COLLIDED_DOMAIN" collide ray 0 0 5  0 0 -1 --fields answer,object) || {
  cat "$work/server.out"; fail "no answer"; }
[[ $answer == $'hit\twarehouse/shelf_3/top' ]] || fail "the packages' programs answer '$answer'"
answer=$(in_root /usr/bin/env COLLIDED_DOMAIN="$COLLIDED_DOMAIN" /usr/bin/python3 -c 'import collided
print(collided.connect().ray((0, 0, 5), (0, 0, -1)).hits[0].object)') || fail "Python has no client"
[[ $answer == warehouse/shelf_3/top ]] || fail "Python got '$answer'"
find "$clean/usr/lib/python3" -name __pycache__ -newer "$work/before" -prune -exec rm -r {} +
# The helpers run with the libraries that the packages ask for.
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >"$clean/tmp/one.obj"
(in_root /usr/bin/collide check /tmp/one.obj) | grep -q '1 triangle' || fail "collide does not find collided-files"
(in_root /usr/bin/collide view --help) | grep -q '^collide view - ' || fail "collide does not find collide-view"
for program in "$clean"/usr/libexec/collided/*; do
  missing=$( (in_root /usr/bin/ldd "${program#"$clean"}") | grep 'not found') && fail "$program: $missing"
done
kill -TERM "$server"
wait "$server" || fail "the server did not end in order"
server=
[[ -n $(ls "$clean/var/lib/private/collided") ]] || fail "no state was kept where the unit says"
rm "$clean/tmp/one.obj"
echo "installed, asked: $answer"

as_dpkg --remove collide collided python3-collided libcollided-dev libcollided2
[[ -e $clean/etc/collided/collided.toml && ! -e $clean/usr/bin/collided ]] ||
  fail "removing does not leave just the configuration"
as_dpkg --purge collide collided python3-collided libcollided-dev libcollided2
contents >"$work/after"
diff "$work/before" "$work/after" || fail "purging leaves the files above"
! dpkg-query --admindir="$database" -W 'collide*' 'libcollided*' 2>/dev/null | grep . || fail "dpkg still knows them"
echo "removed and purged: nothing is left"
