"""What C++ can do, Python can do: members of answers, options, commands and calls are compared with the headers.

usage: parity_test.py SOURCES

Each exception below is needed: one that is no longer needed is a fault as well. At the end omissions are planted, and must be found.
"""

import dataclasses
import inspect
import pathlib
import re
import sys

import collided
from collided import _asking

# ---- exceptions ----------------------------------------------------------------------------------------------------------

# Structs that the C interface describes, or has as such.
NOT_DESCRIBED = {"Answer", "Answers", "Event", "Hit", "RecordedStandingEvents", "PublisherReport", "StandingEvent", "VoxelScan"}
# Structs without a class of their own.
NO_CLASS = {
    "Added", "Moved", "Removed", "RuleChanged", "Attached",  # the call returns the number that programs use
    "LoadOptions",  # arguments
    "OutlinedStanding",  # a picture: command("fences", outlines=True)
}
# Members that Python lacks.
NO_MEMBER = {
    "Answer": {"cost"},  # the C interface has no columns of it
    "Answers": {"answers", "server"},  # the answers are its items
    "ObjectDetails": {"bounds"},  # command("get") has them with null for a side without end
}
# Options that Python lacks.
NO_OPTION = {
    "ConnectOptions": {"etcd_keys"},  # for shard maps
    "ClearanceOptions": {"progress"},  # a function that the library calls, as the next two
    "ReplayOptions": {"go_on", "at_end"},
}
# Options of calls that Python lacks: pictures, shapes and shards are for programs in C++.
NO_CALL_WITH = {"PictureOptions", "ShapesOptions", "ShardSplitOptions"}
# Calls that the C interface lacks. command_with_bytes and upload take bytes, ask_async is a thread of the caller's own in Python.
NO_CALL = {
    "Client": {"shapes", "poses", "command_with_bytes", "upload", "strangers", "ask_async"},
    "Publisher": {"reshape"},
}
# Functions that the C interface lacks: `collide record` and `collide snapshot` write files, pictures are for viewers, fleet() has the findings,
# `collide fleet split` splits a shard, a PublishedRobot knows its links, what_if() of a robot and the check of a proof take structs.
NO_FUNCTION = {"record", "write_snapshot", "recorded_picture", "fleet_findings", "split_shard", "robot_objects", "what_if", "proves"}
# Commands that have no call of their own and are sent by command().
COMMAND_ALONE = {
    "audit", "menu", "figures", "steps", "recording", "covers", "accept_loss", "sampled", "handover", "watching", "shard",
    "succession",
}
# A command that the library sends for Publisher.report().
BY_C = {"left_out"}
# Their answers or questions are bytes, for which C has no function.
BYTES = {"shapes", "surface", "snapshot", "more", "poses", "upload", "piece"}
# Arguments that the calls of Python do not send.
NO_ARGUMENT = {
    "load": {"foreign", "crc32", "upload"},  # the library's own
    "list": {"bounds"},
    "fences": {"limit", "outlines", "lines"},
    "fence": {"prism", "many"},  # the shape goes as parts
    "attach": {"pose"},  # C++ lacks it as well
    "clearance": {"progress"},
}
# Names of C++ in Python.
RENAMED = {
    "lost_policy": "lost", "pose": "position", "base": "position", "solid_by_winding": "solid", "with_clearance": "clearance", "from": "from_ns",
    "since": "since_ns", "bracket_low": "bracket", "bracket_high": "bracket", "left_low": "left", "left_high": "left",
    "library_version": "version",
}
CALLS_OF = {"ask": "rays", "add": "add_region"}

# ---- calls ---------------------------------------------------------------------------------------------------------------

OPTIONS = {
    "ConnectOptions": [collided.connect],
    "AskOptions": [_asking._ask_options],
    "PairOptions": [collided.Client.pair],
    "ClearanceOptions": [collided.Client.clearance],
    "WhatIfOptions": [collided.Client.what_if, _asking._ask_options],
    "ExplainOptions": [getattr(collided.Client, f"explain_{what}") for what in ("ray", "pair", "standing", "event")],
    "WatchOptions": [collided.Client.watch],
    "StandingWatchOptions": [collided.Client.watch_standing],
    "PublishOptions": [collided.Client.publish],
    "ObjectOptions": [collided.Publisher.add],
    "VoxelOptions": [collided.Publisher.voxels],
    "PublishedRobotOptions": [collided.Publisher.robot],
    "LoadOptions": [collided.Client.load],
    "ClearOptions": [collided.Client.clear],
    "ListOptions": [collided.Client.list],
    "RecordedEventsOptions": [collided.recorded_events, collided.recorded_standing_events],
    "ReplayOptions": [collided.replay],
}
# Each call of Python that sends a command, with everything that it can send.
SENT = [
    lambda c: c.load("a.obj", solid="*", solid_by="winding", packages=["a=/b"], moving=True, covers=[[0, 0, 0, 1, 1, float("inf")]]),
    lambda c: c.clear("a", moving=True),
    lambda c: c.list("a", moving=True),
    lambda c: c.get("a"),
    lambda c: c.rules(),
    lambda c: c.plan(),
    lambda c: c.add_probe("a", "b", reach=2),
    lambda c: c.remove_probes("a"),
    lambda c: c.probes("a"),
    lambda c: c.pair("a", "b", opinion="fcl"),
    lambda c: c.clearance("a", "b", nearer=2),
    lambda c: c.explain_ray((0, 0, 0), (0, 0, 1), 2),
    lambda c: c.explain_pair("a", "b", last=2),
    lambda c: c.explain_standing("a"),
    lambda c: c.explain_event(2),
    lambda c: c.standing("a", "region"),
    lambda c: c.add("a", collided.Sphere(1), solid="winding"),
    lambda c: c.move("a", (0, 0, 1)),
    lambda c: c.remove("a"),
    lambda c: c.attach("a", "b"),
    lambda c: c.detach("a"),
    lambda c: c.allow("a", "b", "c"),
    lambda c: c.deny("a", "b"),
    lambda c: c.add_region("a", collided.Sphere(1), to="b", only="c", skip="d"),
    lambda c: c.add_bands("a", "b", "c", (1, 2), skip="d"),
    lambda c: c.add_nearest("a", "b", "c", 1),
    lambda c: c.add_nearest("a", "b", (0, 0, 1), 1),
    lambda c: c.remove_standing("a", "region"),
]


class Recorder(collided.Client):
    """A client without a server: it keeps the commands that it is given."""

    _kept = None

    def __init__(self):
        self.commands = []

    def _command(self, name, arguments, timeout=10.0, parts=None):
        self.commands.append((name, set(arguments)))
        return {"rules": [], "probes": [], "standing": [], "ended": 0, "began": 0, "id": 1, "removed": [] if name == "remove" else 0}


def commands_sent():
    client = Recorder()
    for call in SENT:
        call(client)
    return client.commands


# ---- what the headers declare --------------------------------------------------------------------------------------------


def block(text, head):
    """What stands in the braces after a head; nothing where there is none."""
    found = re.search(head + r"[^{};]*\{\n(.*?)^\};", text, re.MULTILINE | re.DOTALL)
    return found[1] if found else None


def members(text, struct):
    """The data members of a struct, those of structs within it left out."""
    inner = re.compile(r"^  (?:struct [^\n]*\n.*?^  \}|enum [^\n]*\});\n", re.MULTILINE | re.DOTALL)
    body = inner.sub("", block(text, rf"^struct {struct}\b") or "")
    named = set()
    for declared in re.sub(r"\{[^{}]*\}", "", body).split(";"):
        head = declared.partition("=")[0].strip()
        if head and not head.endswith((")", "const")) and not head.startswith(("using", "static", "friend")):
            named.update(re.findall(r"[\w>] (\w+(?:, \w+)*)$", " ".join(head.split()))[0].split(", "))
    return named


def bare(member):
    return re.sub("_(m|mps|s)$", "", member)


def python_names(kind):
    if dataclasses.is_dataclass(kind):
        return {field.name.removesuffix("_").removesuffix("_ns") for field in dataclasses.fields(kind)}
    return {name.removesuffix("_ns") for name in vars(kind) if not name.startswith("_")}


def tables(text):
    """The arguments of each command, of all its forms together."""
    words = dict(re.findall(r'constexpr const char\* (k\w+) = "(\w+)"', text))
    shared = dict(re.findall(r'ArgumentSpec (k\w+)\{\s*"(\w+)",', text))
    lists = {name: set(re.findall(r'\{"(\w+)", [a-z]', body)) | {shared[each] for each in re.findall(r"\bk\w+", body) if each in shared}
             for name, body in re.findall(r"ArgumentSpec (k\w+)\[\]\{(.*?)\};", text, re.DOTALL)}
    forms = {name: set().union(*(lists[each] for each in re.findall(r"arguments::(k\w+)", body)))
             for name, body in re.findall(r"CommandForm (k\w+)\[\]\{(.*?)\};", text, re.DOTALL)}
    rows = re.findall(r"^    \{(k\w+), (.*)\},$", block(text, r"CommandSpec kCommands\[\]"), re.MULTILINE)
    return {words[name]: set().union(*(lists.get(each, set()) | forms.get(each, set()) for each in re.findall(r"k\w+", rest)))
            for name, rest in rows}


# ---- faults --------------------------------------------------------------------------------------------------------------


def compared(what, wanted, there, exceptions):
    """One sentence for each name that is missing without an exception, and for each exception that is not needed."""
    missing = {name for name in wanted if RENAMED.get(name, name) not in there and name not in there}
    yield from (f"{what}: Python lacks {name}" for name in sorted(missing - exceptions))
    yield from (f"{what}: the exception {name} is not needed" for name in sorted(exceptions - missing))


def member_faults(text):
    described = set(re.findall(r"fields_of\(const (\w+)\*\)", text)) | NOT_DESCRIBED
    structs = {name for name in described if re.search(rf"^struct {name}\b", text, re.MULTILINE)}
    yield from compared("classes", structs, set(collided.__all__), NO_CLASS)
    for name in sorted(structs - NO_CLASS):
        if hasattr(collided, name):
            wanted = {bare(member) for member in members(text, name)}
            yield from compared(name, wanted, python_names(getattr(collided, name)), NO_MEMBER.get(name, set()))


def option_faults(text):
    structs = set(re.findall(r"^struct (\w+Options)\b", text, re.MULTILINE))
    yield from compared("options", structs, set(OPTIONS), NO_CALL_WITH)
    for name in sorted(structs & set(OPTIONS)):
        there = {parameter for call in OPTIONS[name] for parameter in inspect.signature(call).parameters}
        there |= {parameter.removesuffix("_ns") for parameter in there}
        yield from compared(name, {bare(member) for member in members(text, name)}, there, NO_OPTION.get(name, set()))


def call_faults(text):
    for name, exceptions in NO_CALL.items():
        public = block(text, rf"^class {name}\b").partition("private:")[0]
        calls = set(re.findall(r"^  (?:static )?(?!explicit|friend)(?! |return)[\w:<>, ]+[>\w] (\w+)\(", public, re.MULTILINE))
        yield from compared(name, calls - {"connect"}, set(dir(getattr(collided, name))) | {each for each, of in CALLS_OF.items() if
                            hasattr(getattr(collided, name), of)}, exceptions)


def function_faults(text):
    functions = set(re.findall(r"^(?!using|struct|class|inline)[A-Za-z][\w:<>, ]*[>\w] (\w+)\([^;]*?\);", text, re.MULTILINE))
    yield from compared("functions", functions, set(collided.__all__), NO_FUNCTION)


def command_faults(text, sent):
    table = tables(text)
    typed = {name for name, _ in sent}
    yield from compared("commands", set(table), typed, COMMAND_ALONE | BY_C | BYTES)
    for name in sorted(typed):
        given = set().union(*(arguments for each, arguments in sent if each == name))
        if name not in table or not given <= table[name]:
            yield f"{name}: the server does not know {sorted(given - table.get(name, set()))}"
        else:
            yield from compared(name, table[name], given, NO_ARGUMENT.get(name, set()))


def faults(text):
    return [*member_faults(text), *option_faults(text), *call_faults(text), *function_faults(text), *command_faults(text, commands_sent())]


# Text of the headers, what it becomes, and the fault that this is.
PLANTED = [
    ("struct PairAnswer {\n", "struct PairAnswer {\n  double planted_m = 0;\n", "PairAnswer: Python lacks planted"),
    ("struct Event {\n", "struct Event {\n  std::chrono::nanoseconds planted{0};\n", "Event: Python lacks planted"),
    ("struct ClearanceOptions {\n", "struct ClearanceOptions {\n  bool planted = false;\n", "ClearanceOptions: Python lacks planted"),
    ("struct ListOptions {\n", "struct PlantedOptions {\n};\nstruct ListOptions {\n", "options: Python lacks PlantedOptions"),
    ("struct ClearanceOptions {\n", "struct ClearanceOptions {\n};\nstruct Other {\n", "ClearanceOptions: the exception progress is not needed"),
    ("    {kGet, ask,", "    {kTakeOver, ask, nothing, all},\n    {kGet, ask,", "commands: Python lacks take_over"),
    ('kPair[]{{"a", text},', 'kPair[]{{"planted", text},', "pair: the server does not know ['a']"),
    ('kGet[]{{"name", text}};', 'kGet[]{{"name", text}, {"planted", truth}};', "get: Python lacks planted"),
    ("Result<Fleet> fleet(", "Result<void> planted(int number);\nResult<Fleet> fleet(", "functions: Python lacks planted"),
    ("  Result<ServerStatus> status();", "  Result<void> planted();\n  Result<ServerStatus> status();", "Client: Python lacks planted"),
]


def main(sources):
    sources = pathlib.Path(sources)
    def text_of(*patterns):
        return "\n".join(path.read_text(encoding="utf-8") for pattern in patterns for path in sorted(sources.glob(pattern)))

    # Structs that idl/answers has itself are the command line's; command() has them in Python.
    described = re.findall(r"fields_of\(const \w+\*\)", text_of("idl/answers/*.hpp", "client/library/watching/probes.hpp",
                                                                           "client/library/connection/described_status.hpp"))
    headers = text_of("client/include/collided/*.hpp", "idl/include/collided/*.hpp", "idl/command_table.hpp", "idl/commands.hpp")
    text = "\n".join([*described, re.sub(r"//[^\n]*", "", headers)])
    found = faults(text)
    for before, after, fault in PLANTED:
        if text.count(before) != 1:
            found.append(f"{before!r} is there {text.count(before)} times, so nothing was planted")
        elif fault not in faults(text.replace(before, after)):
            found.append(f"planted, and not found: {fault}")
    print("\n".join(found) or f"{len(tables(text))} commands and {len(OPTIONS)} kinds of options compared, {len(PLANTED)} omissions found")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
