#!/usr/bin/env bash
# Runs the installed unit under a systemd of its own, in namespaces of its own on a root that is thrown away: ready is
# said, its user and its protections are what the unit says, a crash loses nothing, a mistake does not start it again and
# again, converters work below its filters.
# usage: systemd.sh BUILD
# Exit 77: this machine has no systemd, or does not let namespaces be made.
set -euo pipefail
build=$(readlink -f "${1:?build folder}")
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
systemd=/lib/systemd/systemd
[[ -x $systemd ]] || { echo "skipped: no systemd here"; exit 77; }

if [[ -z ${COLLIDED_BOOT:-} ]]; then
  scratch=$(mktemp -d /var/tmp/collided-systemd.XXXXXX)  # not /tmp: the new root has its own there
  trap 'rm -rf "$scratch"' EXIT
  # In the same namespaces a mount may still be refused, as in most containers.
  unshare --mount --pid --fork --cgroup --uts --ipc --net sh -c "mount --make-rprivate / && mount -t tmpfs none '$scratch' &&
    mkdir '$scratch/up' '$scratch/work' '$scratch/root' '$scratch/cgroup' && mount -t cgroup2 cgroup2 '$scratch/cgroup' &&
    mount -t overlay overlay -o 'lowerdir=/,upperdir=$scratch/up,workdir=$scratch/work' '$scratch/root'" 2>/dev/null ||
    { echo "skipped: no namespaces of one's own here"; exit 77; }
  mkdir "$scratch/said"
  status=0
  COLLIDED_BOOT=$scratch timeout 110 unshare --mount --pid --fork --cgroup --uts --ipc --net --kill-child \
    "${BASH_SOURCE[0]}" "$build" || status=$?
  cat "$scratch/said/log" 2>/dev/null || echo "systemd did not come up"
  [[ -e $scratch/said/passed ]] || exit $((status ? status : 1))
  exit 0
fi

# ---- in the namespaces: a root whose changes go to memory, with the installation and the examination in it
scratch=$COLLIDED_BOOT
mount --make-rprivate /
mkdir "$scratch/memory"
mount -t tmpfs none "$scratch/memory"
root=$scratch/memory/root
mkdir "$scratch/memory/up" "$scratch/memory/work" "$root"
mount -t overlay overlay -o "lowerdir=/,upperdir=$scratch/memory/up,workdir=$scratch/memory/work" "$root"
DESTDIR=$root cmake --install "$build" --prefix /usr/local >/dev/null
mkdir -p "$root/examination/said" "$root/etc/systemd/system"
cp "$here/systemd_examination.sh" "$root/examination/"
# What stands in the machine's own folders is another system's.
find "$root/etc/systemd/system" -mindepth 1 -delete
rm -rf "$root/var/lib/collided"
ln -s /usr/local/lib/systemd/system/collided.service "$root/etc/systemd/system/collided.service"
cat >"$root/etc/systemd/system/examination.service" <<'END'
[Unit]
DefaultDependencies=no
[Service]
Type=oneshot
ExecStart=/bin/bash /examination/systemd_examination.sh
END
cat >"$root/etc/systemd/system/examination.target" <<'END'
[Unit]
Wants=examination.service
AllowIsolate=yes
END
mount -t proc proc "$root/proc"
mount -t sysfs -o ro sysfs "$root/sys"
mount -t cgroup2 cgroup2 "$root/sys/fs/cgroup"
mount --rbind /dev "$root/dev"
mount -t tmpfs none "$root/run"
mount -t tmpfs none "$root/tmp"
mount --bind "$scratch/said" "$root/examination/said"
ip link set lo up
cd "$root"
mkdir old
pivot_root . old
umount -l old
exec env -i container=collided-test PATH=/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
  "$systemd" --system --unit=examination.target --log-target=null --show-status=no
