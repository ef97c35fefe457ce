#!/usr/bin/env python3
"""Writes the enumerations of collided.idl as C++.  generate.py IDL OUTPUT

Each becomes an enum class of one octet in namespace collided::codes, with its comment, and a name_of(): the word that answers
use for it. In the IDL all enumerators of an enumeration begin with one word of their own, since IDL puts
them into the module's scope; in C++ that word is dropped."""
import pathlib
import re
import sys
import textwrap

WIDTH = 120
# Where the word of answers is not that of the code.
SPOKEN = {"none": "", "what_if": "what-if"}


def enumerations(idl):
    """name, comment, words; in the order of the file."""
    for found in re.finditer(r"((?:^ *//[^\n]*\n)*)^ *enum (\w+) \{([^}]*)\};", idl, re.MULTILINE):
        words = [enumerator.split("_", 1)[1].lower() for enumerator in re.findall(r"\w+", found[3])]
        comment = " ".join(line.strip().removeprefix("//").strip() for line in found[1].splitlines())
        for word in words:
            comment = re.sub(rf"\b{word.upper()}\b", word, comment)
        yield found[2], comment, words


def wrapped(text, first, rest):
    return "\n".join(textwrap.wrap(text, WIDTH, initial_indent=first, subsequent_indent=rest, break_on_hyphens=False))


def as_cpp(name, comment, words):
    values = ", ".join(words)
    quoted = ", ".join(f'"{SPOKEN.get(word, word)}"' for word in words)
    lines = [wrapped(comment, "/// ", "/// ")] if comment else []
    lines += [wrapped(f"enum class {name} : std::uint8_t {{ {values} }};", "", "    "),
              f"constexpr std::string_view name_of({name} code) {{",
              wrapped(f"constexpr std::string_view kNames[] = {{{quoted}}};", "  ", "      "),
              f"  return static_cast<std::uint8_t>(code) < {len(words)} ? kNames[static_cast<std::uint8_t>(code)] : \"\";",
              "}"]
    return "\n".join(lines)


def main(idl_path, output_path):
    with open(idl_path, encoding="utf-8") as file:
        found = list(enumerations(file.read()))
    if not found:
        sys.exit(f"{idl_path}: no enumerations")
    body = "\n".join(as_cpp(*each) for each in found)
    text = ("// Generated from collided.idl by generate.py.\n#pragma once\n\n#include <cstdint>\n#include <string_view>\n\n"
            "/// Codes of answers, events and messages. The enumerators are numbered from 0, as they are sent.\n"
            f"namespace collided::codes {{\n\n{body}\n\n}}  // namespace collided::codes\n")
    # Unchanged, it keeps its time, and nothing is compiled again.
    output = pathlib.Path(output_path)
    if not output.exists() or output.read_text(encoding="utf-8") != text:
        output.parent.mkdir(parents=True, exist_ok=True)
        output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
