#!/usr/bin/env python3
"""Fails on a folder whose comments have more of a bad habit of English than english_limits.txt allows.

Checks the comments of C++ headers and sources, IDL and schemas in server, client and idl. A habit without a limit for a
folder may not occur there. Limits may only fall: --lower replaces each by the present count if that is smaller.
usage: english.py REPOSITORY_ROOT [--lower | --list [FOLDER]]
"""
import bisect
import collections
import pathlib
import re
import sys

ROOMS = ("server", "client", "idl")
SUFFIXES = (".cpp", ".hpp", ".h", ".c", ".idl", ".fbs")
LIMITS = "tests/layering/english_limits.txt"
SHOWN = 40
# Literals come first, so that two slashes in a text are not a comment.
TOKEN = re.compile(r'R"(\w*)\((?:.|\n)*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|(//[^\n]*)|/\*(?:.|\n)*?\*/')
DIGITS = re.compile(r"(?<=\w)'(?=\w)")
MARK = re.compile(r"//[/!]?<? ?")
CODE = re.compile(r"`[^`]*`")
START = r"(?:^|(?<=[.;:] ))"

# The habits of the dialect, each with what to write instead.
HABITS = {
    "people for things": (
        re.compile(r"(?<!user )(?<!users )(?<!people )(?<!person )(?<!author )(?<!reader )(?<!operator )"
                   r"\b(?:who|whom|whoever|somebody|someone|nobody|anybody)\b", re.I),
        "that, the client, any process, no object"),
    "whose": (re.compile(r"(?<!user )(?<!people )\bwhose\b", re.I), "with, of which"),
    "speaking software": (
        re.compile(r"\b(?:tells?|told|says?|said|hears?|heard of)\b(?![.(]\w)", re.I),
        "reports, returns, publishes, receives, means"),
    "Of or For as opener": (
        re.compile(START + r"Of (?!course\b)|^For (?:(?![,:]).)*$"),
        "the subject first, or a verb in the third person"),
    "headless clause": (
        re.compile(START + r"(?:What|Whatever|Who|Whoever) (?![^.]*\?)"),
        "the noun that is meant"),
    "where for if": (
        re.compile(START + r"Where [^,.;:]*, (?!(?:and|or|as|at|by|in)\b)|\b(?:[Nn]othing|[Nn]one|[Nn]ull|[Ee]mpty|undecided|[Ii]nfinite|[Tt]rue|[Ff]alse) where\b"),
        "if, unless, when"),
    "is no": (
        re.compile(r"\b(?P<fine>there (?:\w+ )?)?(?:is|are|was|were) no "
                   r"(?!longer\b|more\b|less\b|farther\b|nearer\b|larger\b|wider\b|lower\b|later\b|earlier\b|deeper\b)",
                   re.I),
        "is not a"),
    "nothing but": (re.compile(r"\bnothing but\b|\bbut for\b", re.I), "only, except"),
    "likewise": (
        re.compile(r"\blikewise\b|\bsuch an? one\b|\bthe same of\b|\bthat of it\b", re.I),
        "the name of the thing"),
    "anew": (re.compile(r"\banew\b|\bof late\b", re.I), "again, recently"),
    "is to be": (re.compile(r"\b(?:is|are|was|were) to be\b", re.I), "the verb itself, must, will"),
    "so long": (re.compile(r"\bso (?:long|many|much|often)\b(?! as\b|[^.]* that\b)", re.I), "this long, as many"),
}


def comments(text):
    """Yields each comment as a list of lines (number, text); line comments at one column in successive lines are one."""
    starts = [0]
    for line in text.split("\n"):
        starts.append(starts[-1] + len(line) + 1)
    block, last = [], None
    for found in TOKEN.finditer(DIGITS.sub("_", text)):
        if not found.group(2):
            continue
        line = bisect.bisect_right(starts, found.start())
        column = found.start() - starts[line - 1]
        is_alone = not text[starts[line - 1]:found.start()].strip()
        comment = text[found.start():found.end()]
        mark = MARK.match(comment).group()
        if block and not (is_alone and last == (line - 1, column)):
            yield block
            block = []
        block.append((line, comment[len(mark):].strip()))
        last = (line, column)
    if block:
        yield block


def paragraphs(block):
    """Yields each paragraph of a comment as one line of text, with the offset of each line in it."""
    piece = []
    for line, text in block + [(0, "")]:
        if text:
            piece.append((line, text))
        elif piece:
            places, joined = [], ""
            for number, part in piece:
                places.append((len(joined), number))
                joined += part + " "
            yield joined.rstrip(), places
            piece = []


def findings(root):
    """Returns the places (file, line, text) of each habit by folder, and the numbers of files and comments."""
    found = collections.defaultdict(list)
    file_count = comment_count = 0
    for room in ROOMS:
        for path in sorted((root / room).rglob("*")):
            if path.suffix not in SUFFIXES:
                continue
            file_count += 1
            name = path.relative_to(root)
            folder = "/".join(name.parts[:2]) if len(name.parts) > 2 else name.parts[0]
            for block in comments(path.read_text(encoding="utf-8")):
                comment_count += 1
                for text, places in paragraphs(block):
                    for habit, (pattern, _) in HABITS.items():
                        for match in pattern.finditer(CODE.sub(lambda code: " " * len(code.group()), text)):
                            if match.groupdict().get("fine"):
                                continue
                            line = places[bisect.bisect_right(places, (match.start(), 1 << 30)) - 1][1]
                            excerpt = text[max(0, match.start() - 30):match.end() + 40]
                            found[folder, habit].append((str(name), line, excerpt))
    return found, file_count, comment_count


def read_limits(path):
    limits = {}
    for line in path.read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            folder, count, habit = line.split(None, 2)
            limits[folder, habit] = int(count)
    return limits


def write_limits(path, limits):
    heading = [line for line in path.read_text(encoding="utf-8").splitlines() if line.startswith("#")]
    rows = [f"{folder:<20} {count:>4}  {habit}" for (folder, habit), count in sorted(limits.items()) if count > 0]
    path.write_text("\n".join(heading + rows) + "\n", encoding="utf-8")


def show(places, habit):
    for name, line, text in places[:SHOWN]:
        print(f"{name}:{line}: {habit}: {text}")
    if len(places) > SHOWN:
        print(f"... and {len(places) - SHOWN} more: english.py --list")


def main(root, options):
    found, file_count, comment_count = findings(root)
    limits = read_limits(root / LIMITS)
    if options[:1] == ["--lower"]:
        write_limits(root / LIMITS, {key: min(limit, len(found[key])) for key, limit in limits.items()})
        return 0
    if options[:1] == ["--list"]:
        for (folder, habit), places in sorted(found.items()):
            if len(options) < 2 or folder == options[1]:
                for name, line, text in places:
                    print(f"{name}:{line}: {habit}: {text}")
        return 0
    violations = 0
    for (folder, habit), places in sorted(found.items()):
        limit = limits.get((folder, habit), 0)
        if len(places) > limit:
            violations += len(places) - limit
            show(places, habit)
            print(f"{folder}: {habit}: {len(places)} found, {limit} allowed; write: {HABITS[habit][1]}")
    unknown = sorted({habit for _, habit in limits} - set(HABITS))
    for habit in unknown:
        print(f"{LIMITS}: no habit is called '{habit}'")
    total = sum(len(places) for places in found.values())
    print(f"{file_count} files, {comment_count} comments, {total} habits of {sum(limits.values())} allowed, "
          f"{violations} violations")
    return 0 if file_count > 20 and comment_count > 100 and violations == 0 and not unknown else 1


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), sys.argv[2:]))
