// The homework's problems B and C, measured again, as a page.
//   homework_study --out DIR [--quick] [--seed N] [--commit TEXT] [--command TEXT]
// DIR/homework_1.svg and homework_2.svg, pictures of problem A (homework_pictures), are put into it where they are.
#include <fmt/core.h>

#include <cstdio>
#include <exception>
#include <fstream>
#include <stdexcept>

#include "tests/studies/homework/homework_page.hpp"
#include "tests/studies/report/page/provenance.hpp"

namespace {

using namespace collided;

struct Arguments {
  std::filesystem::path out;
  homework::StudyOptions study;
  report::Provenance from;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  a.from.commit = "not given";
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--quick") {
      a.study.quick = true;
      continue;
    }
    if (i + 1 == argc) throw std::invalid_argument("no value after '" + name + "'");
    const std::string value = argv[++i];
    if (name == "--out") {
      a.out = value;
    } else if (name == "--seed") {
      a.study.seed = std::stoull(value);
    } else if (name == "--commit") {
      a.from.commit = value;
    } else if (name == "--command") {
      a.from.command = value;
    } else {
      throw std::invalid_argument("unknown argument '" + name + "'");
    }
  }
  if (a.out.empty()) throw std::invalid_argument("--out DIR is missing");
  a.from.machine = report::machine();
  a.from.seed = a.study.seed;
  a.from.quick = a.study.quick;
  if (a.from.command.empty()) a.from.command = fmt::format("homework_study --seed {}", a.study.seed);
  a.study.methods = {homework::collided_world, homework::collided_polygons, homework::simple_prototype};
#ifdef COLLIDED_HOMEWORK_FCL
  a.study.methods.insert(a.study.methods.end(), {homework::fcl_objects, homework::fcl_polygons});
#endif
#ifdef COLLIDED_HOMEWORK_BULLET
  a.study.methods.push_back(homework::bullet_objects);
#endif
  return a;
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments a = parse(argc, argv);
  std::filesystem::create_directories(a.out);
  const std::vector<homework::Point> points = homework::run_study(a.study);
  const homework::Parts parts = homework::measure_parts(a.study.seed, a.study.quick);
  fmt::print("detection {:.1f} us, determination {:.1f} us on top, response {:.1f} us, {:.1f} contacts\n",
             parts.detection_us, parts.determination_us, parts.response_us, parts.contacts);
  for (const homework::Claim& claim : homework::claims(points)) {
    fmt::print("{}: {} ({}: {})\n", claim.verdict, claim.text, claim.method, claim.measured);
  }
  homework::write_points(a.out / "homework.csv", points, a.from);
  const report::Heading heading{"Collided: the homework, asked again",
                                "Collisions among spheres of polygons that move in a cube: V-COLLIDE against a simple "
                                "prototype, as a homework of "
                                "the year 2000 compared them, and what others and Collided make of it.",
                                "homework.csv"};
  std::ofstream(a.out / "homework.html") << report::page(homework::homework_figures(points, parts, a.from, a.out),
                                                         a.from, report::today(), heading);
  fmt::print("{}\n", (a.out / "homework.html").string());
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "error: {}\n", error.what());
  return 2;
}
