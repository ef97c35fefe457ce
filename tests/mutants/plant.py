"""Chooses places by seed, writes a copy of the sources in which every chosen bug waits for its switch, and builds it."""

import json
import os
import random
import re
import shutil
import subprocess
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass

from clang.cindex import CursorKind, Index, TranslationUnitLoadError

import rules

ROOMS = ["server/geometry", "server/intake", "server/broad_phase", "server/exact_phase", "server/world", "server/service",
         "server/vcollide", "server/programs", "client/library", "client/cli", "client/draw", "client/view", "client/response", "idl"]
LEAST_IN_A_ROOM = 12
FUNCTIONS = {CursorKind.FUNCTION_DECL, CursorKind.CXX_METHOD, CursorKind.CONSTRUCTOR, CursorKind.DESTRUCTOR,
             CursorKind.FUNCTION_TEMPLATE, CursorKind.CONVERSION_FUNCTION}
# Warnings that a planted bug may deserve; the build stops at any other.
ALLOWED = ["unused", "type-limits", "parentheses", "sign-compare", "conversion", "float-conversion", "bool-operation",
           "int-in-bool-context", "empty-body", "unused-value", "extra", "logical-op", "shadow", "return-type",
           "bool-compare", "float-equal", "dangling-pointer"]
PREFIX = ('#include "tests/mutants/switch.hpp"\n' +
          "".join(f'#pragma GCC diagnostic ignored "-W{name}"\n' for name in ALLOWED) + "#line 1\n")


@dataclass
class Planted:
    number: int
    room: str
    file: str
    line: int
    function: str
    rule: str
    start: int
    end: int
    before: str
    after: str
    text: str


def room_of(path):
    return next((room for room in ROOMS if path.startswith(room + "/")), None)


def product_files(root):
    listed = subprocess.run(["git", "ls-files", "*.cpp", "*.hpp"], cwd=root, check=True, capture_output=True, text=True)
    return [f for f in listed.stdout.split() if room_of(f)]


def code_lines(path):
    with open(path, encoding="utf-8") as file:
        return sum(1 for line in file if line.strip() and not line.strip().startswith("//"))


def unit_of(root, path, commands):
    """The translation unit in which a header's functions are compiled: one that includes it, by its own name first."""
    if path in commands:
        return path
    found = subprocess.run(["git", "grep", "-l", f'#include "{path}"', "--", "*.cpp"], cwd=root, capture_output=True, text=True)
    users = [f for f in found.stdout.split() if f in commands and room_of(f)]
    stem = os.path.splitext(path)[0].removesuffix("-inl")
    return next((f for f in users if f.startswith(stem)), users[0] if users else None)


def compile_commands(build, root):
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        return {os.path.relpath(c["file"], root): c["command"].split() for c in json.load(file)}


def arguments_of(command):
    """What libclang needs of g++'s command line."""
    kept, take_next = ["-w", "-ferror-limit=0"], False
    for word in command:
        if take_next or word.startswith(("-I", "-D", "-std=")):
            kept.append(word)
            take_next = False
        elif word == "-isystem":
            kept.append(word)
            take_next = True
        elif word.endswith("cmake_pch.hxx"):
            kept += precompiled(word)
    return kept


def precompiled(path):
    """The headers of a precompiled header: libclang refuses to read what g++ has made of them."""
    with open(path, encoding="utf-8") as file:
        return [part for name in re.findall(r'#include [<"]([^>"]+)[>"]', file.read()) for part in ("-include", name)]


def places(root, path, unit, command):
    """Every mutation in a file, with the function that it stands in."""
    source = rules.Source(os.path.join(root, path))
    try:
        parsed = Index.create().parse(os.path.join(root, unit), args=arguments_of(command))
    except TranslationUnitLoadError:
        return []
    wanted = os.path.realpath(os.path.join(root, path))
    found = {}

    def inside(cursor, function):
        for child in cursor.get_children():
            if rules.is_constant(child, cursor, source):
                continue
            for made in rules.at(child, cursor, source):
                if made:
                    found.setdefault((made.start, made.end, made.rule, made.after), (made, function))
            if cursor.kind == CursorKind.CASE_STMT and child.kind != CursorKind.COMPOUND_STMT and child.kind.is_expression():
                continue
            inside(child, function)

    def outside(cursor):
        for child in cursor.get_children():
            if child.kind == CursorKind.NAMESPACE:
                if child.location.file and os.path.realpath(child.location.file.name) == wanted:
                    outside(child)
                continue
            if not child.location.file or os.path.realpath(child.location.file.name) != wanted:
                continue
            if child.kind in FUNCTIONS:
                for part in child.get_children():
                    if part.kind in (CursorKind.COMPOUND_STMT, CursorKind.CXX_TRY_STMT):
                        inside(part, child.spelling)
            elif child.kind in (CursorKind.CLASS_DECL, CursorKind.STRUCT_DECL, CursorKind.CLASS_TEMPLATE,
                                CursorKind.LINKAGE_SPEC, CursorKind.UNEXPOSED_DECL):
                outside(child)

    outside(parsed.cursor)
    return list(found.values())


def quotas(root, files, count):
    """Bugs a room: by its lines of code, with a least number."""
    lines = {room: 0 for room in ROOMS}
    for path in files:
        lines[room_of(path)] += code_lines(os.path.join(root, path))
    total = sum(lines.values())
    least = min(LEAST_IN_A_ROOM, max(1, count // len(ROOMS)))
    return {room: max(least, round(count * n / total)) for room, n in lines.items() if n}


def drawn_files(root, files, wanted, random_numbers):
    """How many bugs each file gets: drawn by its lines."""
    drawn = {}
    for room, number in wanted.items():
        mine = sorted(f for f in files if room_of(f) == room)
        weights = [code_lines(os.path.join(root, f)) for f in mine]
        for path in random_numbers.choices(mine, weights, k=number):
            drawn[path] = drawn.get(path, 0) + 1
    return drawn


def draw(candidates, number, random_numbers):
    """A kind first, then a place: else literals and statements would be all that is planted. No two overlap."""
    chosen = []
    for _ in range(number * 20):
        if len(chosen) == number or not candidates:
            break
        rule = random_numbers.choice(sorted({made.rule for made, _ in candidates}))
        made, function = random_numbers.choice([c for c in candidates if c[0].rule == rule])
        if all(made.end <= other.start or other.end <= made.start for other, _ in chosen):
            chosen.append((made, function))
    return chosen


def choose(root, build, seed, count, say):
    random_numbers = random.Random(seed)
    commands = compile_commands(build, root)
    files = [f for f in product_files(root) if unit_of(root, f, commands)]
    drawn = drawn_files(root, files, quotas(root, files, count), random_numbers)
    say(f"{count} bugs asked, {len(drawn)} of {len(files)} files drawn (seed {seed})")
    planted = []
    with ProcessPoolExecutor() as pool:
        order = sorted(drawn)
        units = [unit_of(root, f, commands) for f in order]
        found = pool.map(places, [root] * len(order), order, units, [commands[u] for u in units])
        for path, candidates in zip(order, found):
            candidates.sort(key=lambda c: (c[0].start, c[0].end, c[0].rule, c[0].after))
            with open(os.path.join(root, path), "rb") as file:
                content = file.read()
            for made, function in sorted(draw(candidates, drawn[path], random_numbers), key=lambda c: c[0].start):
                line = content.count(b"\n", 0, made.start) + 1
                planted.append(Planted(len(planted), room_of(path), path, line, function, made.rule, made.start, made.end,
                                       made.before, made.after, made.text))
    return planted


def still_there(planted, root, say):
    """Those whose text is where it was."""
    kept = []
    for one in planted:
        path = os.path.join(root, one.file)
        source = rules.Source(path) if os.path.isfile(path) else None
        text = source.one_line(source.text(one.start, one.end)) if source else ""
        if text and text in one.before:
            kept.append(one)
    say(f"{len(planted) - len(kept)} of {len(planted)} bugs stood in sources that have changed since")
    return kept


def remove_others(tree, files):
    """What an earlier copy had and the sources have no longer."""
    for folder, folders, names in os.walk(tree):
        if folder == tree and "build" in folders:
            folders.remove("build")
        for name in names:
            path = os.path.join(folder, name)
            if os.path.relpath(path, tree) not in files:
                os.remove(path)


def write_tree(root, tree, planted):
    """The tree is kept between runs: files whose text stays keep their time, so that only what changed is built."""
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=root, check=True,
                            capture_output=True, text=True)
    by_file = {}
    for one in planted:
        by_file.setdefault(one.file, []).append(one)
    files = [path for path in listed.stdout.split("\n") if path and os.path.isfile(os.path.join(root, path))]
    remove_others(tree, set(files))
    for path in files:
        with open(os.path.join(root, path), "rb") as file:
            content = file.read()
        for one in sorted(by_file.get(path, []), key=lambda p: -p.start):
            text = one.text.replace(rules.ON, f"collided_mutants::on({one.number})")
            content = content[:one.start] + text.encode() + content[one.end:]
        if path in by_file:
            content = PREFIX.encode() + content
        target = os.path.join(tree, path)
        os.makedirs(os.path.dirname(target), exist_ok=True)
        if not os.path.exists(target) or open(target, "rb").read() != content:
            with open(target, "wb") as file:
                file.write(content)
            shutil.copymode(os.path.join(root, path), target)


def build_tree(root, tree, planted, say):
    """Builds; what does not compile is taken out and the rest built again. Returns the bugs that stand."""
    build = os.path.join(tree, "build")
    environment = dict(os.environ, CCACHE_BASEDIR=os.path.commonpath([root, tree]), CCACHE_NOHASHDIR="1")
    for attempt in range(8):
        write_tree(root, tree, planted)
        # An index that a bug moves past an array's end is the tests' to notice, not the compiler's.
        flags = "-DCMAKE_CXX_FLAGS=-Wno-error=array-bounds"
        subprocess.run(["cmake", "-G", "Ninja", "-B", build, "-S", tree, flags], check=True, stdout=subprocess.DEVNULL, env=environment)
        made = subprocess.run(["ninja", "-C", build, "-k", "0"], env=environment, capture_output=True, text=True)
        if made.returncode == 0:
            return planted
        # The place itself, or what required the template in which the error is.
        complaints = re.findall(r"^([^\s:]+):(\d+):\d+: +(?:fatal error|error|required from)", made.stdout, re.MULTILINE)
        broken = {(os.path.relpath(os.path.join(build, path), tree), int(line)) for path, line in complaints}
        left_out = [p for p in planted if any(
            p.file == path and p.line <= line <= p.line + p.text.count("\n") for path, line in broken)]
        if not left_out:
            paths = {path for path, _ in broken}
            left_out = [p for p in planted if p.file in paths]
        if not left_out:
            complaints = [line for line in made.stdout.splitlines() if "error" in line or "FAILED" in line]
            raise SystemExit("the copy does not build:\n" + "\n".join(complaints[:20]))
        say(f"build {attempt + 1}: {len(left_out)} bugs do not compile and are left out")
        planted = [p for p in planted if p not in left_out]
    raise SystemExit("the copy does not build after eight attempts")


def save(planted, path):
    with open(path, "w", encoding="utf-8") as file:
        json.dump([asdict(p) for p in planted], file, indent=1)


def load(path):
    with open(path, encoding="utf-8") as file:
        return [Planted(**p) for p in json.load(file)]
