#!/usr/bin/env python3
"""Writes what collided.idl declares as C++.  generate.py IDL CODES_HPP MESSAGES_HPP

CODES_HPP, of the public library: enumerations as enum classes of one octet, each with a name_of(), the word that answers use
for a code; and the constants. In the IDL all enumerators of an enumeration begin with one word of their own, since IDL puts
them into the module's scope; in C++ that word is dropped.
MESSAGES_HPP: the members of each message in their order, and its sequences as vectors."""
import pathlib
import re
import sys
import textwrap

WIDTH = 120
# Where the word of answers is not that of the code.
SPOKEN = {"none": "", "what_if": "what-if"}
NUMBERS = {"octet": "std::uint8_t", "boolean": "bool", "double": "double", "long long": "std::int64_t",
           "unsigned long": "std::uint32_t", "unsigned long long": "std::uint64_t"}


def wrapped(text, first, rest):
    return "\n".join(textwrap.wrap(text, WIDTH, initial_indent=first, subsequent_indent=rest, break_on_hyphens=False))


def spoken(comment):
    """The comment before a declaration, as one text."""
    return " ".join(line.strip().removeprefix("//").strip() for line in comment.splitlines())


# ---- codes ------------------------------------------------------------------------------------------------------------


def enumerations(idl):
    """name, comment, words; in the order of the file."""
    for found in re.finditer(r"((?:^ *//[^\n]*\n)*)^ *enum (\w+) \{([^}]*)\};", idl, re.MULTILINE):
        words = [enumerator.split("_", 1)[1].lower() for enumerator in re.findall(r"\w+", found[3])]
        comment = spoken(found[1])
        for word in words:
            comment = re.sub(rf"\b{word.upper()}\b", word, comment)
        yield found[2], comment, words


def enumeration_as_cpp(name, comment, words):
    values = ", ".join(words)
    quoted = ", ".join(f'"{SPOKEN.get(word, word)}"' for word in words)
    lines = [wrapped(comment, "/// ", "/// ")] if comment else []
    lines += [wrapped(f"enum class {name} : std::uint8_t {{ {values} }};", "", "    "),
              f"constexpr std::string_view name_of({name} code) {{",
              wrapped(f"constexpr std::string_view kNames[] = {{{quoted}}};", "  ", "      "),
              f"  return static_cast<std::uint8_t>(code) < {len(words)} ? kNames[static_cast<std::uint8_t>(code)] : \"\";",
              "}"]
    return "\n".join(lines)


def constants_as_cpp(idl):
    for found in re.finditer(r"((?:^ *//[^\n]*\n)*)^ *const ([\w ]+) (\w+) = (\d+);", idl, re.MULTILINE):
        if found[1]:
            yield wrapped(spoken(found[1]), "/// ", "/// ")
        name = "k" + "".join(word.capitalize() for word in found[3].lower().split("_"))
        yield f"inline constexpr {NUMBERS[found[2]]} {name} = {found[4]};"


def codes_header(idl):
    parts = [enumeration_as_cpp(*each) for each in enumerations(idl)] + list(constants_as_cpp(idl))
    if not parts:
        raise ValueError("no enumerations")
    body = "\n".join(parts)
    return f"""// Generated from collided.idl by generate.py.
#pragma once

#include <cstdint>
#include <string_view>

/// Codes of answers, events and messages. The enumerators are numbered from 0, as they are sent.
namespace collided::codes {{

{body}

}}  // namespace collided::codes
"""


# ---- messages ---------------------------------------------------------------------------------------------------------


def messages(idl):
    """name, [(type, name, comment)]; in the order of the file."""
    for found in re.finditer(r"^  @final struct (\w+) \{\n(.*?)^  \};", idl, re.MULTILINE | re.DOTALL):
        members = re.findall(r"^ *(?:@key )?([\w <>]+?) (\w+)(?:\[\d+\])?; *(?://(.*))?$", found[2], re.MULTILINE)
        yield found[1], members


def width_of(comment):
    """Of a column: how many numbers an entry has; 0 for what does not have as many entries as the others."""
    if "zero-terminated" in comment or ", once" in comment:
        return 0
    each = re.match(r" (\d) each", comment)
    return int(each[1]) if each else 1


def message_as_cpp(name, members):
    fields = " ".join(f"field(s.{member[1]});" for member in members)
    columns = [(re.fullmatch(r"sequence<([\w ]+)>", kind)[1], member, width_of(comment))
               for kind, member, comment in members if kind.startswith("sequence<")]
    lines = [f"template <SampleOf<{name}> S, class Field>", "void for_each_field(S& s, Field&& field) {",
             wrapped(fields, "  ", "  "), "}", f"struct {name}Columns {{", f"  using Message = {name};"]
    lines += [f"  std::vector<{NUMBERS[kind]}> {member};" for kind, member, _ in columns]
    lines += ["  template <class Visit>", "  static constexpr void for_each(const Visit& visit) {"]
    lines += [f"    visit(&{name}::{member}, &{name}Columns::{member}, {width}U);" for _, member, width in columns]
    lines += ["  }", "};"]
    return "\n".join(lines)


def messages_header(idl):
    body = "\n\n".join(message_as_cpp(*each) for each in messages(idl))
    return f"""// Generated from collided.idl by generate.py.
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "idl/dds.hpp"

namespace collided::wire {{

template <class Sample, class Wire>
concept SampleOf = std::same_as<std::remove_const_t<Sample>, Wire>;

// Of each message:
// for_each_field(sample, field)  calls field() with every member in the order of the IDL: numbers, bool, char[N], double[N],
//                                sequences of numbers
// ...Columns                     its sequences as vectors; for_each(visit) calls visit(sequence, vector, numbers an entry)
//                                with the members' pointers. 0 numbers: the column has entries of its own

{body}

}}  // namespace collided::wire
"""


def write(path, text):
    # Unchanged, it keeps its time, and nothing is compiled again.
    output = pathlib.Path(path)
    if not output.exists() or output.read_text(encoding="utf-8") != text:
        output.parent.mkdir(parents=True, exist_ok=True)
        output.write_text(text, encoding="utf-8")


def main(idl_path, codes_path, messages_path):
    idl = pathlib.Path(idl_path).read_text(encoding="utf-8")
    try:
        write(codes_path, codes_header(idl))
        write(messages_path, messages_header(idl))
    except (ValueError, KeyError) as unfit:
        sys.exit(f"{idl_path}: {unfit}")


if __name__ == "__main__":
    main(*sys.argv[1:])
