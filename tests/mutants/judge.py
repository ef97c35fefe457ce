"""Which tests reach which bugs, and whether one of them notices when the bug is on."""

import json
import os
import re
import resource
import signal
import subprocess
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

LEFT_OUT = re.compile("nightly|studies|peers")
# What checks the text of the sources or builds them again learns nothing from a bug that is switched on at run time.
NO_BEHAVIOUR = re.compile(r"^(layering|consumer|accuracy/planted_.*|mutants.*)$")
BYTES_OF_A_PROCESS = 12 << 30
BYTES_OF_A_FILE = 2 << 30


@dataclass
class Test:
    name: str
    command: list
    environment: dict
    folder: str
    timeout: float
    labels: list
    skip_code: int
    serial: bool
    seconds: float = 0.0
    reaches: frozenset = frozenset()
    passes: bool = True

    @property
    def together(self):
        """The program, where several tests of it can run in one process: not those that own a server or a network."""
        shared = any(word.startswith("--gtest_filter=") for word in self.command)
        return self.command[0] if shared and not {"service", "view"} & set(self.labels) else None


@dataclass
class Verdict:
    number: int
    killed_by: str = ""
    reached_by: int = 0
    ran: int = 0
    seconds: float = 0.0
    notes: list = field(default_factory=list)


def default_tests(build):
    told = subprocess.run(["ctest", "--show-only=json-v1"], cwd=build, check=True, capture_output=True, text=True).stdout
    tests = []
    for entry in json.loads(told)["tests"]:
        properties = {p["name"]: p["value"] for p in entry.get("properties", [])}
        labels = properties.get("LABELS", [])
        if "command" not in entry or any(LEFT_OUT.search(label) for label in labels) or NO_BEHAVIOUR.match(entry["name"]):
            continue
        tests.append(Test(entry["name"], entry["command"],
                          dict(v.split("=", 1) for v in properties.get("ENVIRONMENT", [])),
                          properties.get("WORKING_DIRECTORY", build), float(properties.get("TIMEOUT", 300)), labels,
                          int(properties.get("SKIP_RETURN_CODE", -1)), bool(properties.get("RUN_SERIAL", False))))
    return tests


def limits():
    # The soft limits alone: converters set limits of their own, which may be higher.
    resource.setrlimit(resource.RLIMIT_AS, (BYTES_OF_A_PROCESS, resource.RLIM_INFINITY))
    resource.setrlimit(resource.RLIMIT_FSIZE, (BYTES_OF_A_FILE, resource.RLIM_INFINITY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def run(command, folder, environment, timeout):
    """The return code, or None after the time limit; whatever the program has started goes with it."""
    with subprocess.Popen(command, cwd=folder, env=dict(os.environ, **environment), stdin=subprocess.DEVNULL,
                          stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
                          preexec_fn=limits) as process:
        try:
            return process.wait(timeout)
        except subprocess.TimeoutExpired:
            return None
        finally:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass


def passed(test, mutant, timeout, reached_file=None):
    environment = dict(test.environment, COLLIDED_MUTANT=str(mutant))
    if reached_file:
        environment["COLLIDED_MUTANTS_REACHED"] = reached_file
    return run(test.command, test.folder, environment, timeout) in (0, test.skip_code)


def learn(tests, count, workers, say):
    """Runs each test once without a bug: how long it takes and which places it reaches."""
    done = 0
    lock = threading.Lock()

    def one(test):
        nonlocal done
        with tempfile.NamedTemporaryFile() as file:
            file.write(bytes(count))
            file.flush()
            started = time.monotonic()
            test.passes = passed(test, -1, test.timeout, file.name)
            test.seconds = time.monotonic() - started
            with open(file.name, "rb") as again:
                test.reaches = frozenset(i for i, byte in enumerate(again.read()) if byte)
        with lock:
            done += 1
            if done % 100 == 0:
                say(f"{done} of {len(tests)} tests run without a bug")

    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(one, [t for t in tests if not t.serial]))
    for test in tests:
        if test.serial:
            one(test)
    for test in tests:
        if not test.passes:
            say(f"without a bug {test.name} fails: not used")
    return [t for t in tests if t.passes]


def pertinence(test):
    """A test that reaches few bugs is about them; a quick one costs little. Low comes first."""
    return (0.01 + test.seconds) * len(test.reaches)


def batches(tests, longest_s=4.0):
    """Tests of one program and environment in one process, the pertinent ones first."""
    waiting = {}
    for test in sorted(tests, key=pertinence):
        key = (test.together or test.name, tuple(sorted(test.environment.items())))
        lists = waiting.setdefault(key, [[]])
        if lists[-1] and (not test.together or sum(t.seconds for t in lists[-1]) + test.seconds > longest_s):
            lists.append([])
        lists[-1].append(test)
    made = [part for lists in waiting.values() for part in lists]
    return sorted(made, key=lambda part: sum(pertinence(t) for t in part) / len(part))


def batch_fails(part, mutant):
    first, seconds = part[0], sum(t.seconds for t in part)
    timeout = 10 + 8 * seconds
    if len(part) == 1:
        return not passed(first, mutant, timeout)
    names = [w[len("--gtest_filter="):] for t in part for w in t.command if w.startswith("--gtest_filter=")]
    command = [first.command[0], "--gtest_filter=" + ":".join(names), "--gtest_fail_fast"]
    environment = dict(first.environment, COLLIDED_MUTANT=str(mutant))
    return run(command, first.folder, environment, timeout) != 0


def judge(mutant, tests, budget_s, serial_lock):
    """Runs the tests that reach the bug until one fails. A test that measures time or talks over a network must fail twice."""
    verdict = Verdict(mutant.number)
    reaching = [t for t in tests if mutant.number in t.reaches]
    verdict.reached_by = len(reaching)
    started = time.monotonic()
    for part in batches([t for t in reaching if not t.serial]) + [[t] for t in reaching if t.serial]:
        if time.monotonic() - started > budget_s:
            verdict.notes.append(f"stopped after {budget_s:.0f} s")
            break
        verdict.ran += len(part)
        with serial_lock if part[0].serial else threading.Lock():
            fails = batch_fails(part, mutant.number)
            if fails and not part[0].together:
                fails = batch_fails(part, mutant.number)
        if fails:
            verdict.killed_by = part[0].name if len(part) == 1 else f"{part[0].name} or one of {len(part) - 1} beside it"
            break
    verdict.seconds = time.monotonic() - started
    return verdict


def judge_all(planted, tests, workers, budget_s, on_verdict):
    serial_lock = threading.Lock()
    with ThreadPoolExecutor(workers) as pool:
        for verdict in pool.map(lambda m: judge(m, tests, budget_s, serial_lock), planted):
            on_verdict(verdict)
