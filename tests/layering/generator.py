#!/usr/bin/env python3
"""What the generators make of small IDL files (idl/generate.py) and small headers (client/generate.py, client/generate_answers.py),
word by word.  generator.py SOURCES"""
import importlib.util
import pathlib
import sys
import tempfile

IDL = """\
module a { module b {
  // How it went. GONE_BY: it is over.
  enum Course { COURSE_NONE, COURSE_GONE_BY };
  // Bits of a course. FAST: it was quick.
  const octet COURSE_FAST = 1;
  const unsigned long long COURSE_ENDLESS = 18446744073709551615;
  // In place of a triangle.
  const unsigned long NO_TRIANGLE = 4294967295;

  // Topic course.
  @final struct Courses {
    @key unsigned long long server;     // random
    string<255> name;                   // of all; empty: none
    double start[3];                    // m
    sequence<octet> kinds;              // Course
    sequence<double> points;            // 3 each, m
    sequence<double> lengths;           // m
    sequence<octet> names;              // one each, zero-terminated
  };
}; };
"""
CLIENT_IDL = """\
module a { module client {
  enum Verdict { VERDICT_MISS };
  // Why a contact ended. GONE_BY: it is over.
  enum EndReason { END_NONE, END_GONE_BY };
}; };
"""
CODES = [
    "/// How it went. gone_by: it is over.\nenum class Course : std::uint8_t { none, gone_by };",
    'constexpr std::string_view kNames[] = {"", "gone_by"};',
    "template <>\ninline constexpr std::uint8_t kCodeCount<Course> = 2;",
    "return is_known<Course>(static_cast<std::uint8_t>(code)) ? ",
    "/// Bits of a course. FAST: it was quick.\ninline constexpr std::uint8_t kCourseFast = 1;",
    "inline constexpr std::uint64_t kCourseEndless = 18446744073709551615U;",
    "enum class EndReason : std::uint8_t { none, gone_by };",
]
C_CODES = [
    "typedef int32_t collided_verdict;\nenum { COLLIDED_MISS = 0 };\n",
    "/* Why a contact ended. GONE_BY: it is over. */\ntypedef int32_t collided_end_reason;\n"
    "enum { COLLIDED_END_NONE = 0, COLLIDED_END_GONE_BY = 1 };\n",
    "/* In place of a triangle. */\n#define COLLIDED_NO_TRIANGLE 4294967295u\n",
]
PYTHON = ["COURSE = ('', 'gone_by')\nVERDICT = ('miss',)\n", "COURSE_FAST = 1\n"]
MESSAGES = [
    "field(s.server); field(s.name); field(s.start); field(s.kinds); field(s.points); field(s.lengths); field(s.names);",
    "struct CoursesColumns {\n  using Message = Courses;\n  std::vector<std::uint8_t> kinds;\n  std::vector<double> points;\n",
    "visit(&Courses::kinds, &CoursesColumns::kinds, 1U);\n    visit(&Courses::points, &CoursesColumns::points, 3U);\n",
    "visit(&Courses::lengths, &CoursesColumns::lengths, 1U);\n    visit(&Courses::names, &CoursesColumns::names, 0U);\n",
    "void put_row(CoursesColumns& to, const Row& row) {\n  if constexpr (requires { put(to.kinds, row.kind); }) put(to.kinds, row.kind);\n",
    "  if constexpr (requires { take(from.points, i, row.point); }) take(from.points, i, row.point);\n"
    "  if constexpr (requires { take(from.lengths, i, row.length_m); }) take(from.lengths, i, row.length_m);\n}",
]

EVENTS_HPP = """\
using codes::EndReason;
using EventKind = codes::CourseEventKind;

/// News of a course.
struct Event {
  EventKind kind = EventKind::began;
  EndReason reason = EndReason::none;  // why
  /// Two lines before it
  /// are one.
  bool resync = false;
  std::string from;
  std::uint64_t a_id = 0;
  std::uint32_t a_triangle = kNoTriangle;
  std::chrono::nanoseconds world_time{0};  // of the step
  double bracket_low_s = 0;                // between these
  double bracket_high_s = 0;
  double depth_m = 0;
  Vec3 point = Vec3::Zero();
  struct Forecast {
    double low_s = 0;
    double high_s = 0;
  };
  std::optional<Forecast> contact_in = {};
};
"""
COLLIDED_H = """\
typedef enum collided_code { COLLIDED_OK = 0, COLLIDED_BAD = 2 } collided_code;
typedef struct collided_client collided_client;
typedef struct collided_options {
  uint32_t size; /* a comment; with a semicolon */
  collided_lost_policy lost;
  const char* name;
  const char* const* peers;
  const double* bands;
  char message[16];
} collided_options;
COLLIDED_API const char* collided_version(void);
COLLIDED_API int collided_ask(collided_client* client, const double* rays, const collided_options* options,
                              collided_client** out);
"""
LENDING = {
    "include/collided/events.h": [
        "/* News of a course. */\ntypedef struct collided_event {\n  uint32_t size;\n  collided_course_event_kind kind;\n"
        "  /* why */\n  collided_end_reason reason;\n  /* Two lines before it are one. */\n  int32_t resync;\n  const char* from;\n",
        "  int32_t has_contact_in;\n  double contact_in_low_s;\n  double contact_in_high_s;\n} collided_event;\n",
    ],
    "client/library/c/event_fields.hpp": [
        "constexpr auto fields_of(const Event::Forecast*) {\n  using T = Event::Forecast;\n  return fields<&T::low_s, &T::high_s>();\n}\n",
        "constexpr auto fields_of(const Event*) {\n  using T = Event;\n  return fields<&T::kind, &T::reason, &T::resync, &T::from, ",
        "inline collided_event lent(const Event& event) {\n  collided_event told{};\n  told.size = sizeof told;\n"
        "  told.kind = static_cast<std::int32_t>(event.kind);\n",
        "  told.from = event.from.c_str();\n",
        "  told.world_time_ns = event.world_time.count();\n  told.bracket_low_s = event.bracket_low_s;\n",
        "  put(event.point, told.point);\n  told.has_contact_in = event.contact_in ? 1 : 0;\n"
        "  if (event.contact_in) told.contact_in_low_s = event.contact_in->low_s;\n",
    ],
    "client/python/collided/_events.py": [
        '    """News of a course.\n\n    kind\n    reason         why\n    resync         Two lines before it are one.\n'
        "    from_\n    a_id\n    a_triangle\n    world_time_ns  of the step\n    bracket        between these\n    depth\n",
        '    resync: bool\n    from_: str = field(metadata={"json": "from"})\n    a_id: int\n    a_triangle: int | None\n    world_time_ns: int\n'
        '    bracket: tuple[float, float] = field(metadata={"json": "", "ends": ("bracket_low_s", "bracket_high_s")})\n    depth: float\n',
        '    contact_in: tuple[float, float] | None = field(metadata={"ends": ("low_s", "high_s")})\n',
    ],
    "client/python/collided/_structs.py": [
        "OK = 0\nBAD = 2\n",
        '        ("world_time_ns", c_int64),\n',
        'class COptions(Structure):\n    _fields_ = [\n        ("size", c_uint32),\n        ("lost", c_int32),\n'
        '        ("name", c_char_p),\n        ("peers", POINTER(c_char_p)),\n        ("bands", c_void_p),\n'
        '        ("message", c_char * 16),\n    ]\n',
        '    "version": (c_char_p, []),\n    "ask": (c_int32, [c_void_p, c_void_p, POINTER(COptions), c_void_p]),\n',
    ],
}

ANSWERS_HPP = """\
using codes::Course;

/// A course in one of two ways:
/// straight     it goes to
///              its end_m
/// round, bent  else
struct Ride {
  /// In a struct.
  struct Stop {
    double at_m = 0;
  };
  using Stops = std::vector<Stop>;
  enum class Way { straight, round };
  Verdict verdict = Verdict::miss;
  Course course = Course::none;  // see Ride::way
  Way way = Way::straight;
  std::uint32_t a_triangle = kNoTriangle;
  std::string from =
      {};  // where it begins
  Stops stops = {};
  std::optional<Vec3> end_m = {};
  std::chrono::nanoseconds world_time{0};
  bool secret = false;
  std::chrono::nanoseconds age{0};
};
struct Trip : Ride {
  Ride::Stop last = {};
  std::array<double, 2> ends = {};
};
"""
ANSWERS = """\
template <>
inline constexpr const char* kWordsOf<Course>[] = {"", "gone"};
constexpr auto fields_of(const Ride::Stop*) { return fields<&Ride::Stop::at_m>(); }
constexpr auto fields_of(const Ride*) {
  using T = Ride;
  return listed(field("answer", &T::verdict), field_if<is_any_of<one, two>>("course", &T::course),
                fields_if<&T::secret, &T::way, &T::a_triangle>(), unless_default<&T::from>(), fields<&T::stops, &T::end_m>(),
                field("time_ns", &T::world_time), in_seconds<&T::age>());
}
constexpr auto fields_of(const Trip*) {
  return listed(fields_of(static_cast<const Ride*>(nullptr)), fields<&Trip::ends>());
}
"""
SCHEMA = [
    '@dataclass(frozen=True)\nclass RideStop:\n    """In a struct.\n\n    at\n    """\n\n    at: float\n\n\n@dataclass',
    'class Ride(Judged):\n    """A course in one of two ways:\n      straight  it goes to its end\n      round, bent  else\n\n'
    "    verdict\n    course         see Ride.way\n    way\n    a_triangle\n    from_          where it begins\n",
    '    verdict: Verdict = field(metadata={"json": "answer"})\n'
    '    course: str = field(metadata={"words": dict(zip(("", "gone"), COURSE))})\n    way: str\n    a_triangle: int | None\n'
    '    from_: str = field(metadata={"json": "from"})\n    stops: tuple[RideStop, ...]\n    end: Vector | None\n'
    '    world_time_ns: int = field(metadata={"json": "time_ns"})\n    age_ns: int\n\n\n@dataclass',
    'class Trip(Ride):\n    """\n\n    last\n    ends\n    """\n\n    last: RideStop = field(metadata={"json": ""})\n'
    "    ends: tuple[float, float]\n",
]


def module_at(place):
    spec = importlib.util.spec_from_file_location(place.parent.name, place)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def lacking(build, expected):
    texts = {output: (build / output).read_text(encoding="utf-8") for output in expected}
    return [f"{output} lacks\n{piece}" for output, pieces in expected.items() for piece in pieces if piece not in texts[output]]


def lending_faults(generate):
    generate.EVENTS = {"Event": "events.hpp"}
    with tempfile.TemporaryDirectory() as folder:
        build, events = pathlib.Path(folder), pathlib.Path(folder) / "collided" / "events.hpp"
        events.parent.mkdir()
        events.write_text(EVENTS_HPP, encoding="utf-8")
        (build / "collided.h").write_text(COLLIDED_H, encoding="utf-8")
        generate.main(build, build)
        faults = lacking(build, LENDING)
        events.write_text(EVENTS_HPP.replace("double depth_m = 0", "std::vector<double> depths"), encoding="utf-8")
        try:
            generate.main(build, build)
            faults.append("a member of an unknown type was taken")
        except SystemExit as refused:
            if "vector<double>" not in str(refused):
                faults.append(f"the refusal of an unknown type says {refused}")
    return faults


def answer_faults(generate):
    generate.BY_C, generate.DESCRIPTIONS = (), ("idl/answers",)
    with tempfile.TemporaryDirectory() as folder:
        build = pathlib.Path(folder)
        header, description = build / "idl/include/collided/ride.hpp", build / "idl/answers/ride.hpp"
        for place, text in ((header, ANSWERS_HPP), (description, ANSWERS)):
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(text, encoding="utf-8")
        generate.main(build, build)
        faults = lacking(build, {"client/python/collided/_schema.py": SCHEMA})
        header.write_text(ANSWERS_HPP.replace("std::optional<Vec3>", "std::set<Vec3>"), encoding="utf-8")
        try:
            generate.main(build, build)
            faults.append("a member of an unknown type was taken")
        except SystemExit as refused:
            if "set<Vec3>" not in str(refused):
                faults.append(f"the refusal of an unknown type says {refused}")
    return faults


def main(sources):
    generate = module_at(pathlib.Path(sources) / "idl" / "generate.py")
    expected = {"include/collided/codes.hpp": CODES, "include/collided/codes.h": C_CODES, "idl/messages.hpp": MESSAGES,
                "client/python/collided/_contract.py": PYTHON}
    client = pathlib.Path(sources) / "client"
    sys.path.insert(0, str(client))
    sys.dont_write_bytecode = True
    faults = lending_faults(module_at(client / "generate.py")) + answer_faults(module_at(client / "generate_answers.py"))
    with tempfile.TemporaryDirectory() as folder:
        build = pathlib.Path(folder)
        idl, client_idl = build / "a.idl", build / "client.idl"
        idl.write_text(IDL, encoding="utf-8")
        client_idl.write_text(CLIENT_IDL, encoding="utf-8")
        generate.main(build, idl, client_idl)
        faults += lacking(build, expected)
        if "COURSE" in (build / "include/collided/codes.h").read_text(encoding="utf-8"):
            faults.append("C has codes that its interface does not use")
        codes = build / "include/collided/codes.hpp"
        before = codes.stat().st_mtime_ns
        generate.main(build, idl, client_idl)
        if codes.stat().st_mtime_ns != before:
            faults.append("an unchanged output was written again, and everything would be compiled again")
        idl.write_text("module a { };", encoding="utf-8")
        try:
            generate.main(build, idl)
            faults.append("a file without enumerations was taken")
        except SystemExit as refused:
            if "no enumerations" not in str(refused):
                faults.append(f"the refusal says {refused}")
    print("\n".join(faults) or f"{sum(map(len, [*expected.values(), *LENDING.values(), SCHEMA]))} pieces as expected")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
