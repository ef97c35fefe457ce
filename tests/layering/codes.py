#!/usr/bin/env python3
"""The codes that topics.hpp sends are those that collided.idl lists, name by name and flag by flag: a client of another
language is written by the IDL file alone.  codes.py SOURCES"""
import pathlib
import re
import sys

idl_folder = pathlib.Path(sys.argv[1]) / "idl"
header = (idl_folder / "topics.hpp").read_text()
idl = (idl_folder / "collided.idl").read_text()

# Names that differ from those of the IDL.
CALLED = {"RequestKind": "QuestionKind", "signed_near": "signed"}
FLAGS = {"PoseFlags": "octet flags;", "HitFlags": "sequence<octet> hit_flags;"}
# Of one side alone: they never travel.
OWN = {"Reliability", "Durability", "QueryRight"}

faults = []
listed = {found[1]: [word.split("_", 1)[1].lower() for word in re.findall(r"\w+", found[2])]
          for found in re.finditer(r"enum (\w+) \{([^}]*)\}", idl)}
sent = {found[1]: re.findall(r"(\w+)(?: = (\d+))?", found[2])
        for found in re.finditer(r"enum (?:class )?(\w+) : std::uint8_t \{([^}]*)\}", header)}
for kind, codes in sent.items():
    if kind in OWN:
        continue
    if kind in FLAGS:
        comment = re.search(r"((?: *//[^\n]*\n)+) *" + re.escape(FLAGS[kind]), idl)[1]
        faults += [f"{kind}: {name} = {value} is not in the comment on '{FLAGS[kind]}'" for name, value in codes
                   if not re.search(rf"\b{value} ", comment)]
        continue
    names = [CALLED.get(name, name) for name, _ in codes]
    idl_names = listed.get(CALLED.get(kind, kind))
    if names != idl_names:
        faults.append(f"{kind}: topics.hpp has {names}, collided.idl {idl_names}")
if not listed or not sent:
    faults.append("no enumerations were found")
print("\n".join(faults) or f"{len(sent)} enumerations agree")
sys.exit(1 if faults else 0)
