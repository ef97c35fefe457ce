#!/usr/bin/env python3
"""Runs the commands that a document shows and compares what they print with what the document says.

Every line that begins with "$ " in a ```console block is a command; one that ends in a backslash goes on in the next line.
All of them run in order, on a terminal of 100 columns, in an empty folder with a link to deploy/, against a fresh server
on the embedded scene. A "sleep", and the time before a "cat", lasts longer on a busy machine. What the commands
write to standard output and standard error is compared line by line; blanks at the end of a line do not count.

usage: console_blocks.py DOC COLLIDED COLLIDE [--write] [--domain N] [--least N] [--same MADE FILE]
  --write   put what came out into the document instead of comparing
  --domain  the DDS domain of the server; documents tested at once need one each
  --least   fail where the document has fewer commands; 0: it must have no console block at all
  --same    the file MADE by the commands is equal to FILE
"""
import argparse
import difflib
import fcntl
import os
import pathlib
import re
import select
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time

COLUMNS = 100
COMMAND_SECONDS = 60
# What differs from run to run; lines that differ in nothing else are equal.
VARIES = [(re.compile(pattern), text) for pattern, text in [
    (r"\bin [0-9.]+ (us|ms|s)\b", "in TIME"), (r"[0-9.]+ frames/s", "RATE"), (r"\b[0-9.]+ ms$", "TIME"), (r"\bworld [0-9]+", "world N"),
    (r"\bpid [0-9]+", "pid N"), (r"\bdomain [0-9]+", "domain N"), (r"\bepoch [0-9]+", "epoch N"),
    (r"127\.0\.0\.1:[0-9]+", "ADDRESS"),
    # A tree that is fitted to what has moved has other nodes than one built anew; which it is depends on when the steps came.
    (r"\b[0-9]+ nodes? and", "N nodes and")]]
# A program in the background needs longer on a busy machine. Programs that are started later and do as much, one after the
# other, need longer by as much: they join, find the server and ask it.
SETTLE = "settle() { for _ in 1 2 3; do collide status --namespace collided -q; done >/dev/null 2>&1; }; "
SLEEP = SETTLE + "sleep() { command sleep \"$@\"; settle; }; "
# Statistics of a batch: times differ from run to run.
STATISTICS = re.compile(r"^ [0-9 ]+ (rays|spheres|boxes|points) |^     [0-9.]+ (us|ms|s): ")


def terminal():
    """A pseudo-terminal that passes lines on as they are written."""
    ours, theirs = os.openpty()
    modes = termios.tcgetattr(theirs)
    modes[1] &= ~termios.OPOST
    termios.tcsetattr(theirs, termios.TCSANOW, modes)
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 50, COLUMNS, 0, 0))
    return ours, theirs


def read_until_end(ours, process):
    """All that is written to the terminal up to a silence after the process's end; what takes too long is ended."""
    seen = bytearray()
    limit = time.monotonic() + COMMAND_SECONDS
    while True:
        has_ended = process.poll() is not None
        ready, _, _ = select.select([ours], [], [], 0.05)
        if ready:
            seen += os.read(ours, 65536)
        elif has_ended:
            return bytes(seen)
        elif time.monotonic() > limit:
            os.killpg(process.pid, signal.SIGKILL)
            return bytes(seen) + b"(did not end)\n"


def run(command, environment, folder):
    """The lines that a command writes, as they stand on the terminal in the end."""
    ours, theirs = terminal()
    program = SLEEP + command
    if command.startswith("cat "):  # it prints what such a program has written
        program = SETTLE + "settle; " + command
    elif command.startswith("until "):  # a loop waits for a condition of its own
        program = command
    process = subprocess.Popen(["bash", "-c", program], stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs,
                               env=environment, cwd=folder, start_new_session=True,
                               close_fds=False)  # what goes on in the background keeps the claim of its domain
    # Our end of what it writes to stays open: a terminal that nobody writes to any more may lose the last line.
    text = read_until_end(ours, process).decode()
    for end in (ours, theirs):
        os.close(end)
    process.wait()
    # A progress line is drawn over itself and erased.
    lines = [re.sub(r"\x1b\[[0-9;]*[A-Za-z]", "", line.split("\r")[-1]) for line in text.split("\n")]
    if lines and not lines[-1]:
        lines.pop()
    return [line.rstrip() for line in lines if not STATISTICS.match(line)]


def without_times(line):
    for pattern, text in VARIES:
        line = pattern.sub(text, line)
    return line.rstrip()


def start_server(collided, environment, folder):
    with open(os.path.join(folder, "server.out"), "wb") as said:
        server = subprocess.Popen([os.path.abspath(collided)], stdin=subprocess.DEVNULL, stdout=said, stderr=said, env=environment, cwd=folder)
    for _ in range(400):
        with open(os.path.join(folder, "server.out"), encoding="utf-8") as said:
            text = said.read()
        if re.search(r"^ready", text, re.MULTILINE):
            return server
        if server.poll() is not None:
            break
        time.sleep(0.05)
    sys.exit(f"the server does not serve:\n{text}")


def played(lines, environment, folder):
    """The document with what its commands print now, and how many commands and console blocks it has."""
    result, commands, blocks = [], 0, 0
    inside = shown = False
    k = 0
    while k < len(lines):
        line = lines[k]
        k += 1
        if line.startswith("```"):
            inside = not inside and line.startswith("```console")
            shown = False
            blocks += inside
        if not inside or not line.startswith("$ "):
            # What stands below a command in its block is what it printed; it is written anew.
            if not (inside and shown):
                result.append(line)
            continue
        command = [line]
        while command[-1].endswith("\\"):
            command.append(lines[k])
            k += 1
        result += command
        result += run("\n".join(command)[2:], environment, folder)
        commands += 1
        shown = True
    return result, commands, blocks


def last_words(folder):
    """The last lines of the texts that programs in the background wrote: why one of them is not there."""
    lines = []
    for path in sorted(pathlib.Path(folder).glob("*.txt")):
        lines += [f"{path.name}: {line}" for line in path.read_text(errors="replace").splitlines()[-6:]]
    return lines


def environment_for(arguments, folder):
    clean = {name: value for name, value in os.environ.items() if not name.startswith(("COLLIDE", "ROS_"))}
    programs = [os.path.dirname(os.path.abspath(p)) for p in (arguments.collided, arguments.collide)]
    clean.update(PATH=":".join(programs + [os.environ["PATH"]]), COLLIDED_DOMAIN=str(arguments.domain),
                 # On a busy machine a server that lives may say nothing for as long as a standby waits by default.
                 COLLIDED_TAKE_OVER_AFTER="2s", COLLIDED_STATE_DIR=os.path.join(folder, "state"), NO_COLOR="1", TERM="xterm", LC_ALL="C.UTF-8", TZ="UTC")
    return clean


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("doc", type=pathlib.Path)
    parser.add_argument("collided")
    parser.add_argument("collide")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--domain", type=int, default=201 + os.getpid() % 15)
    parser.add_argument("--least", type=int, default=1)
    parser.add_argument("--same", nargs=2, metavar=("MADE", "FILE"))
    arguments = parser.parse_args()
    lines = arguments.doc.read_text(encoding="utf-8").splitlines()
    deploy = pathlib.Path(__file__).resolve().parents[2] / "deploy"

    with tempfile.TemporaryDirectory() as scratch:
        folder = os.path.join(scratch, "here")
        for name in ("here", "state"):
            os.mkdir(os.path.join(scratch, name))
        os.symlink(deploy, os.path.join(folder, "deploy"))
        environment = environment_for(arguments, scratch)
        server = start_server(arguments.collided, environment, scratch)
        try:
            result, commands, blocks = played(lines, environment, folder)
            background = last_words(folder)
            if arguments.same and pathlib.Path(folder, arguments.same[0]).read_bytes() != pathlib.Path(arguments.same[1]).read_bytes():
                sys.exit(f"{arguments.same[0]}, as the commands made it, is not {arguments.same[1]}")
        finally:
            server.terminate()
            server.wait(20)

    if commands < arguments.least or (arguments.least == 0 and blocks):
        sys.exit(f"{arguments.doc.name} has {commands} commands in {blocks} console blocks; {arguments.least} are expected")
    if arguments.write:
        known = {without_times(line): line.rstrip() for line in lines}
        result = [known.get(without_times(line), line) for line in result]
        arguments.doc.write_text("\n".join(result) + "\n", encoding="utf-8")
        print(f"{arguments.doc.name}: {commands} commands written")
        return
    differences = list(difflib.unified_diff([without_times(line) for line in lines], [without_times(line) for line in result],
                                            arguments.doc.name, "what came out", lineterm=""))
    if differences:
        print("\n".join(differences + ["--- programs in the background", *background]))
        sys.exit(f"{arguments.doc.name} shows what the programs do not print")
    print(f"{commands} commands of {arguments.doc.name} print what it shows")


if __name__ == "__main__":
    main()
