#!/usr/bin/env python3
"""What idl/generate.py makes of a small IDL file, word by word.  generator.py SOURCES"""
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
CODES = [
    "/// How it went. gone_by: it is over.\nenum class Course : std::uint8_t { none, gone_by };",
    'constexpr std::string_view kNames[] = {"", "gone_by"};',
    "return static_cast<std::uint8_t>(code) < 2 ? ",
    "/// Bits of a course. FAST: it was quick.\ninline constexpr std::uint8_t kCourseFast = 1;",
    "inline constexpr std::uint64_t kCourseEndless = 18446744073709551615;",
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
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        idl, codes, messages = (pathlib.Path(folder) / name for name in ("a.idl", "codes.hpp", "messages.hpp"))
        idl.write_text(IDL, encoding="utf-8")
        generate.main(idl, codes, messages)
        for output, lines in ((codes, CODES), (messages, MESSAGES)):
            text = output.read_text(encoding="utf-8")
            faults += [f"{output.name} lacks\n{line}" for line in lines if line not in text]
        before = codes.stat().st_mtime_ns
        generate.main(idl, codes, messages)
        if codes.stat().st_mtime_ns != before:
            faults.append("an unchanged output was written again, and everything would be compiled again")
        idl.write_text("module a { };", encoding="utf-8")
        try:
            generate.main(idl, codes, messages)
            faults.append("a file without enumerations was taken")
        except SystemExit as refused:
            if "no enumerations" not in str(refused):
                faults.append(f"the refusal says {refused}")
    print("\n".join(faults) or f"{len(CODES) + len(MESSAGES)} pieces as expected")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
