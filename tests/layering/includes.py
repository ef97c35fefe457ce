#!/usr/bin/env python3
"""Fails on a file that uses a name of ours, or of the standard library's, and includes no file that brings it.

The tests compile files in groups, where a neighbour's include makes up for a missing one; packages and a plain cmake
compile each by itself, and would fail. This reads names, it does not compile: what only a compiler sees, the build of the
packages (label nightly) finds.
usage: includes.py REPOSITORY_ROOT
"""
import collections
import pathlib
import re
import sys

ROOMS = ("server", "client", "idl")
# Where the include path begins, beside the root of the repository.
PUBLIC = ("client/include", "idl/include", "server/vcollide/include")
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(["<])([^">]+)[">]', re.M)
NOISE = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'', re.S)
# At the beginning of a line stands what a namespace holds, not what a class does.
TYPE = re.compile(r'^(?:template ?<[^\n]*> ?)?(?:struct|class|enum class|enum|union)[ \t]+(?:alignas\([^)]*\) )?([A-Z]\w*)'
                  r'(?:[ \t]+final)?[ \t]*(?::[^;{]*)?\{', re.M)
# Codes are generated; what names one for its own namespace is a home of it.
ALIAS = re.compile(r'^using[ \t]+(?:codes::)?([A-Z]\w*)[ \t]*[=;]', re.M)
FUNCTION = re.compile(r'^(?!using\b|typedef\b|namespace\b)(?:\[\[\w+\]\] )?\w[\w:<>,*& ]*?[ *&]([a-z]\w{5,})\(', re.M)
# What a class holds, or names before it is there: a name that is also such a one may mean it.
NESTED = re.compile(r'^[ \t]+(?:struct|class|enum class|enum|union)[ \t]+([A-Z]\w*)|^[ \t]+using[ \t]+([A-Z]\w*)[ \t]*=|typename ([A-Z]\w*)|class ([A-Z]\w*)[,>]', re.M)
FORWARD = re.compile(r'^(?:struct|class)[ \t]+([A-Z]\w*);', re.M)
CONSTANT = re.compile(r'^(?:inline )?constexpr [\w:<>, ]+ ([a-z]\w{5,})(?: =|\{|\[)', re.M)
# The library's names with one home, that others of its headers do not promise.
STANDARD = {
    "optional": "optional", "nullopt": "optional", "variant": "variant", "visit": "variant", "span": "span",
    "vector": "vector", "map": "map", "unordered_map": "unordered_map", "unordered_set": "unordered_set", "set": "set",
    "deque": "deque", "array": "array", "function": "functional", "thread": "thread", "jthread": "thread",
    "mutex": "mutex", "scoped_lock": "mutex", "unique_lock": "mutex", "shared_mutex": "shared_mutex",
    "condition_variable": "condition_variable", "atomic": "atomic", "chrono": "chrono", "filesystem": "filesystem",
    "ostringstream": "sstream", "istringstream": "sstream", "stringstream": "sstream", "ifstream": "fstream",
    "ofstream": "fstream", "from_chars": "charconv", "to_chars": "charconv", "bit_cast": "bit", "countr_zero": "bit",
    "popcount": "bit", "unique_ptr": "memory", "make_unique": "memory", "shared_ptr": "memory", "make_shared": "memory",
    "string_view": "string_view", "regex": "regex", "latch": "latch", "future": "future", "priority_queue": "queue",
    "sort": "algorithm", "lower_bound": "algorithm", "accumulate": "numeric", "iota": "numeric", "tuple": "tuple",
    "numeric_limits": "limits", "sqrt": "cmath", "isfinite": "cmath", "memcpy": "cstring",
}


def blank(text):
    """The text without comments and literals; lines stay where they are."""
    return NOISE.sub(lambda found: "\n" * found.group().count("\n") + " ", text)


def resolve(name, files):
    return next((path for path in (name, *(f"{folder}/{name}" for folder in PUBLIC)) if path in files), None)


def declares(paths, bare, name):
    """Whether one of the files has a member, a parameter or a local variable of that name."""
    declared = re.compile(rf"(?:\b(?!(?:return|else|co_return|case|throw)\b)[A-Za-z_]\w* |[\w)][&*>]+ ?){name}\b")
    return any(declared.search(bare[path]) for path in paths if name in bare[path])


def main(root):
    files = {}
    for room in ROOMS:
        for path in sorted((root / room).rglob("*")):
            if path.suffix in (".cpp", ".hpp", ".h"):
                files[str(path.relative_to(root))] = path.read_text(encoding="utf-8")
    own, standard, bare = {}, {}, {}
    for path, text in files.items():
        own[path], standard[path] = set(), set()
        for _, name in INCLUDE.findall(text):
            target = resolve(name, files)
            (own[path] if target else standard[path]).add(target or name)
        bare[path] = blank(text)

    homes = collections.defaultdict(set)
    for path, text in bare.items():
        if path.endswith(".cpp"):
            continue  # what it alone has, nobody can include
        for pattern in (TYPE, ALIAS, FUNCTION, CONSTANT):
            for name in pattern.findall(text):
                homes[name].add(path)
    nested = {name for text in bare.values() for names in NESTED.findall(text) for name in names}
    forward = {path: set(FORWARD.findall(text)) for path, text in bare.items()}
    # A name that two files declare says nothing about which of them is meant.
    home = {name: next(iter(paths)) for name, paths in homes.items() if len(paths) == 1 and name not in nested}

    def reach(path):
        seen, open_files = {path}, [path]
        while open_files:
            for target in own[open_files.pop()]:
                if target not in seen:
                    seen.add(target)
                    open_files.append(target)
        return seen

    violations = 0
    for path in files:
        text = INCLUDE.sub("", bare[path])
        reached = reach(path)
        named = set().union(*(forward[other] for other in reached))
        brought = set().union(*(standard[other] for other in reached))
        # A function's name counts where it is called, and not as a member or another namespace's.
        used = re.findall(r"(?<![\w.:>])(?:engine::|collided::)*(?:([A-Z]\w+)\b|([a-z]\w+)\()", text)
        for found in sorted({kind or function for kind, function in used}):
            if found in home and home[found] not in reached and found not in named and not declares(reached, bare, found):
                print(f'{path}: uses {found} and does not include "{home[found]}"')
                violations += 1
        for found in sorted(set(re.findall(r"\bstd::(\w+)", text))):
            if found in STANDARD and STANDARD[found] not in brought:
                print(f"{path}: uses std::{found} and does not include <{STANDARD[found]}>")
                violations += 1
    print(f"{len(files)} files, {len(home)} names with one home, {violations} violations")
    return 0 if len(files) > 20 and len(home) > 100 and violations == 0 else 1


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
