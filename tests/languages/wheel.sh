#!/usr/bin/env bash
# The wheel: the same bytes by pip as by the program itself, a record that holds, and a client that works from where it was
# unpacked. Without pip the program runs twice.
# usage: wheel.sh PYTHON SOURCE VERSION DOMAIN
set -euo pipefail
python=${1:?} source=${2:?} version=${3:?} domain=${4:?}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export SOURCE_DATE_EPOCH=1700000000
name=collided-$version-py3-none-any.whl
first=$("$python" "$source/client/python/wheel.py" "$scratch/one")
[[ $first == "$scratch/one/$name" ]]
if "$python" -m pip --version >/dev/null 2>&1; then
  "$python" -m pip --quiet --disable-pip-version-check --no-cache-dir wheel "$source/client/python" --no-build-isolation --no-deps \
    --wheel-dir "$scratch/two"
else
  "$python" "$source/client/python/wheel.py" "$scratch/two"
fi
cmp "$first" "$scratch/two/$name"
"$python" -m zipfile -e "$first" "$scratch/site"
"$python" - "$scratch/site" "collided-$version.dist-info" <<'CHECK'
import base64, csv, hashlib, pathlib, sys
site, info = pathlib.Path(sys.argv[1]), sys.argv[2]
rows = list(csv.reader(open(site / info / "RECORD")))
listed = {name for name, _, _ in rows}
there = {str(path.relative_to(site)) for path in site.rglob("*") if path.is_file()}
assert listed == there, listed ^ there
for name, digest, size in rows:
    if name.endswith("RECORD"):
        continue
    content = (site / name).read_bytes()
    assert len(content) == int(size), name
    assert digest == "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode(), name
assert {"collided/py.typed", "collided/_contract.py", "collided/_schema.py"} <= listed
CHECK
cd "$scratch"
said=$(PYTHONPATH=$scratch/site "$python" -c "
import collided
with collided.connect(domain=$domain) as c:
    print(collided.__file__.startswith('$scratch'), collided.__version__, c.ray((0, 0, 5), (0, 0, -1)).hits[0].distance)")
[[ $said == "True $version 3.8" ]] || { echo "it says: $said"; exit 1; }
