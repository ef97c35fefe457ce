#!/usr/bin/env bash
# deploy/bench --against must call a row slower or faster only beyond the spread of both runs, find its row whatever
# stands in its name, and fail where there is nothing to compare.
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
head='scene,size,work,method,ns,ns_low,ns_high,ratio,bytes_each,equal,of,note'
cat >"$folder/before.csv" <<ROWS
$head
city,10,"poses, 1 a flush","collided",100,90,110,2.0,0,0,0,""
city,10,"rays","collided",100,90,110,2.0,0,0,0,""
city,10,"spheres","collided",100,90,110,2.0,0,0,0,""
city,10,"gone","collided",100,90,110,2.0,0,0,0,""
ROWS
cat >"$folder/now.csv" <<ROWS
$head
city,10,"poses, 1 a flush","collided",50,45,55,4.0,0,0,0,""
city,10,"rays","collided",109,105,130,1.8,0,0,0,""
city,10,"spheres","collided",200,111,210,1.0,0,0,0,""
city,10,"born","collided",1,1,1,1,0,0,0,""
ROWS
said=$(awk -f "$here/fields.awk" -f "$here/against.awk" "$folder/before.csv" "$folder/now.csv")
expect() { grep -qE -- "$1" <<<"$said" || { echo "missing: $1"; echo "$said"; exit 1; }; }
expect '^city +10 poses, 1 a flush +collided +100\.0 +50\.0 +0\.50 +2\.00 -> +4\.00  faster$'
expect '^city +10 rays .* 1\.09 +2\.00 -> +1\.80$'
expect '^city +10 spheres .* 2\.00 +2\.00 -> +1\.00  slower$'
expect '^3 rows compared: 1 slower, 1 faster, .*; 1 new, 1 not run now$'
if awk -f "$here/fields.awk" -f "$here/against.awk" "$folder/before.csv" <(echo "$head") >/dev/null; then echo "nothing compared passed"; exit 1; fi
if awk -f "$here/fields.awk" -f "$here/against.awk" <(echo nonsense) "$folder/now.csv" >/dev/null 2>&1; then echo "nonsense passed"; exit 1; fi
summed=$(awk -v machine=m -v commit=c -v form=quick -f "$here/fields.awk" -f "$here/summary.awk" "$folder/before.csv" "$folder/now.csv")
[[ $(sed -n 2p <<<"$summed") == 'm,c,quick,"rays",2,104.4,1.9' ]] || { echo "the means are wrong:"; echo "$summed"; exit 1; }
