// Measures, and writes the page.
//   collided_report --out DIR [--quick | --full] [--only STUDY] [--seed N] [--peers DIR] [--census FILE] [--mutants FILE]
//                   [--response FILE] [--contact FILE] [--commit TEXT] [--command TEXT]
#include <fmt/core.h>
#include <xmmintrin.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <stdexcept>

#include "tests/studies/report/figures/figures.hpp"
#include "tests/studies/report/measured/studies.hpp"
#include "tests/studies/report/page/provenance.hpp"

namespace {

using namespace collided;

struct Arguments {
  std::string out;
  std::string only;
  std::string census;
  std::string response;
  std::string contact;
  std::string mutants;
  report::Setting setting;
  report::Provenance from;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  a.from.commit = "not given";
  std::map<std::string, std::string*> texts{{"--out", &a.out},
                                            {"--only", &a.only},
                                            {"--census", &a.census},
                                            {"--response", &a.response},
                                            {"--mutants", &a.mutants},
                                            {"--contact", &a.contact},
                                            {"--commit", &a.from.commit},
                                            {"--command", &a.from.command},
                                            {"--peers", &a.setting.peers}};
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--quick" || name == "--full") {
      (name == "--quick" ? a.setting.quick : a.setting.full) = true;
      continue;
    }
    if (i + 1 == argc) throw std::invalid_argument("no value after '" + name + "'");
    const std::string value = argv[++i];
    if (name == "--seed") {
      a.setting.seed = std::stoull(value);
    } else if (const auto text = texts.find(name); text != texts.end()) {
      *text->second = value;
    } else {
      throw std::invalid_argument("unknown argument '" + name + "'");
    }
  }
  if (a.out.empty()) throw std::invalid_argument("--out DIR is missing");
  a.from.machine = report::machine();
  a.from.seed = a.setting.seed;
  a.from.quick = a.setting.quick;
  if (a.from.command.empty()) a.from.command = fmt::format("collided_report --seed {}", a.setting.seed);
  return a;
}

/// Denormals on, rounding to nearest: what every bound assumes.
bool arithmetic_is_sound() { return (_mm_getcsr() & 0xe040u) == 0; }

using Study = std::vector<report::Row> (*)(const report::Setting&);
const std::pair<const char*, Study> kStudies[] = {
    {"ray", report::study_ray},
    {"depth", report::study_depth},
    {"nearest", report::study_nearest},
    {"time", report::study_time},
    {"turning", report::study_turning},
    {"tessellation", report::study_tessellation},
    {"simplification", report::study_simplification},
    {"extremes", report::study_extremes},
    {"decisions", report::study_decisions},
    {"index", report::study_index},
    {"growth", report::study_growth},
    {"stages", report::study_stages},
    {"arrival", report::study_arrival},
};

}  // namespace

int main(int argc, char** argv) {
  try {
    Arguments a = parse(argc, argv);
    if (!arithmetic_is_sound()) throw std::runtime_error("the floating-point control word is not the default one");
    std::filesystem::create_directories(a.out + "/scratch");
    a.setting.scratch = a.out + "/scratch";
    std::vector<report::Row> rows;
    for (const auto& [name, study] : kStudies) {
      if (!a.only.empty() && a.only != name) continue;
      const auto start = std::chrono::steady_clock::now();
      const std::vector<report::Row> found = study(a.setting);
      rows.insert(rows.end(), found.begin(), found.end());
      fmt::print("{:<16} {:>4} rows, {:.1f} s\n", name, found.size(),
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      std::fflush(stdout);
    }
    std::filesystem::remove_all(a.setting.scratch);
    report::write_rows(a.out + "/rows.csv", rows, a.from);
    const report::Tables tables{rows,
                                report::pinned(report::pair_cells(a.setting.seed, a.setting.quick ? 8 : 48)),
                                report::read_csv(a.census),
                                report::read_csv(a.response),
                                report::read_csv(a.contact),
                                report::read_csv(a.mutants)};
    std::ofstream(a.out + "/index.html") << report::page(report::figures(tables), a.from, report::today());
    fmt::print("{}/index.html\n", a.out);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 2;
  }
  return 0;
}
