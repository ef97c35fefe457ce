#!/usr/bin/env python3
"""Writes the answers declared in C++ as Python dataclasses.  generate_answers.py BUILD_FOLDER SOURCES

client/python/collided/_schema.py  a frozen dataclass for each described struct of a public header, and for those
                                   of the C interface

Members are named as generate.py names members of events. A different name in JSON is in the metadata; _described.py reads the
answers by these names."""
import collections
import pathlib
import re
import sys

from generate import bare, codes_in, documented, members_of, name_in_json, python_field, python_name, snake, write

HEADERS = ("idl/include/collided", "client/include/collided")
DESCRIPTIONS = ("idl/answers", "client/library/watching", "client/library/connection")
# Arguments, drawing data, and answers that the functions of Client reduce to one number.
LEFT_OUT = ("LoadOptions", "OutlinedStanding", "Added", "Moved", "Removed", "RuleChanged", "Attached")
# Passed through the C interface, with all their members.
BY_C = ("Hit", "VoxelScan")
PLAIN = {"bool": "bool", "string": "str", "double": "float", "Vec3": "Vector", "Pose": "Pose", "chrono::nanoseconds": "int",
         "uint32_t": "int", "uint64_t": "int", "size_t": "int", "Event": "Event", "StandingEvent": "StandingEvent"}

Struct = collections.namedtuple("Struct", "name comment base members aliases")


# ---- declarations and descriptions -------------------------------------------------------------------------------------


def structs_in(text, around=""):
    """The structs of a header and their nested structs, by their names in C++."""
    found = {}
    declared = re.compile(r"((?:^///?[^\n]*\n)*)^struct (\w+)(?: : (\w+))? \{\n(.*?)^\};\n", re.MULTILINE | re.DOTALL)
    for comment, name, base, body in declared.findall(text):
        inner = re.sub("^  ", "", body, flags=re.MULTILINE)
        found.update(structs_in(inner, name + "::"))
        own = re.sub(r"(?:^  ///?[^\n]*\n)*^  (?:struct|enum|using)\b[^\n]*(?:\{\n.*?^  \};|;)\n", "", body, flags=re.MULTILINE | re.DOTALL)
        aliases = dict(re.findall(r"^using (\w+) = (.*);", inner, re.MULTILINE))
        found[around + name] = Struct(around + name, bare(comment), base, re.sub(r"=\n +", "= ", own), aliases)
    return found


def described_in(text):
    """The JSON names of each struct's described members; None: their own names. JSON has times in seconds also in nanoseconds
    (client/library/c/client.cpp)."""
    found = {}
    for name, line, lines in re.findall(r"^constexpr auto fields_of\(const ([\w:]+)\*\) \{(?: ([^\n]*) \}|\n(.*?)^\})$", text,
                                        re.MULTILINE | re.DOTALL):
        named = {}
        for name_in_json, member, kind, members in re.findall(
                r'\bfield(?:_if<[^"]*?>)?\("(\w+)", &\w+::(\w+)|\b(fields|fields_if|unless_default|in_seconds)<([^()]*?)>\(', line or " ".join(lines.split())):
            if kind == "fields_if":
                members = members.partition(", ")[2]
            named.update({member: name_in_json} if member else dict.fromkeys(re.findall(r"::(\w+)", members)))
        found[name] = named
    return found


# ---- in Python ---------------------------------------------------------------------------------------------------------


def class_name(name):
    return name.replace("::", "")


class Types:
    """Python types for those of C++."""

    def __init__(self, structs, described, enumerations):
        self.structs, self.described, self.enumerations = structs, described, enumerations
        self.aliases = {name: meant.replace("std::", "") for struct in structs.values() for name, meant in struct.aliases.items()}

    def struct_of(self, declared, around):
        return next((name for name in (f"{around}::{declared}", declared) if name in self.described and name in self.structs), None)

    def annotation(self, declared, around):
        declared = self.aliases.get(declared.rpartition("::")[2], declared)
        generic = re.fullmatch(r"(vector|optional|pair|array)<(.*)>", declared)
        kind, inner = generic.groups() if generic else ("", "")
        if kind in ("vector", "optional"):
            return f"tuple[{self.annotation(inner, around)}, ...]" if kind == "vector" else f"{self.annotation(inner, around)} | None"
        if kind:
            first, _, last = inner.partition(", ")
            kinds = [first, last] if kind == "pair" else [first] * int(last)
            return f"tuple[{', '.join(self.annotation(each, around) for each in kinds)}]"
        if declared == "Verdict":
            return declared
        struct = self.struct_of(declared, around)
        if struct:
            return class_name(struct)
        return "str" if declared.rpartition("::")[2] in self.enumerations else PLAIN[declared]

    def needed(self, struct):
        """The structs that a struct contains."""
        words = [struct.base, *(word for member in struct.members for word in re.findall(r"[\w:]+", member.type))]
        return [found for word in words if word and (found := self.struct_of(word, struct.name))]


def fields_of(struct, types, codes, words):
    """name, annotation, metadata and comment of the members. A member that is itself a described answer, but not described as
    a member, is read from the same row."""
    for member in struct.members:
        if member.name in types.described[struct.name]:
            in_json = types.described[struct.name][member.name] or name_in_json(member)
        elif types.struct_of(member.type, struct.name):
            in_json = ""
        else:
            continue
        name = python_name(member)
        is_number = member.default in ("kNoTriangle", "0xffffffff") and name.endswith("triangle")
        hint = "int | None" if is_number else types.annotation(member.type, struct.name)
        metadata = [f'"json": "{in_json}"'] if in_json != name else []
        if member.type in words and member.type in codes:
            metadata.append(f'"words": dict(zip({words[member.type]}, {snake(codes[member.type]).upper()}))')
        yield name, hint, metadata, member.comment


def class_of(struct, fields):
    first = fields[0][1] if fields else ""
    bases = class_name(struct.base) if struct.base else "Judged" if first == "Verdict" or struct.name == "ExplainedPair" else ""
    lines = ["", "", "@dataclass(frozen=True)", f"class {class_name(struct.name)}{f'({bases})' if bases else ''}:"]
    lines += documented(struct.comment, [(name, comment) for name, _, _, comment in fields])
    for name, hint, metadata, _ in fields:
        lines.append(python_field(name, hint, metadata))
    return lines


def schema_py(structs, types, codes, words):
    made, lines = {}, []

    def make(name):
        if name in made:
            return
        made[name] = True
        for other in types.needed(structs[name]):
            make(other)
        lines.extend(class_of(structs[name], list(fields_of(structs[name], types, codes, words))))

    for name in types.described:
        if name in structs and name not in LEFT_OUT:
            make(name)
    names = sorted({snake(codes[kind]).upper() for kind in words if kind in codes})
    head = ['"""Generated from the C++ headers and idl/answers by client/generate_answers.py: answers of the server."""', "",
            "from dataclasses import dataclass, field", "", f"from ._contract import {', '.join(names)}",
            "from ._described import Judged, Verdict", "from ._events import Event, StandingEvent", "", "Vector = tuple[float, float, float]",
            "Pose = tuple[float, float, float, float, float, float, float]", "",
            "__all__ = ["] + [f'    "{name}",' for name in sorted(map(class_name, made))] + ["]"]
    return "\n".join([*head, *lines, ""])


def main(build, sources):
    sources = pathlib.Path(sources)
    headers = [path.read_text(encoding="utf-8") for folder in HEADERS for path in sorted((sources / folder).glob("*.hpp"))]
    descriptions = "\n".join(path.read_text(encoding="utf-8") for folder in DESCRIPTIONS for path in sorted((sources / folder).glob("*.?pp")))
    structs = {}
    for header in headers:
        structs.update(structs_in(header))
    described = described_in(descriptions) | dict.fromkeys(BY_C, {})
    try:
        structs = {name: structs[name]._replace(members=list(members_of(name, structs[name].members, {})))
                   for name in described if name in structs}
        described |= {name: {member.name: None for member in structs[name].members} for name in BY_C}
        words = {kind: f"({listed})" for kind, listed in
                 re.findall(r"kWordsOf<([\w:]+)>\[\] = \{([^}]*)\}", " ".join(descriptions.split()))}
        codes = codes_in("\n".join(headers))
        enumerations = {*codes, *re.findall(r"enum class (\w+)", "\n".join(headers))}
        text = schema_py(structs, Types(structs, described, enumerations), codes, words)
    except (ValueError, KeyError, AttributeError) as unfit:
        sys.exit(f"{sources}: {unfit}")
    write(pathlib.Path(build) / "client/python/collided/_schema.py", text)


if __name__ == "__main__":
    main(*sys.argv[1:])
