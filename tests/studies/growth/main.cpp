// How time and memory grow with what there is, each law beside theory's, as a table and a page.
//   growth_study --out DIR [--quick] [--seed N] [--service FILE] [--commit TEXT] [--command TEXT]
// FILE: the lines of growth_service; without it clients and subscribers are left out.
#include <fmt/core.h>

#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>

#include "tests/studies/growth/engine_laws.hpp"
#include "tests/studies/growth/growth_page.hpp"
#include "tests/studies/growth/service_laws.hpp"
#include "tests/studies/report/page/provenance.hpp"

namespace {

using namespace collided;

struct Arguments {
  std::string out;
  std::string service;
  growth::GrowthSetting setting;
  report::Provenance from;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  a.from.commit = "not given";
  std::map<std::string, std::string*> texts{
      {"--out", &a.out}, {"--service", &a.service}, {"--commit", &a.from.commit}, {"--command", &a.from.command}};
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--quick") {
      a.setting.quick = true;
      continue;
    }
    if (i + 1 == argc) throw std::invalid_argument("no value after '" + name + "'");
    const std::string value = argv[++i];
    if (name == "--seed") a.setting.seed = std::stoull(value);
    else if (const auto text = texts.find(name); text != texts.end()) *text->second = value;
    else throw std::invalid_argument("unknown argument '" + name + "'");
  }
  if (a.out.empty()) throw std::invalid_argument("--out DIR is missing");
  a.from.machine = report::machine();
  a.from.seed = a.setting.seed;
  a.from.quick = a.setting.quick;
  if (a.from.command.empty()) a.from.command = fmt::format("growth_study --seed {}", a.setting.seed);
  return a;
}

std::string text_of(const std::string& file) {
  std::ifstream input(file);
  if (!input) throw std::runtime_error(file + ": cannot be read");
  return {std::istreambuf_iterator<char>(input), {}};
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments a = parse(argc, argv);
  const std::filesystem::path out = a.out;
  std::filesystem::create_directories(out);
  std::vector<growth::Law> laws;
  const auto take = [&](const std::vector<growth::Law>& more) { laws.insert(laws.end(), more.begin(), more.end()); };
  take(growth::triangle_laws(a.setting));
  take(growth::mover_laws(a.setting));
  take(growth::contact_laws(a.setting));
  take(growth::change_laws(a.setting));
  if (!a.service.empty()) take(growth::service_laws(text_of(a.service)));
  const std::string table = growth::table(laws);
  std::ofstream(out / "growth.txt") << table;
  growth::write_samples(out / "growth.csv", laws, a.from);
  const report::Heading heading{"Collided: how it grows",
                                "Whole answers and whole steps, as users get them, from a thousand to ten million "
                                "triangles, a hundred to a million movers, contacts and "
                                "objects of which few change, ten to ten thousand scenes, one to 64 clients.",
                                "growth.csv"};
  std::ofstream(out / "growth.html") << report::page(growth::growth_figures(laws), a.from, report::today(), heading);
  fmt::print("{}{}\n", table, (out / "growth.html").string());
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "error: {}\n", error.what());
  return 2;
}
