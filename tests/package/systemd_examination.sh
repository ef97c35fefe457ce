#!/usr/bin/env bash
# Run by systemd.sh as a service of the systemd that it boots.
exec >/examination/said/log 2>&1
set -euo pipefail
export HOME=/root LC_ALL=C.UTF-8 PATH=/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
ldconfig
leave() { systemctl exit 0 >/dev/null 2>&1 || true; }
trap leave EXIT
fail() { echo "FAILED: $*"; systemctl --no-pager status collided || true; exit 1; }
property() { systemctl show collided --property "$1" --value; }
hits() { collide ray "$@" 0 0 -1 >/examination/ray; }  # something is below; while it recovers, that is undecided
# Looks again for at most ten seconds.
comes() { for _ in $(seq 100); do "$@" && return; sleep 0.1; done; return 1; }

# Started means that it serves: the first question after it is answered.
systemctl start collided || fail "does not start"
hits 0 0 5 || fail "no answer right after the start"
[[ $(property ActiveState) == active ]] || fail "is $(property ActiveState)"
user=$(stat -c %u "/proc/$(property MainPID)")
((user != 0)) || fail "runs as root, not as a user of its own"
echo "serves as user $user"

# Read from the running unit, not from its file.
exposure=$(systemd-analyze security collided --no-pager | sed -n 's/.*Overall exposure level[^:]*: \([0-9.]*\).*/\1/p')
awk "BEGIN { exit !($exposure <= 1.5) }" || fail "exposure $exposure, allowed 1.5"
echo "exposure $exposure"

# Files of others' formats are read by converters, which limit themselves further below the unit's filters.
cat >/tmp/triangle.dae <<'END'
<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">50 50 1 52 50 1 50 52 1</float_array><technique_common><accessor source="#pa" count="3" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
END
collide load /tmp/triangle.dae >/examination/load 2>&1 && fail "the server sees this /tmp"
grep -q -- '--upload' /examination/load || fail "nobody says what helps: $(cat /examination/load)"
collide load --upload /tmp/triangle.dae || fail "a converter does not work under the unit"
hits 50.5 50.5 5 || fail "the converted triangle is missed: $(cat /examination/ray)"
echo "converters work"

# A crash: systemd starts it again, with what was acknowledged.
collide add crate box 1 1 1 --at 70 70 1
first=$(property MainPID)
kill -KILL "$first"
is_again() { [[ $(property ActiveState) == active && $(property MainPID) != "$first" ]]; }
comes is_again || fail "is not started again"
comes hits 70 70 5 || fail "what was acknowledged is gone: $(cat /examination/ray)"
comes hits 50.5 50.5 5 || fail "the loaded scene is gone: $(cat /examination/ray)"
[[ $(property NRestarts) == 1 ]] || fail "$(property NRestarts) restarts"
echo "started again with all that was acknowledged"

started=$(date +%s%N)
systemctl stop collided
took_ms=$((($(date +%s%N) - started) / 1000000))
[[ $(property Result) == success ]] || fail "stopped with $(property Result)"
((took_ms < 10000)) || fail "took $took_ms ms to stop"
echo "stopped in order in $took_ms ms"

# A mistake in the configuration is said and not tried again.
cp /usr/local/etc/collided/collided.toml /tmp/good.toml
printf '[server]\nthreads = "many"\n' >/usr/local/etc/collided/collided.toml
if systemctl start collided 2>/dev/null; then fail "starts with a mistake in its configuration"; fi
sleep 1
[[ $(property ActiveState) == failed && $(property ExecMainStatus) == 2 && $(property NRestarts) == 0 ]] ||
  fail "$(property ActiveState), exit $(property ExecMainStatus), $(property NRestarts) restarts"
cp /tmp/good.toml /usr/local/etc/collided/collided.toml
systemctl start collided || fail "does not start once the mistake is mended"
collide status >/dev/null || fail "no status"
echo "a mistake in the configuration keeps it down, until it is mended"
touch /examination/said/passed
