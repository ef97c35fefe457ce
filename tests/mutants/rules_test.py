#!/usr/bin/python3
"""The harness on a program of a few lines: it finds the places, the copy compiles, and each bug is on when it is chosen.

usage: rules_test.py COMPILER
"""

import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
try:
    import plant
    import rules
except ImportError:
    print("skipped: needs the package python3-clang-14")
    sys.exit(77)

PROGRAM = """#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>
struct Answer { int low; int high; };
struct Word { std::string_view text; };
Word view_of(const std::string& whole) { return {.text = whole}; }
constexpr int kLimit = 3;
Answer ask(int a, int b, bool wanted) {
  int low = std::min(a, b);
  if constexpr (kLimit > 2 && sizeof(int) == 4) low += 0;
  if (a < b && wanted) {
    low -= kLimit + 1;
  }
  return {.low = low, .high = b};
}
int main() {
  const Answer answer = ask(2, 5, true);
  std::printf("%d %d\\n", answer.low, answer.high);
}
"""
# What the program prints without a bug, and with one of each kind.
EXPECTED = {
    None: "-2 5",
    ("comparison turned", "a < b"): "2 5",
    ("connective", "a < b && wanted"): "-2 5",
    ("min and max", "std::min(a, b)"): "1 5",
    ("arithmetic", "kLimit + 1"): "0 5",
    ("off by one", "1"): "-3 5",
    ("statement left out", "low -= kLimit + 1;"): "2 5",
    ("field not copied", "b"): "-2 0",
}


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.makedirs(os.path.join(folder, "tests/mutants"))
        os.makedirs(os.path.join(folder, "idl"))
        here = os.path.dirname(os.path.abspath(__file__))
        for source, target in ((os.path.join(here, "switch.hpp"), "tests/mutants/switch.hpp"),):
            with open(source, encoding="utf-8") as file, open(os.path.join(folder, target), "w", encoding="utf-8") as copy:
                copy.write(file.read())
        with open(os.path.join(folder, "idl/small.cpp"), "w", encoding="utf-8") as file:
            file.write(PROGRAM)
        found = plant.places(folder, "idl/small.cpp", "idl/small.cpp", [sys.argv[1], "-std=c++20"])
        planted = [plant.Planted(i, "idl", "idl/small.cpp", 1, function, made.rule, made.start, made.end, made.before, made.after, made.text)
                   for i, (made, function) in enumerate(found)]
        wrong = sum(not shows(folder, planted, kind, shown) for kind, shown in EXPECTED.items())
    # Of a copy that is gone at once a view would see nothing, also while the bug is off.
    views = [p.before for p in planted if p.rule == "field not copied" and p.before == "whole"]
    wrong += len(views)
    # What the compiler decides is decided before any bug is on.
    decided = [p.before for p in planted if "kLimit > 2" in p.before or "sizeof" in p.before]
    wrong += len(decided)
    places = len(planted)
    print(f"{places} places, {len(EXPECTED) - wrong} of {len(EXPECTED)} as expected, {len(views)} views of copies, {len(decided)} constant conditions")
    return 0 if wrong == 0 and places >= 15 else 1


def shows(folder, planted, kind, shown):
    """Plants the one bug, runs with it off and on, and looks at what is printed and whether the place was reached."""
    chosen = [p for p in planted if kind and (p.rule, p.before) == kind][:1]
    if kind and not chosen:
        print(f"no place for {kind}: {[(p.rule, p.before) for p in planted]}")
        return False
    with open(os.path.join(folder, "idl/small.cpp"), "w", encoding="utf-8") as file:
        text = PROGRAM
        for one in chosen:
            text = text[:one.start] + one.text.replace(rules.ON, f"collided_mutants::on({one.number})") + text[one.end:]
        file.write(plant.PREFIX + text)
    program = os.path.join(folder, "small")
    subprocess.run([sys.argv[1], "-std=c++20", "-I", folder, "-o", program, os.path.join(folder, "idl/small.cpp")], check=True)
    reached = os.path.join(folder, "reached")
    with open(reached, "wb") as file:
        file.write(bytes(len(planted)))

    def said(number):
        environment = dict(os.environ, COLLIDED_MUTANT=str(number), COLLIDED_MUTANTS_REACHED=reached)
        return subprocess.run([program], env=environment, capture_output=True, text=True, check=True).stdout.strip()

    number = chosen[0].number if chosen else -1
    off, on = said(-1), said(number)
    with open(reached, "rb") as file:
        reaches = [i for i, byte in enumerate(file.read()) if byte]
    good = off == EXPECTED[None] and on == shown and reaches == [p.number for p in chosen]
    if not good:
        print(f"{kind}: off '{off}', on '{on}', expected '{shown}', reached {reaches}")
    return good


if __name__ == "__main__":
    sys.exit(main())
