#!/usr/bin/python3
"""The manifests of deploy/fleet/kubernetes.yaml hold what Kubernetes' schemas allow, and settings and commands that Collided has. Mistakes
are planted, and must be found. No cluster is reached.

usage: kubernetes.py COLLIDED COLLIDE FOLDER NODE_MODULES_PARENT
"""

import copy
import json
import os
import re
import subprocess
import sys
import tempfile

import yaml

COLLIDED, COLLIDE, FOLDER, MODULES = sys.argv[1:5]
SCHEMA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "kubernetes_schema.mjs")


def schema_faults(manifests):
    checked = subprocess.run(["node", SCHEMA], input=json.dumps(manifests), cwd=MODULES, text=True, capture_output=True, check=False)
    if checked.returncode == 77:
        print(checked.stdout.strip())
        sys.exit(77)
    return checked.stdout.splitlines() + checked.stderr.splitlines()


def named(manifests, kind, name):
    return next(each for each in manifests if each["kind"] == kind and each["metadata"]["name"] == name)


def server_settings(manifests):
    """The variables that the container of the members gets, as it would see them."""
    container = named(manifests, "StatefulSet", "collided")["spec"]["template"]["spec"]["containers"][0]
    given = {}
    for source in container["envFrom"]:
        given.update(named(manifests, "ConfigMap", source["configMapRef"]["name"])["data"])
    for variable in container["env"]:
        given[variable["name"]] = variable.get("value", "collided-0")  # valueFrom: the pod's name
    return container, given


def setting_faults(manifests):
    _, given = server_settings(manifests)
    with tempfile.TemporaryDirectory() as state:
        environment = {**os.environ, **given, "COLLIDED_STATE_DIR": state}
        checked = subprocess.run([COLLIDED, "--check-config"], env=environment, text=True, capture_output=True, check=False)
        shown = subprocess.run([COLLIDED, "--print-config"], env=environment, text=True, capture_output=True, check=False)
    if checked.returncode != 0:
        yield checked.stderr.strip()
    # A variable that no option has would be passed over.
    yield from (f"{name} is in effect nowhere" for name in given if not re.search(rf"\b{name}\b", shown.stdout))


def command_faults(manifests):
    """Every `collide` of a probe or hook is a verb with options that it has."""
    container, _ = server_settings(manifests)
    scripts = [container[probe]["exec"]["command"][-1] for probe in ("readinessProbe", "startupProbe")]
    scripts.append(container["lifecycle"]["preStop"]["exec"]["command"][-1])
    for script in scripts:
        for command in re.findall(r"collide ([^|&]+)", script):
            verb, *words = command.split()
            # The options must be read before --help ends the line.
            asked = subprocess.run([COLLIDE, verb, *words, "--help"], text=True, capture_output=True, check=False)
            known = asked.stdout + subprocess.run([COLLIDE, "help", "options"], text=True, capture_output=True, check=False).stdout
            if asked.returncode != 0:
                yield f"collide {verb}: {asked.stderr.strip()}"
            yield from (f"collide {verb} has no {word}" for word in words if word.startswith("--") and word not in known)


def link_faults(manifests):
    """Selectors find their pods, and names of members are those that the services give."""
    sets = {each["metadata"]["name"]: each["spec"] for each in manifests if each["kind"] == "StatefulSet"}
    for name, spec in sets.items():
        labels = spec["template"]["metadata"]["labels"]
        service = named(manifests, "Service", spec["serviceName"])["spec"]
        if spec["selector"]["matchLabels"] != labels or service["selector"] != labels:
            yield f"{name}: its selectors do not find its pods"
        if not service.get("publishNotReadyAddresses"):
            yield f"{name}: a member that is not ready has no name"
    _, given = server_settings(manifests)
    hosts = {f"{name}-{i}.{spec['serviceName']}" for name, spec in sets.items() for i in range(spec["replicas"])}
    asked = set(given["COLLIDED_PEERS"].split(",")) | set(re.findall(r"([\w.-]+):2379", given["COLLIDED_AUTHORITY"]))
    asked |= set(re.findall(r"//([a-z][\w.-]+):2380", json.dumps(manifests)))
    if asked != hosts:
        yield f"names {sorted(asked)}, members {sorted(hosts)}"


def faults(manifests):
    # The others read fields that the schemas require.
    return schema_faults(manifests) or [*setting_faults(manifests), *command_faults(manifests), *link_faults(manifests)]


def planted(manifests):
    """Manifests with a mistake each, and what must be said of it."""
    def changed(change, said):
        copied = copy.deepcopy(manifests)
        change(copied)
        return copied, said

    def members(copied):
        return named(copied, "StatefulSet", "collided")["spec"]

    yield changed(lambda m: members(m).update(replica=2), "/spec/replica")
    yield changed(lambda m: members(m).pop("selector"), "selector")
    yield changed(lambda m: members(m).update(replicas="two"), "replicas")
    yield changed(lambda m: named(m, "ConfigMap", "collided")["data"].update(COLLIDED_PEER="a"), "COLLIDED_PEER ")
    yield changed(lambda m: named(m, "ConfigMap", "collided")["data"].update(COLLIDED_AUTHORITY_LEASE="soon"), "soon")
    yield changed(lambda m: members(m).update(replicas=3), "collided-2.collided")
    container = "collide fleets --plain"
    yield changed(lambda m: members(m)["template"]["spec"]["containers"][0]["readinessProbe"]["exec"].update(command=["sh", "-c", container]),
                  "fleets")


def main():
    with open(os.path.join(FOLDER, "kubernetes.yaml"), encoding="utf-8") as file:
        manifests = list(yaml.safe_load_all(file))
    found = faults(manifests)
    count = 0
    for wrong, said in planted(manifests):
        count += 1
        missed = [line for line in faults(wrong) if said in line]
        if not missed:
            found.append(f"planted, and not found: {said}")
    print("\n".join(found) or f"{len(manifests)} manifests are what Kubernetes and Collided take; {count} planted mistakes found")
    return 1 if found else 0


sys.exit(main())
