#!/usr/bin/env python3
"""Packs the Python client as a wheel, for pip. Two packings of one state are equal in every byte.

usage: wheel.py VERSION FOLDER

To be run as BUILD/client/python/wheel.py, where the generated modules are. The wheel has Python only: the client library,
libcollided_client.so.1, comes from its own package.
"""

import base64
import hashlib
import os
import pathlib
import sys
import time
import zipfile

version, folder = sys.argv[1], pathlib.Path(sys.argv[2])
source = pathlib.Path(__file__).parent
info = f"collided-{version}.dist-info"
files = {str(path.relative_to(source)): path.read_bytes() for path in sorted(source.glob("collided/*")) if path.is_file()}
files[f"{info}/METADATA"] = (
    f"Metadata-Version: 2.1\nName: collided\nVersion: {version}\n"
    "Summary: Client of the collision query service Collided\nRequires-Python: >=3.10\nProvides-Extra: arrays\n"
    'Requires-Dist: numpy ; extra == "arrays"\n'
).encode()
files[f"{info}/WHEEL"] = b"Wheel-Version: 1.0\nGenerator: collided\nRoot-Is-Purelib: true\nTag: py3-none-any\n"


def line(name: str, content: bytes) -> str:
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}\n"


record = "".join(line(name, content) for name, content in files.items()) + f"{info}/RECORD,,\n"
files[f"{info}/RECORD"] = record.encode()
# Zip knows no time before 1980.
when = time.gmtime(max(int(os.environ.get("SOURCE_DATE_EPOCH", "315532800")), 315532800))[:6]
folder.mkdir(parents=True, exist_ok=True)
path = folder / f"collided-{version}-py3-none-any.whl"
with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as wheel:
    for name, content in files.items():
        entry = zipfile.ZipInfo(name, when)
        entry.external_attr = 0o644 << 16
        entry.compress_type = zipfile.ZIP_DEFLATED
        wheel.writestr(entry, content)
print(path)
