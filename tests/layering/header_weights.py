#!/usr/bin/env python3
"""Fails where a header of ours brings more text, or a heavier library, to those that include it than its budget allows.

The weight of a header is the size of what the compiler reads of it: its own text, that of all headers of ours below it, and
that of each header of others, once, as the preprocessor leaves it. Comments do not count.
usage: header_weights.py REPOSITORY_ROOT [--compiler CXX] [--build FOLDER] [--list COUNT]
--list   prints the heaviest headers: kB, files that include them (also by way of others), and what makes them heavy
"""
import argparse
import collections
import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOMS = ("server", "client", "idl")
PUBLIC = ("client/include", "idl/include", "server/vcollide/include")
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(["<])([^">]+)[">]', re.M)
COMMENT = re.compile(r'^[ \t]*//[^\n]*\n|[ \t]*//[^\n]*', re.M)
MARKER = re.compile(r'^# \d+ "([^"]*)"')
# Measured with g++ 12 of Debian 12, and a few hundredths more. Eigen and the standard library are some 4,700 kB of a header's.
MOST_KB = 5_250
MOST_KB_WITH_A_LIBRARY = 6_500  # by way of one of the headers in DOORS
MOST_MB = 3_250                 # of all files together, each read by itself
# Libraries that only these headers of ours bring to others: they hold values of its types, or templates that use them.
DOORS = {
    "nlohmann/json.hpp": r"client/cli/server_command\.hpp|json_(reading|text|view)\.hpp|described_json\.hpp|command_arguments\.hpp",
    "spdlog/logger.h": "^$",
    "CLI/": r"client/cli/(input/(option|solid_flag)|verbs/standing)\.hpp",
    "boost/": "^$",
    "fmt/": r"client/cli/verbs/standing\.hpp|server/intake/scene_file/scene_decoder\.hpp",
}
HEAVY = 500  # kB: a header of others that is named beside one of ours


def external_sizes(header, compiler, folders):
    """{file: bytes that the preprocessor leaves of it} for a header of others; nothing where it is not there."""
    command = [compiler, "-std=c++20", "-E", "-x", "c++", *(f"-I{folder}" for folder in folders), "-"]
    made = subprocess.run(command, input=f"#include <{header}>\n", capture_output=True, text=True)
    if made.returncode != 0:
        return {}
    sizes, file = collections.Counter(), ""
    for line in made.stdout.splitlines():
        marker = MARKER.match(line)
        if marker:
            file = marker.group(1)
        elif not file.startswith("<"):
            sizes[file] += len(line.strip()) and len(line) + 1
    return sizes


class Headers:
    def __init__(self, root, compiler, folders):
        paths = [path for room in ROOMS for suffix in ("*.hpp", "*.cpp") for path in sorted((root / room).rglob(suffix))]
        texts = {str(path.relative_to(root)): path.read_text() for path in paths}
        self.own_bytes = {path: len(COMMENT.sub("", text)) for path, text in texts.items()}
        self.ours, self.others = {}, {}
        for path, text in texts.items():
            names = [name for _, name in INCLUDE.findall(text)]
            found = {name: self.resolve(name, texts) for name in names}
            self.ours[path] = {target for target in found.values() if target}
            self.others[path] = {name for name, target in found.items() if not target}
        wanted = sorted(set().union(*self.others.values()))
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            sizes = pool.map(lambda name: external_sizes(name, compiler, folders), wanted)
            self.sizes = dict(zip(wanted, sizes))
        self.below = {}
        for path in texts:
            self.closure(path)

    @staticmethod
    def resolve(name, texts):
        return next((path for path in (name, *(f"{folder}/{name}" for folder in PUBLIC)) if path in texts), None)

    def closure(self, path):
        """The file and all files of ours that it includes, also by way of others."""
        if path not in self.below:
            self.below[path] = {path}
            for target in self.ours[path]:
                self.below[path] |= self.closure(target)
        return self.below[path]

    def weight(self, path):
        files = collections.Counter()
        for other in self.others_of(path):
            for file, size in self.sizes.get(other, {}).items():
                files[file] = max(files[file], size)
        return sum(files.values()) + sum(self.own_bytes[one] for one in self.below[path])

    def others_of(self, path):
        return set().union(*(self.others[one] for one in self.below[path]))

    def heavy(self, path):
        """The heaviest headers of others that it brings, as words."""
        sizes = sorted(((sum(self.sizes.get(other, {}).values()) // 1000, other) for other in self.others_of(path)), reverse=True)
        return [f"{other} {size}" for size, other in sizes if size >= HEAVY]

    def includers(self):
        count = collections.Counter()
        for path in self.below:
            count.update(self.below[path] - {path})
        return count


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("root", type=pathlib.Path)
    parser.add_argument("--compiler", default="g++")
    parser.add_argument("--build", default="build")
    parser.add_argument("--list", type=int, default=0)
    given = parser.parse_args()
    folders = [given.build, f"{given.build}/idl", "/usr/include/eigen3"]
    headers = Headers(given.root, given.compiler, folders)
    count = headers.includers()
    sizes = {path: headers.weight(path) for path in headers.below}
    ours = sorted((path for path in sizes if path.endswith(".hpp")), key=lambda path: -sizes[path] * count[path])
    for path in ours[: given.list]:
        print(f"{sizes[path] // 1000:6} kB {count[path]:5} files  {path}  ({', '.join(headers.heavy(path)[:5])})")
    wrong = []
    for path in ours:
        has_library = any(other.startswith(tuple(DOORS)) for other in headers.others_of(path))
        most = MOST_KB_WITH_A_LIBRARY if has_library else MOST_KB
        if sizes[path] > most * 1000:
            wrong.append(f"{path}: {sizes[path] // 1000} kB, {most} are allowed ({', '.join(headers.heavy(path)[:3])})")
        for library, allowed in DOORS.items():
            if any(other.startswith(library) for other in headers.others[path]) and not re.search(allowed, path):
                wrong.append(f"{path}: includes {library}, for which a forward declaration serves, or a .cpp")
    read = sum(size for path, size in sizes.items() if path.endswith(".cpp")) // 1_000_000
    if read > MOST_MB:
        wrong.append(f"all files together read {read} MB, {MOST_MB} are allowed; --list 40 shows what weighs")
    print("\n".join(wrong) if wrong else f"{len(ours)} headers; all files together read {read} MB of {MOST_MB}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
