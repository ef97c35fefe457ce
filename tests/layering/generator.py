#!/usr/bin/env python3
"""What idl/generate.py makes of small IDL files, word by word.  generator.py SOURCES"""
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
PAGE = [
    'const kCourse = ["", "gone_by"];\n',
    "const kCourseFast = 1;\n",
    '  Courses: "server u64, name text, start f64[3], kinds u8*, points f64*, lengths f64*, names u8*",\n',
]
MESSAGES = [
    "field(s.server); field(s.name); field(s.start); field(s.kinds); field(s.points); field(s.lengths); field(s.names);",
    "struct CoursesColumns {\n  using Message = Courses;\n  std::vector<std::uint8_t> kinds;\n  std::vector<double> points;\n",
    "visit(&Courses::kinds, &CoursesColumns::kinds, 1U);\n    visit(&Courses::points, &CoursesColumns::points, 3U);\n",
    "visit(&Courses::lengths, &CoursesColumns::lengths, 1U);\n    visit(&Courses::names, &CoursesColumns::names, 0U);\n",
]


def main(sources):
    place = pathlib.Path(sources) / "idl" / "generate.py"
    spec = importlib.util.spec_from_file_location("generate", place)
    generate = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(generate)
    expected = {"include/collided/codes.hpp": CODES, "include/collided/codes.h": C_CODES, "idl/messages.hpp": MESSAGES,
                "client/python/collided/_contract.py": PYTHON, "client/view/contract.js": PAGE}
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        build = pathlib.Path(folder)
        idl, client_idl = build / "a.idl", build / "client.idl"
        idl.write_text(IDL, encoding="utf-8")
        client_idl.write_text(CLIENT_IDL, encoding="utf-8")
        generate.main(build, idl, client_idl)
        for output, pieces in expected.items():
            text = (build / output).read_text(encoding="utf-8")
            faults += [f"{output} lacks\n{piece}" for piece in pieces if piece not in text]
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
    print("\n".join(faults) or f"{sum(map(len, expected.values()))} pieces as expected")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
