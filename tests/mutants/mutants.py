#!/usr/bin/python3
"""Plants bugs by rule all over the product and counts how many of them the default tests notice.

usage: mutants.py --source DIR --build DIR --work DIR [--count N] [--seed N] [--workers N] [--budget SECONDS] [--require PERCENT] [--again | --resume]

  --build     a configured build of the sources, for its compile commands
  --work      where the copy of the sources with the bugs is kept and built; results go there too
  --budget    the longest that the tests of one bug may take
  --again     the bugs of the run before, of which those that were killed are not judged again: for tests that are new
  --resume    goes on where the run before was ended, with what it had built and learned

Needs Debian's python3-clang-14. Prints a table (file, line, bug, killed by or survived) and the score by room; table.csv and
mutants.json stay in the work folder. Bugs named in survivors.txt beside this file have
a sentence: why nobody can notice, and then they do not count; or what a test would take ("would take ..."), and then they do.
"""

import argparse
import csv
import json
import os
import sys
import time
from dataclasses import asdict

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import judge  # noqa: E402
import plant  # noqa: E402


def read_sentences(path):
    """Lines `file | function | before -> after | sentence`."""
    sentences = {}
    with open(path, encoding="utf-8") as file:
        for line in file:
            if line.strip() and not line.startswith("#"):
                where, function, change, why = (part.strip() for part in line.rstrip("\n").split(" | ", 3))
                sentences[(where, function, change)] = why
    return sentences


def change_of(one):
    return f"{one.before} -> {one.after}"


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--source", required=True)
    parser.add_argument("--build", required=True)
    parser.add_argument("--work", required=True)
    parser.add_argument("--count", type=int, default=600)
    parser.add_argument("--seed", type=int, default=int(os.environ.get("COLLIDED_SEED", "17")))
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--budget", type=float, default=60)
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--require", type=float, default=0, help="fails below this score in percent")
    return parser.parse_args(arguments)


def say(text):
    print(time.strftime("%H:%M:%S"), text, file=sys.stderr, flush=True)


def outcome_of(verdict, sentence):
    if verdict.killed_by:
        return "killed"
    return "survived" if not sentence or sentence.startswith("would take") else "harmless"


def rows_of(planted, verdicts, sentences):
    for one in planted:
        verdict = verdicts[one.number]
        sentence = sentences.get((one.file, one.function, change_of(one)), "")
        outcome = outcome_of(verdict, sentence)
        by = verdict.killed_by or sentence
        if outcome == "survived":
            ran = f"{verdict.ran} of {verdict.reached_by} tests that reach it"
            by = ", ".join([part for part in [ran, *verdict.notes, sentence or "no sentence yet"] if part])
        yield {"room": one.room, "file": one.file, "line": one.line, "function": one.function, "rule": one.rule,
               "bug": change_of(one), "outcome": outcome, "by": by, "seconds": round(verdict.seconds, 1)}


def print_rows(rows):
    for row in rows:
        print(f"{row['file']}:{row['line']}  {row['rule']}  {row['bug'][:110]}\n    {row['outcome']}: {row['by']}")


def print_scores(rows):
    print(f"{'room':24}{'bugs':>6}{'killed':>8}{'harmless':>10}{'survived':>10}{'score':>8}")
    score = 0.0
    for room in [r for r in plant.ROOMS if any(row["room"] == r for row in rows)] + ["all"]:
        mine = [row for row in rows if room in ("all", row["room"])]
        counts = {kind: sum(row["outcome"] == kind for row in mine) for kind in ("killed", "harmless", "survived")}
        judged = len(mine) - counts["harmless"]
        score = 100.0 * counts["killed"] / judged if judged else 100.0
        print(f"{room:24}{len(mine):6}{counts['killed']:8}{counts['harmless']:10}{counts['survived']:10}{score:7.1f}%")
    return score


def judged_before(path, options):
    """What an earlier run has found and this one takes over; else the file begins anew."""
    verdicts = {}
    if (options.again or options.resume) and os.path.exists(path):
        with open(path, encoding="utf-8") as file:
            verdicts = {v.number: v for v in (judge.Verdict(**json.loads(line)) for line in file)}
    if options.again:
        verdicts = {number: v for number, v in verdicts.items() if v.killed_by}
    with open(path, "w", encoding="utf-8") as file:
        file.writelines(json.dumps(asdict(v)) + "\n" for v in verdicts.values())
    return verdicts


def known_tests(build, learned):
    """The tests of which an earlier run knows what they reach, and the others."""
    past = {}
    if learned:
        with open(learned, encoding="utf-8") as file:
            past = json.load(file)
    known, unknown = [], []
    for test in judge.default_tests(build):
        if test.name in past:
            test.seconds, test.reaches = past[test.name]["seconds"], frozenset(past[test.name]["reaches"])
        (known if test.name in past else unknown).append(test)
    return known, unknown


def prepared(options, source, work, tree):
    """The bugs that stand in a copy that is built, and the tests with what each reaches."""
    chosen, learned = os.path.join(work, "mutants.json"), os.path.join(work, "reached.json")
    build = os.path.join(tree, "build")
    if options.resume:
        known, _ = known_tests(build, learned)
        return plant.load(chosen), known
    if options.again:
        planted = plant.still_there(plant.load(chosen), source, say)
    else:
        planted = plant.choose(source, os.path.realpath(options.build), options.seed, options.count, say)
    say(f"{len(planted)} bugs planted; building")
    plant.save(planted, chosen)
    planted = plant.build_tree(source, tree, planted, say)
    plant.save(planted, chosen)
    known, unknown = known_tests(build, learned if options.again else None)
    tests = known + judge.learn(unknown, 1 + max(p.number for p in planted), options.workers, say)
    with open(learned, "w", encoding="utf-8") as file:
        json.dump({t.name: {"seconds": t.seconds, "reaches": sorted(t.reaches)} for t in tests}, file)
    return planted, tests


def main():
    options = parse(sys.argv[1:])
    source, work = os.path.realpath(options.source), os.path.realpath(options.work)
    tree = os.path.join(work, "tree")
    os.makedirs(tree, exist_ok=True)
    planted, tests = prepared(options, source, work, tree)
    sentences = read_sentences(os.path.join(os.path.dirname(os.path.abspath(__file__)), "survivors.txt"))
    said = os.path.join(work, "verdicts.jsonl")
    verdicts = judged_before(said, options)

    def on_verdict(verdict):
        verdicts[verdict.number] = verdict
        with open(said, "a", encoding="utf-8") as file:
            file.write(json.dumps(asdict(verdict)) + "\n")
        if len(verdicts) % 20 == 0:
            killed = sum(1 for v in verdicts.values() if v.killed_by)
            say(f"{len(verdicts)} of {len(planted)} judged, {killed} killed")

    judge.judge_all([p for p in planted if p.number not in verdicts], tests, options.workers, options.budget, on_verdict)
    rows = list(rows_of(planted, verdicts, sentences))
    with open(os.path.join(work, "table.csv"), "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    print_rows(rows)
    score = print_scores(rows)
    print(f"seed={options.seed} bugs={len(rows)} score={score:.1f}")
    return 0 if score >= options.require else 1


if __name__ == "__main__":
    sys.exit(main())
