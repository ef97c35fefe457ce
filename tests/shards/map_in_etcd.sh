#!/usr/bin/env bash
# The guide's commands of a shard map in etcd: published, asked by, planned and split there. map_in_etcd.sh COLLIDE COLLIDED [tls]
# tls: the same with certificates and a user, and the etcd is the servers' authority, too.
# Exits 77 where etcd, or openssl, is not installed.
set -euo pipefail
collide=$1 collided=$2 how=${3:-plain}
[[ -x /usr/bin/etcd && ($how == plain || -x /usr/bin/openssl) ]] || exit 77
folder=$(mktemp -d)
declare -A pids
end() { for process in "${pids[@]}"; do kill "$process" 2>/dev/null || true; done; wait 2>/dev/null || true; rm -rf "$folder"; }
trap end EXIT
fail() { echo "map in etcd: $*" >&2; cat "$folder"/*.err >&2; exit 1; }
space=dock_$$
cd "$folder"
cat >halves.json <<'MAP'
{"margin_m": 2, "shards": [{"name": "west", "low": [null, null, null], "high": [0, null, null]},
                           {"name": "east", "low": [0, null, null], "high": [null, null, null]}]}
MAP
read -r port peer < <(python3 -c '
import socket
sockets = [socket.socket() for _ in range(2)]
for one in sockets: one.bind(("127.0.0.1", 0))
print(*(one.getsockname()[1] for one in sockets))')
url=http://127.0.0.1:$port scheme=etcd
tls=()
if [[ $how == tls ]]; then
  url=https://127.0.0.1:$port scheme=etcds
  mkdir keys
  make_key() { openssl req "$@" -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -subj /O=collided 2>>openssl.txt; }
  make_key -x509 -keyout ca.key -out keys/ca.crt
  make_key -keyout keys/tls.key -out tls.csr
  openssl x509 -req -in tls.csr -CA keys/ca.crt -CAkey ca.key -CAcreateserial -out keys/tls.crt 2>>openssl.txt \
    -extfile <(printf 'subjectAltName=IP:127.0.0.1\nextendedKeyUsage=serverAuth,clientAuth\n')
  tls=(--cert-file keys/tls.crt --key-file keys/tls.key --trusted-ca-file keys/ca.crt --client-cert-auth)
fi
/usr/bin/etcd "${tls[@]}" --data-dir etcd --listen-client-urls "$url" --advertise-client-urls "$url" --listen-peer-urls "http://127.0.0.1:$peer" \
  --initial-advertise-peer-urls "http://127.0.0.1:$peer" --initial-cluster "default=http://127.0.0.1:$peer" >etcd.log 2>etcd.err &
pids[etcd]=$!
map=$scheme://127.0.0.1:$port/yard
if [[ $how == tls ]]; then
  python3 - "$url" <<'USERS'
import json, ssl, sys, time, urllib.request
context = ssl.create_default_context(cafile="keys/ca.crt")
context.load_cert_chain("keys/tls.crt", "keys/tls.key")
def post(path, **question):
    body = json.dumps(question).encode()
    return urllib.request.urlopen(f"{sys.argv[1]}/v3/auth/{path}", body, context=context, timeout=5).read()
until = time.monotonic() + 30
while True:  # it may still start
    try: post("user/add", name="root", password="a secret"); break
    except OSError:
        if time.monotonic() > until: raise
        time.sleep(0.1)
post("user/grant", user="root", role="root")
post("enable")
USERS
  code=0; "$collide" fleet publish --shards halves.json --to "$map" 2>refused.txt || code=$?
  [[ $code -eq 2 ]] && grep -q "127.0.0.1:$port: its certificate is not accepted" refused.txt || fail "exit code $code: $(cat refused.txt)"
  echo root >keys/username
  echo "no secret" >keys/password
  export COLLIDED_ETCD_KEYS=$folder/keys COLLIDED_AUTHORITY=$scheme://127.0.0.1:$port
  code=0; "$collide" fleet publish --shards halves.json --to "$map" 2>refused.txt || code=$?
  [[ $code -eq 2 ]] && grep -q "127.0.0.1:$port: user 'root' is refused with the password in $folder/keys. No map was read" refused.txt ||
    fail "exit code $code: $(cat refused.txt)"
  echo "a secret" >keys/password
fi
revision=$("$collide" fleet publish --shards halves.json --to "$map" --wait 30s --fields revision) || fail "the map is not published"

# What is there stays, unless its revision is named.
sed 's/"margin_m": 2/"margin_m": 3/' halves.json >wider.json
code=0; "$collide" fleet publish --shards wider.json --to "$map" 2>refused.txt || code=$?
[[ $code -eq 5 ]] && grep -q "another map is there, revision $revision$" refused.txt || fail "exit code $code: $(cat refused.txt)"
"$collide" fleet publish --shards halves.json --to "$map" --fields revision | grep -qx "$revision" || fail "the same map is another one"
newer=$("$collide" fleet publish --shards wider.json --to "$map" --revision "$revision" --fields revision)
((newer > revision)) || fail "revision $newer after $revision"
"$collide" fleet publish --shards halves.json --to "$map" --revision "$newer" -q >/dev/null

serve() { # SHARD
  "$collided" --state-dir "$folder/$1" --namespace "$space" --shard "$map:$1" --log error >/dev/null 2>"$folder/$1.err" &
  pids[$1]=$!
  "$collide" status --namespace "$space/shard_$1" --wait 30s -q >/dev/null || fail "no server of $1"
}
ask() { "$collide" ray -20 0.3 0.5  1 0 0 --all --namespace "$space" --shards "$map" --fields object,distance; }
for shard in west east; do serve "$shard"; done
ask >before.txt
[[ $(wc -l <before.txt) -eq 9 ]] || fail "the ray met $(cat before.txt)"
for i in 1 2; do # a newer proposal takes the older one's place
  "$collide" fleet plan --namespace "$space" --shards "$map" --split east --by objects --into "$((4 - i))" -o "$map/next" -q >plan.txt ||
    fail "no plan"
done
for shard in east_1 east_2; do serve "$shard"; done
[[ $("$collide" fleet split --namespace "$space" --shards "$map" --fields shard,into -q) == $'east\t["east_1","east_2"]' ]] || fail "no split"
[[ $("$collide" fleet --namespace "$space" --shards "$map" --fields shard | xargs) == "west east_1 east_2" ]] || fail "the map is the old one"
ask | diff before.txt - || fail "another answer after the split"
echo "published, asked and split in etcd"
