#!/usr/bin/env python3
"""Writes the declarations of the IDL files for every language.  generate.py BUILD_FOLDER IDL...

include/collided/codes.hpp           C++: an enumeration is an enum class of one octet, with the count of its codes and a
                                     name_of(), the word of a code in answers
include/collided/codes.h             C: the codes and constants of the C interface
idl/messages.hpp                     C++: the members of each message in order, and its sequences as vectors
client/python/collided/_contract.py  Python: an enumeration is a tuple of its words

In the IDL all enumerators of an enumeration begin with the same prefix, since IDL puts them into the module's scope; languages
other than C drop it."""
import collections
import pathlib
import re
import sys
import textwrap

WIDTH = 120
# Words in answers that differ from the code's word.
SPOKEN = {"none": "", "what_if": "what-if"}
CPP = {"octet": "std::uint8_t", "boolean": "bool", "double": "double", "long long": "std::int64_t",
       "unsigned long": "std::uint32_t", "unsigned long long": "std::uint64_t"}
SUFFIXES = {"unsigned long": "U", "unsigned long long": "U"}
# The enumerations of the C interface. For the first four, C also drops the prefix.
SHORT_IN_C = ("HitMode", "Importance", "InstantKind", "Verdict")
IN_C = (*SHORT_IN_C, "UndecidedReason", "EndReason", "Doubt", "ContactEventKind", "Containment")
CONSTANTS_IN_C = ("NO_TRIANGLE",)

Enumeration = collections.namedtuple("Enumeration", "name comment prefix words")
Constant = collections.namedtuple("Constant", "name comment kind value")


def wrapped(text, first, rest):
    return "\n".join(textwrap.wrap(text, WIDTH, initial_indent=first, subsequent_indent=rest, break_on_hyphens=False))


def spoken(comment):
    """The comment before a declaration, as one text."""
    return " ".join(line.strip().removeprefix("//").strip() for line in comment.splitlines())


def snake(name):
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()


def camel(name):
    return "k" + "".join(word.capitalize() for word in name.lower().split("_"))


def answered(words):
    """The words in answers."""
    return [SPOKEN.get(word, word) for word in words]


# ---- declarations -----------------------------------------------------------------------------------------------------


def enumerations(idl):
    for found in re.finditer(r"((?:^ *//[^\n]*\n)*)^ *enum (\w+) \{([^}]*)\};", idl, re.MULTILINE):
        prefixes, words = zip(*(word.split("_", 1) for word in re.findall(r"\w+", found[3])))
        yield Enumeration(found[2], spoken(found[1]), prefixes[0] + "_", [word.lower() for word in words])


def constants(idl):
    for found in re.finditer(r"((?:^ *//[^\n]*\n)*)^ *const ([\w ]+) (\w+) = (\d+);", idl, re.MULTILINE):
        yield Constant(found[3], spoken(found[1]), found[2], int(found[4]))


def messages(idl):
    """name, [(type, name, numbers of an array, comment)]; in the order of the file."""
    for found in re.finditer(r"^  @final struct (\w+) \{\n(.*?)^  \};", idl, re.MULTILINE | re.DOTALL):
        yield found[1], re.findall(r"^ *(?:@key )?([\w <>]+?) (\w+)(?:\[(\d+)\])?; *(?://(.*))?$", found[2], re.MULTILINE)


# ---- codes ------------------------------------------------------------------------------------------------------------


def enumeration_as_cpp(code):
    comment = code.comment
    for word in code.words:
        comment = re.sub(rf"\b{word.upper()}\b", word, comment)
    quoted = ", ".join(f'"{word}"' for word in answered(code.words))
    lines = [wrapped(comment, "/// ", "/// ")] if comment else []
    lines += [wrapped(f"enum class {code.name} : std::uint8_t {{ {', '.join(code.words)} }};", "", "    "),
              f"template <>\ninline constexpr std::uint8_t kCodeCount<{code.name}> = {len(code.words)};",
              f"constexpr std::string_view name_of({code.name} code) {{",
              wrapped(f"constexpr std::string_view kNames[] = {{{quoted}}};", "  ", "      "),
              f"  return is_known<{code.name}>(static_cast<std::uint8_t>(code)) ? kNames[static_cast<std::uint8_t>(code)] : \"\";",
              "}"]
    return "\n".join(lines)


def constant_as_cpp(constant):
    comment = wrapped(constant.comment, "/// ", "/// ") + "\n" if constant.comment else ""
    value = f"{constant.value}{SUFFIXES.get(constant.kind, '')}"
    return f"{comment}inline constexpr {CPP[constant.kind]} {camel(constant.name)} = {value};"


def codes_header(idl):
    body = "\n".join([*map(enumeration_as_cpp, enumerations(idl)), *map(constant_as_cpp, constants(idl))])
    if not body:
        raise ValueError("no enumerations")
    return f"""// Generated from IDL by generate.py.
#pragma once

#include <cstdint>
#include <string_view>

/// Codes of answers, events and messages. The enumerators are numbered from 0, as they are sent.
namespace collided::codes {{

/// How many codes an enumeration has. One that is not less is of a newer version.
template <class Code>
inline constexpr std::uint8_t kCodeCount = 0;
template <class Code>
constexpr bool is_known(std::uint8_t code) {{
  return code < kCodeCount<Code>;
}}

{body}

}}  // namespace collided::codes
"""


def enumeration_as_c(code):
    prefix = "" if code.name in SHORT_IN_C else code.prefix
    # No line break before the number.
    names = ", ".join(f"COLLIDED_{prefix}{word.upper()}\xa0=\xa0{number}" for number, word in enumerate(code.words))
    lines = [wrapped(f"/* {code.comment} */", "", " * ")] if code.comment else []
    lines += [f"typedef int32_t collided_{snake(code.name)};", wrapped(f"enum {{ {names} }};", "", "  ")]
    return "\n".join(lines).replace("\xa0", " ")


def constant_as_c(constant):
    comment = wrapped(f"/* {constant.comment} */", "", " * ") + "\n" if constant.comment else ""
    return f"{comment}#define COLLIDED_{constant.name} {constant.value}u"


def c_header(idl):
    codes = [code for code in enumerations(idl) if code.name in IN_C]
    numbers = [constant for constant in constants(idl) if constant.name in CONSTANTS_IN_C]
    body = "\n".join([*map(enumeration_as_c, codes), *map(constant_as_c, numbers)])
    return f"""/* Generated from IDL by generate.py. Codes of answers and events; those of a newer server or library may be greater. */
#ifndef COLLIDED_CODES_H
#define COLLIDED_CODES_H

#include <stdint.h>

{body}

#endif
"""


def python_module(idl):
    words = [f"{snake(code.name).upper()} = {tuple(answered(code.words))!r}" for code in enumerations(idl)]
    numbers = [f"{constant.name} = {constant.value}" for constant in constants(idl)]
    return "\n".join(['"""Generated from IDL by generate.py: the words of codes, by their numbers, and constants."""', "",
                      *words, *numbers, ""])


# ---- messages ---------------------------------------------------------------------------------------------------------


def width_of(comment):
    """The numbers per entry of a column; 0 for a column with another number of entries."""
    if "zero-terminated" in comment or ", once" in comment:
        return 0
    each = re.match(r" (\d) each", comment)
    return int(each[1]) if each else 1


def member_of(column, comment):
    """The member of a row that a column holds: "depths", in metres, has each row's depth_m."""
    one = re.sub(r"ies$", "y", column) if column.endswith("ies") else re.sub(r"(?<!_n)s$", "", column)
    unit = re.match(r" (m|s)\b(?!/)", comment)
    return f"{one}_{unit[1]}" if unit else one


def message_as_cpp(name, members):
    fields = " ".join(f"field(s.{member[1]});" for member in members)
    columns = [(re.fullmatch(r"sequence<([\w ]+)>", kind)[1], member, width_of(comment))
               for kind, member, _, comment in members if kind.startswith("sequence<")]
    lines = [f"template <SampleOf<{name}> S, class Field>", "void for_each_field(S& s, Field&& field) {",
             wrapped(fields, "  ", "  "), "}", f"struct {name}Columns {{", f"  using Message = {name};"]
    lines += [f"  std::vector<{CPP[kind]}> {member};" for kind, member, _ in columns]
    lines += ["  template <class Visit>", "  static constexpr void for_each(const Visit& visit) {"]
    lines += [f"    visit(&{name}::{member}, &{name}Columns::{member}, {width}U);" for _, member, width in columns]
    lines += ["  }", "};"]
    rows = [(member, member_of(member, comment)) for kind, member, _, comment in members
            if kind.startswith("sequence<") and width_of(comment)]
    lines += ["template <class Row>", f"void put_row({name}Columns& to, const Row& row) {{"]
    lines += [f"  if constexpr (requires {{ put(to.{column}, row.{one}); }}) put(to.{column}, row.{one});" for column, one in rows]
    lines += ["}", "template <class Row>", f"void take_row(const {name}& from, std::size_t i, Row& row) {{"]
    lines += [f"  if constexpr (requires {{ take(from.{column}, i, row.{one}); }}) take(from.{column}, i, row.{one});" for column, one in rows]
    return "\n".join([*lines, "}"])


def messages_header(idl):
    body = "\n\n".join(message_as_cpp(*each) for each in messages(idl))
    return f"""// Generated from collided.idl by generate.py.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "idl/dds.hpp"

namespace collided::wire {{

template <class Sample, class Wire>
concept SampleOf = std::same_as<std::remove_const_t<Sample>, Wire>;

template <class Member>
concept Number = std::is_arithmetic_v<Member> || std::is_enum_v<Member>;
/// -0 goes as 0.
template <class Value, Number Member>
void put(std::vector<Value>& column, Member value) {{
  if constexpr (std::is_floating_point_v<Member>) column.push_back(value + 0.0);
  else column.push_back(static_cast<Value>(value));
}}
void put(std::vector<double>& column, const auto& vector) requires requires {{ vector.x(); }} {{
  for (const double x : vector) put(column, x);
}}
template <class Sequence, class Member>
void take(const Sequence& column, std::size_t row, Member& to) requires(Number<Member> || requires {{ to.x(); }}) {{
  if constexpr (Number<Member>) to = static_cast<Member>(column._buffer[row]);
  else to = Member(column._buffer[3 * row], column._buffer[3 * row + 1], column._buffer[3 * row + 2]);
}}

// Of each message:
// for_each_field(sample, field)  calls field() with every member in the order of the IDL: numbers, bool, char[N], double[N],
//                                sequences of numbers
// ...Columns                     its sequences as vectors; for_each(visit) calls visit(sequence, vector, numbers an entry)
//                                with the members' pointers. 0 numbers: the column has entries of its own
// put_row(columns, row)          adds those members of a struct that are named as one entry of a column with an entry for
//                                each row: depth_m to depths, which are in metres
// take_row(message, i, row)      the same the other way

{body}

}}  // namespace collided::wire
"""


OUTPUTS = {"include/collided/codes.hpp": codes_header, "include/collided/codes.h": c_header,
           "idl/messages.hpp": messages_header, "client/python/collided/_contract.py": python_module}


def write(path, text):
    # An unchanged file keeps its time, so that nothing is compiled again.
    output = pathlib.Path(path)
    if not output.exists() or output.read_text(encoding="utf-8") != text:
        output.parent.mkdir(parents=True, exist_ok=True)
        output.write_text(text, encoding="utf-8")


def main(build, *idl_paths):
    idl = "\n".join(pathlib.Path(path).read_text(encoding="utf-8") for path in idl_paths)
    try:
        for path, text_of in OUTPUTS.items():
            write(pathlib.Path(build) / path, text_of(idl))
    except (ValueError, KeyError) as unfit:
        sys.exit(f"{' '.join(map(str, idl_paths))}: {unfit}")


if __name__ == "__main__":
    main(*sys.argv[1:])
