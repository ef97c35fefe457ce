#!/usr/bin/env python3
"""The flags that topics.hpp sends are those that the comments of collided.idl list: a client of another language is written
by the IDL file alone. Its enumerations are generated from there.  codes.py SOURCES"""
import pathlib
import re
import sys

idl_folder = pathlib.Path(sys.argv[1]) / "idl"
header = (idl_folder / "topics.hpp").read_text()
idl = (idl_folder / "collided.idl").read_text()
FLAGS = {"PoseFlags": "octet flags;", "HitFlags": "sequence<octet> hit_flags;"}

faults = []
for kind, member in FLAGS.items():
    comment = re.search(r"((?: *//[^\n]*\n)+) *" + re.escape(member), idl)[1]
    codes = re.search(rf"enum {kind} : std::uint8_t \{{([^}}]*)\}}", header)[1]
    faults += [f"{kind}: {name} = {value} is not in the comment on '{member}'"
               for name, value in re.findall(r"(\w+) = (\d+)", codes) if not re.search(rf"\b{value} ", comment)]
print("\n".join(faults) or f"{len(FLAGS)} sets of flags agree")
sys.exit(1 if faults else 0)
