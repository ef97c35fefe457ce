#!/usr/bin/env python3
"""Packs the Python client as a wheel: `pip wheel client/python --no-deps`, or this program. Two wheels of the same sources
are equal in every byte.

usage: wheel.py FOLDER

The wheel contains only Python; the client library, libcollided_client.so.2, has its own package. Modules generated from the
headers are made from the sources around this file, so no build tree is needed.
"""

import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import zipfile
from typing import Any

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
GENERATORS = (
    ("idl/generate.py", "idl/collided.idl", "idl/client_codes.idl"),
    ("client/generate.py", "client/include"),
    ("client/generate_answers.py", "."),
)


def modules() -> dict[str, bytes]:
    """The package's files by their names in the wheel."""
    with tempfile.TemporaryDirectory() as build:
        for generator, *sources in GENERATORS:
            command = [sys.executable, "-B", str(ROOT / generator), build, *(str(ROOT / source) for source in sources)]
            subprocess.run(command, check=True)
        generated = pathlib.Path(build).glob("client/python/collided/*.py")
        paths = [*HERE.glob("collided/*.py"), HERE / "collided/py.typed", *generated]
        return {f"collided/{path.name}": path.read_bytes() for path in sorted(paths, key=lambda path: path.name)}


def line(name: str, content: bytes) -> str:
    """The entry of a file in the wheel's record."""
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}\n"


def build_wheel(wheel_directory: str, config_settings: Any = None, metadata_directory: Any = None) -> str:
    """Writes the wheel and returns its name, as pip calls it (PEP 517)."""
    found = re.search(r"^project\(Collided VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"), re.MULTILINE)
    if found is None:
        raise ValueError(f"{ROOT / 'CMakeLists.txt'}: no version of the project")
    version = found[1]
    info = f"collided-{version}.dist-info"
    files = modules()
    files[f"{info}/METADATA"] = (
        f"Metadata-Version: 2.1\nName: collided\nVersion: {version}\n"
        "Summary: Client of the collision query service Collided\nRequires-Python: >=3.10\nProvides-Extra: arrays\n"
        'Requires-Dist: numpy ; extra == "arrays"\n'
    ).encode()
    files[f"{info}/WHEEL"] = b"Wheel-Version: 1.0\nGenerator: collided\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
    record = "".join(line(name, content) for name, content in files.items()) + f"{info}/RECORD,,\n"
    files[f"{info}/RECORD"] = record.encode()
    # Zip has no times before 1980.
    when = time.gmtime(max(int(os.environ.get("SOURCE_DATE_EPOCH", "315532800")), 315532800))[:6]
    path = pathlib.Path(wheel_directory) / f"collided-{version}-py3-none-any.whl"
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, when)
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(entry, content)
    return path.name


if __name__ == "__main__":
    print(pathlib.Path(sys.argv[1]) / build_wheel(sys.argv[1]))
