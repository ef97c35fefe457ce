#!/usr/bin/env python3
"""Writes the events of the public C++ headers for C and Python, and the C interface for Python.
generate.py BUILD_FOLDER INCLUDE_FOLDER

include/collided/events.h            C: the struct of a contact event
client/library/c/event_fields.hpp    C++: the fields of events in JSON, and a contact event as its C struct with borrowed texts
client/python/collided/_events.py    Python: the events as dataclasses, with the JSON names of their members
client/python/collided/_structs.py   Python: structs, functions and constants of the C interface for ctypes

In C a member's name ends with its unit, as in C++, and a time is in nanoseconds. In Python a length or speed has no unit, and the
two ends of an interval are one tuple."""
import collections
import keyword
import pathlib
import re
import sys
import textwrap

EVENTS = {"Event": "events.hpp", "StandingEvent": "standing.hpp"}
# The event that C also has as a struct, for reading many at once.
IN_BULK = "Event"
WIDTH = 120
NUMBERS = ("uint8_t", "int32_t", "int64_t", "uint32_t", "uint64_t", "size_t", "double", "float", "char")

Event = collections.namedtuple("Event", "name comment members")
Member = collections.namedtuple("Member", "type name default comment inner")
Inner = collections.namedtuple("Inner", "name members")


def wrapped(text, first, rest):
    return textwrap.wrap(text, WIDTH, initial_indent=first, subsequent_indent=rest, break_on_hyphens=False)


def snake(name):
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()


def uncommented(text):
    return re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)


# ---- what the C++ headers declare --------------------------------------------------------------------------------------


def bare(comment):
    return "\n".join(line.removeprefix("///").removeprefix(" ") for line in comment.splitlines())


def event_of(name, header):
    comment, body = re.search(rf"((?:^///[^\n]*\n)*)^struct {name} \{{\n(.*?)^\}};", header, re.MULTILINE | re.DOTALL).groups()
    structs = {inner: re.findall(r"^    double (\w+) = ", text, re.MULTILINE) for inner, text in
               re.findall(r"^  struct (\w+) \{\n(.*?)^  \};\n", body, re.MULTILINE | re.DOTALL)}
    return Event(name, bare(comment), list(members_of(name, re.sub(r"^  struct .*?^  \};\n", "", body, flags=re.MULTILINE | re.DOTALL), structs)))


def members_of(name, body, structs):
    comments = []
    for line in body.splitlines():
        comment = re.fullmatch(r"  ///? ?(.*)", line)
        member = re.fullmatch(r"  ([\w:]+(?:<[\w:<>, ]+>)?) (\w+(?:, \w+)*)(?: = ([^;]+)|\{.*\})?; *(?:// ?(.*))?", line)
        if comment:
            comments.append(comment[1])
        elif member:
            kind, inner = member[1].replace("std::", ""), None
            optional = re.fullmatch(r"optional<(\w+)>", kind)
            if optional and optional[1] in structs:
                kind, inner = "optional", Inner(optional[1], structs[optional[1]])
            text = " ".join([*comments, *filter(None, [member[4]])])
            for each in member[2].split(", "):
                yield Member(kind, each, member[3], text, inner)
            comments = []
        elif line:
            raise ValueError(f"{name} has a line that is not a member: {line}")


def codes_in(headers):
    """The enumerations of codes.hpp by their names in the headers."""
    return {name or code: code for name, code in re.findall(r"^using (?:(\w+) = )?codes::(\w+);", headers, re.MULTILINE)}


# ---- C -------------------------------------------------------------------------------------------------------------------


def c_members(member, codes):
    """Declarations of the C struct."""
    if member.type in codes:
        return [f"collided_{snake(codes[member.type])} {member.name}"]
    if member.type == "optional":
        return [f"int32_t has_{member.name}", *(f"double {member.name}_{part}" for part in member.inner.members)]
    return [{"bool": "int32_t {}", "string": "const char* {}", "Vec3": "double {}[3]", "chrono::nanoseconds": "int64_t {}_ns",
             "uint32_t": "uint32_t {}", "uint64_t": "uint64_t {}", "double": "double {}"}[member.type].format(member.name)]


def c_struct(event, codes):
    lines = [*wrapped(f"/* {event.comment} */", "", " * "), f"typedef struct collided_{snake(event.name)} {{", "  uint32_t size;"]
    for member in event.members:
        lines += wrapped(f"/* {member.comment} */", "  ", "   * ") if member.comment else []
        lines += [f"  {declared};" for declared in c_members(member, codes)]
    return "\n".join([*lines, f"}} collided_{snake(event.name)};"])


def events_h(events, codes, _):
    struct = next(c_struct(event, codes) for event in events if event.name == IN_BULK)
    return f"""/* Generated from the C++ headers by client/generate.py. */
#ifndef COLLIDED_EVENTS_H
#define COLLIDED_EVENTS_H

#include <collided/codes.h>
#include <stdint.h>

{struct}

#endif
"""


# ---- C++ -----------------------------------------------------------------------------------------------------------------


def lending(member, codes):
    name = member.name
    if member.type in codes:
        return [f"told.{name} = static_cast<std::int32_t>(event.{name});"]
    if member.type == "optional":
        parts = [f"if (event.{name}) told.{name}_{part} = event.{name}->{part};" for part in member.inner.members]
        return [f"told.has_{name} = event.{name} ? 1 : 0;", *parts]
    return [{"bool": "told.{0} = event.{0} ? 1 : 0;", "string": "told.{0} = event.{0}.c_str();", "Vec3": "put(event.{0}, told.{0});",
             "chrono::nanoseconds": "told.{0}_ns = event.{0}.count();"}.get(member.type, "told.{0} = event.{0};").format(name)]


def lent_function(event, codes):
    struct = f"collided_{snake(event.name)}"
    lines = [line for member in event.members for line in lending(member, codes)]
    return "\n  ".join([f"inline {struct} lent(const {event.name}& event) {{", f"{struct} told{{}};",
                        "told.size = sizeof told;", *lines, "return told;"]) + "\n}"


def described(struct, members):
    named = ", ".join(f"&T::{name}" for name in members)
    return "\n".join([f"constexpr auto fields_of(const {struct}*) {{", f"  using T = {struct};",
                      *wrapped(f"return fields<{named}>();", "  ", " " * 16), "}"])


def described_event(event):
    inner = [described(f"{event.name}::{member.inner.name}", member.inner.members) for member in event.members if member.inner]
    return "\n".join([*inner, described(event.name, [member.name for member in event.members])])


def event_fields_hpp(events, codes, _):
    fields = "\n".join(described_event(event) for event in events)
    functions = next(lent_function(event, codes) for event in events if event.name == IN_BULK)
    return f"""// Generated from the public headers by client/generate.py.
#pragma once

#include "client/library/c/values.hpp"
#include "idl/described_json.hpp"

namespace collided {{

{fields}

namespace c {{

{functions}

}}  // namespace c
}}  // namespace collided
"""


# ---- events in Python ----------------------------------------------------------------------------------------------------


def python_name(member):
    """Without the unit of a length, a speed or seconds; nanoseconds keep theirs."""
    name = re.sub(r"_(m|mps|s)$", "", member.name) + ("_ns" if "nanoseconds" in member.type else "")
    return name + "_" if keyword.iskeyword(name) else name


def name_in_json(member):
    return re.sub("_m$", "", member.name) + ("_ns" if "nanoseconds" in member.type else "")


def documented(comment, members):
    """A class's docstring: its description and that of its members."""
    def in_python(text):
        return re.sub(r"\b([a-z]\w*)_m(?:ps)?\b", r"\1", text.replace("::", ".").replace("0xffffffff", "None"))

    width = 6 + max(len(name) for name, _ in members)
    first, *listed = re.split(r"\n *(?=\S+(?:, \S+)*  )", in_python(comment))
    lines = wrapped(f'"""{first}', "    ", "    ")
    for term, said in (item.split("  ", 1) for item in listed):
        lines += wrapped(" ".join(said.split()), f"      {term}  ", "        ")
    lines.append("")
    for name, said in members:
        lines += wrapped(in_python(said), f"    {name:{width - 4}}", " " * width) or [f"    {name}"]
    return [*lines, '    """', ""]


def python_field(name, hint, metadata):
    return f"    {name}: {hint}" + (f" = field(metadata={{{', '.join(metadata)}}})" if metadata else "")


def python_members(event, codes):
    """name, annotation, metadata and comment of each member; an interval once."""
    for member in event.members:
        name, in_json, ends = python_name(member), name_in_json(member), []
        if member.name.endswith("_high_s"):
            continue
        if member.name.endswith("_low_s"):
            name, hint, in_json = name.removesuffix("_low"), "tuple[float, float]", ""
            ends = [member.name, member.name.replace("_low_", "_high_")]
        elif member.type in codes:
            hint = "str"
        elif member.inner:
            hint, ends = f"tuple[{', '.join(['float'] * len(member.inner.members))}] | None", member.inner.members
        elif member.default == "kNoTriangle":
            hint = "int | None"
        else:
            hint = {"bool": "bool", "string": "str", "double": "float", "Vec3": "tuple[float, float, float]"}.get(member.type, "int")
        metadata = [f'"json": "{in_json}"'] if in_json != name else []
        metadata += [f'"ends": {tuple(ends)}'.replace("'", '"')] if ends else []
        yield name, hint, metadata, member.comment


def events_py(events, codes, _):
    lines = ['"""Generated from the C++ headers by client/generate.py: the events of watches."""', "",
             "from __future__ import annotations", "", "from dataclasses import dataclass, field"]
    for event in events:
        members = list(python_members(event, codes))
        lines += ["", "", "@dataclass(frozen=True)", f"class {event.name}:",
                  *documented(event.comment, [(name, comment) for name, _, _, comment in members]),
                  *(python_field(name, hint, metadata) for name, hint, metadata, _ in members)]
    return "\n".join([*lines, ""])


# ---- the C interface in Python -------------------------------------------------------------------------------------------


def class_of(struct):
    return "C" + "".join(word.capitalize() for word in struct.split("_"))


def ctype_of(declared, structs):
    """name and ctypes type of a member, a parameter or a result ("int", "const char* name", "double point[3]")."""
    kind, stars, name, count = re.fullmatch(r"(?:const )?(\w+)((?: ?const)?[* ]*(?:const)?[* ]*?) ?(\w*)(?:\[(\d+)\])?", declared).groups()
    pointers = stars.count("*")
    struct = kind.removeprefix("collided_")
    if pointers and kind == "char" and "const" in declared:
        ctype = "c_char_p" if pointers == 1 else "POINTER(c_char_p)"
    elif pointers == 1 and kind.startswith("collided_") and struct in structs:
        ctype = f"POINTER({class_of(struct)})"
    elif pointers:
        ctype = "c_void_p"
    elif kind == "void":
        ctype = "None"
    else:
        ctype = "c_" + kind.removesuffix("_t") if kind in NUMBERS else "c_int32"  # a code or an int
        ctype = ctype.replace("c_size", "c_size_t")
    return name, f"{ctype} * {count}" if count else ctype


def structs_py(_, __, c_text):
    structs = dict(re.findall(r"typedef struct collided_(\w+) \{(.*?)\} collided_\w+;", c_text, re.DOTALL))
    lines = ['"""Generated from collided.h by client/generate.py: the C interface for ctypes."""', "", "from __future__ import annotations", "",
             "from ctypes import (", "    POINTER,", "    Structure,",
             *(f"    {name}," for name in ("c_char", "c_char_p", "c_double", "c_int32", "c_int64", "c_size_t", "c_uint32", "c_uint64", "c_void_p")),
             ")", "from typing import Any", ""]
    for name, value in re.findall(r"COLLIDED_(\w+) = (-?\d+)", c_text):
        lines.append(f"{name if name[0].isalpha() else '_' + name} = {value}")
    for struct, body in structs.items():
        lines += ["", "", f"class {class_of(struct)}(Structure):", "    _fields_ = ["]
        for declared in filter(None, (" ".join(part.split()) for part in body.split(";"))):
            name, ctype = ctype_of(declared, structs)
            lines.append(f'        ("{name}", {ctype}),')
        lines.append("    ]")
    lines += ["", "", "# Results and arguments of every function; without them ctypes would cut pointers to 32 bits.",
              "FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {"]
    for result, name, arguments in re.findall(r"^COLLIDED_API ([\w *]+?) ?collided_(\w+)\((.*?)\);", c_text, re.MULTILINE | re.DOTALL):
        given = [] if arguments == "void" else [ctype_of(" ".join(each.split()), structs)[1] for each in arguments.split(",")]
        lines.append(f'    "{name}": ({ctype_of(result, structs)[1]}, [{", ".join(given)}]),')
    return "\n".join([*lines, "}", ""])


OUTPUTS = {"include/collided/events.h": events_h, "client/library/c/event_fields.hpp": event_fields_hpp,
           "client/python/collided/_events.py": events_py, "client/python/collided/_structs.py": structs_py}


def write(path, text):
    # An unchanged file keeps its time, so that nothing is compiled again.
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def main(build, include):
    build, include = pathlib.Path(build), pathlib.Path(include)
    headers = {path.name: path.read_text(encoding="utf-8") for path in include.glob("collided/*.hpp")}
    codes = codes_in("\n".join(headers.values()))
    try:
        events = [event_of(name, headers[header]) for name, header in EVENTS.items()]
        c_text = uncommented(events_h(events, codes, "") + (include / "collided.h").read_text(encoding="utf-8"))
        for path, text_of in OUTPUTS.items():
            write(build / path, text_of(events, codes, c_text))
    except (ValueError, KeyError, AttributeError) as unfit:
        sys.exit(f"{include}: {unfit}")


if __name__ == "__main__":
    main(*sys.argv[1:])
