#!/usr/bin/python3
"""The fleet of deploy/fleet/compose.yaml, as processes on this machine instead of containers: comes up as it says, outlives its
primary's death and that of etcd's leader, and takes back what was started again. The files for systemd hold options that are there.

usage: fleet.py COLLIDED COLLIDE FOLDER DOMAIN
"""

import json
import os
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

import yaml

COLLIDED, COLLIDE, FOLDER, DOMAIN = sys.argv[1:5]
PATIENCE_S = 60


def fail(what):
    raise SystemExit(f"fleet.py: {what}")


def until(fleet, what, holds):
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        fleet.start_again()
        found = holds()
        if found:
            return found
        time.sleep(0.1)
    fail(f"not within {PATIENCE_S} s: {what}; there are {members('hall') | members('yard')}")


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Fleet:
    """The services of a compose file. Ports and folders are this test's own, so that it may run beside others."""

    def __init__(self, services, folder):
        text = json.dumps(services)
        ports = sorted(set(re.findall(r"127\.0\.0\.1:(\d+)", text)))
        for port, own in zip(ports, [free_port() for _ in ports]):
            text = re.sub(rf"127\.0\.0\.1:{port}\b", f"127.0.0.1:own_{own}", text)
        self.services = json.loads(text.replace("own_", ""))
        self.folder = folder
        self.processes = {}

    def environment(self, name):
        given = self.services[name].get("environment", {})
        own = {"COLLIDED_DOMAIN": DOMAIN, "COLLIDED_INTERFACE": "lo"}
        # On a crowded machine a server that lives may seem dead for 200 ms.
        own["COLLIDED_TAKE_OVER_AFTER"] = "2s"
        plain = {key: value for key, value in os.environ.items() if not key.startswith("COLLIDED_")}
        return plain | given | own | {"COLLIDED_STATE_DIR": os.path.join(self.folder, name)}

    def start(self, name):
        if name.startswith("etcd"):
            words = ["etcd"] + [os.path.join(self.folder, name) if word == "/var/lib/etcd" else word
                                for word in self.services[name]["command"]]
        else:
            words = [COLLIDED]
        log = open(os.path.join(self.folder, name + ".log"), "ab")
        self.processes[name] = subprocess.Popen(words, env=self.environment(name), stdout=log, stderr=log)

    def kill(self, name):
        self.processes[name].kill()
        self.processes[name].wait()
        del self.processes[name]

    def start_again(self):
        """What `restart: always` does: one that gives way, or finds the place taken, ends by itself."""
        for name, process in list(self.processes.items()):
            if process.poll() is not None:
                self.start(name)

    def end(self):
        for process in self.processes.values():
            process.kill()
        for process in self.processes.values():
            process.wait()

    def logs(self):
        for name in self.services:
            with open(os.path.join(self.folder, name + ".log"), errors="replace") as log:
                print(f"== {name}\n" + "".join(log.readlines()[-12:]))


def members(namespace):
    asked = subprocess.run([COLLIDE, "fleet", "--namespace", namespace, "--fields", "name,role,state", "--plain"], text=True,
                           env=os.environ | {"COLLIDED_DOMAIN": DOMAIN}, capture_output=True, check=False)
    return {tuple(line.split("\t")) for line in asked.stdout.splitlines()}


def roles(namespace):
    return sorted(role for _, role, state in members(namespace) if state == "ready")


def primary(namespace):
    return next((name for name, role, state in members(namespace) if role == "primary" and state == "ready"), None)


def ask(namespace):
    asked = subprocess.run([COLLIDE, "ray", "0", "0", "5", "0", "0", "-1", "--namespace", namespace, "--fields", "answer,object"],
                           text=True, env=os.environ | {"COLLIDED_DOMAIN": DOMAIN}, capture_output=True, check=False)
    if asked.stdout.strip() != "hit\twarehouse/shelf_3/top":
        fail(f"{namespace} answers {asked.stdout!r} {asked.stderr!r}")


def check_units():
    for name in ("member.conf", "replica.conf"):
        with open(os.path.join(FOLDER, name)) as file:
            lines = [line for line in file.read().splitlines() if re.match(r"#?Environment=", line)]
        given = dict(word.split("=", 1) for line in lines for word in shlex.split(line.split("=", 1)[1]))
        if len(given) < 3:
            fail(f"{name} gives {given}")
        given = {key: value.replace("%H", "machine") for key, value in given.items()}
        with tempfile.TemporaryDirectory() as state:
            checked = subprocess.run([COLLIDED, "--check-config", "--state-dir", state], env=os.environ | given, text=True,
                                     capture_output=True, check=False)
            shown = subprocess.run([COLLIDED, "--print-config", "--state-dir", state], env=os.environ | given, text=True,
                                   capture_output=True, check=False)
        if checked.returncode != 0:
            fail(f"{name}: {checked.stderr}")
        # A variable that no option has would be passed over.
        for key in given:
            if key not in shown.stdout:
                fail(f"{name}: {key} is in effect nowhere:\n{shown.stdout}")


def live_through_it(fleet):
    for name in fleet.services:
        fleet.start(name)
    whole = ["primary", "replica", "standby"]
    for namespace in ("hall", "yard"):
        until(fleet, f"all of {namespace} are ready", lambda: roles(namespace) == whole)
        ask(namespace)
    first = primary("hall")
    fleet.kill(first)
    second = until(fleet, "another is primary", lambda: (primary("hall") or first) != first and primary("hall"))
    ask("hall")
    fleet.start(first)
    until(fleet, "the fleet is whole again", lambda: roles("hall") == whole and primary("hall") == second)
    # Two of three etcd are enough.
    fleet.kill("etcd_1")
    time.sleep(5)
    for namespace in ("hall", "yard"):
        until(fleet, f"{namespace} goes on", lambda: roles(namespace) == whole)
        ask(namespace)
    if primary("hall") != second:
        fail(f"the death of one etcd made {primary('hall')} the primary")


def main():
    if not shutil.which("etcd"):
        print("skipped: no etcd; apt-get install etcd-server")
        return 77
    check_units()
    with open(os.path.join(FOLDER, "compose.yaml")) as file:
        services = yaml.safe_load(file)["services"]
    with tempfile.TemporaryDirectory(prefix="collided_test_fleet_") as folder:
        fleet = Fleet(services, folder)
        try:
            live_through_it(fleet)
        except BaseException:
            fleet.logs()
            raise
        finally:
            fleet.end()
    print("the fleet came up, outlived its primary and one etcd, and was whole again")
    return 0


signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
sys.exit(main())
