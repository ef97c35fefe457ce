#include "tests/studies/bench/rows.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "tests/studies/bench/clock.hpp"

namespace collided::bench {
namespace {

double median(std::vector<double> of) {
  std::sort(of.begin(), of.end());
  return of[of.size() / 2];
}

/// Of runs taken side by side, so that what the machine did meanwhile falls on both.
double median_ratio(const Method& above, const Method& below) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < above.ns.size(); ++i) ratios.push_back(above.ns[i] / below.ns[i]);
  return median(ratios);
}

double seconds(bool on_the_wall) {
  if (!on_the_wall) return thread_seconds();
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double timed_ns(const Work& work, const Method& method) {
  if (method.own_ns) return method.own_ns();
  if (method.prepare) method.prepare();
  const double start = seconds(work.on_the_wall);
  method.run();
  return 1e9 * (seconds(work.on_the_wall) - start) / static_cast<double>(work.questions);
}

void print_header() {
  std::printf("%-12s %9s %-22s %-24s %11s %25s %7s %7s %s\n", "scene", "size", "work", "method", "ns", "[least, most]",
              "ratio", "bytes", "answers equal");
}

void write_row(const Options& options, const Work& work, const Method& method, double ratio, const std::string& note) {
  const auto [least, most] = std::minmax_element(method.ns.begin(), method.ns.end());
  const double middle = median(method.ns);
  std::printf("%-12s %9zu %-22s %-24s %11.1f [%11.1f,%11.1f] %7.2f %7.1f %zu of %zu%s%s\n", work.scene.c_str(),
              work.size, work.name.c_str(), method.name.c_str(), middle, *least, *most, ratio, method.bytes_each,
              method.equal, method.of, note.empty() ? "" : "  ", note.c_str());
  std::fflush(stdout);
  if (options.csv.empty()) return;
  std::ofstream csv(options.csv, std::ios::app);
  if (csv.tellp() == 0) csv << "scene,size,work,method,ns,ns_low,ns_high,ratio,bytes_each,equal,of,note\n";
  csv << work.scene << ',' << work.size << ",\"" << work.name << "\",\"" << method.name << "\"," << middle << ','
      << *least << ',' << *most << ',' << ratio << ',' << method.bytes_each << ',' << method.equal << ',' << method.of
      << ",\"" << note << "\"\n";
}

}  // namespace

bool Options::wants(const std::string& scene, const std::string& work) const {
  return scene.find(only) != std::string::npos || work.find(only) != std::string::npos;
}

bool Options::takes(const std::string& method) const {
  return method.starts_with("collided") || method.find(peers) != std::string::npos;
}

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const bool has_value = i + 1 < argc;
    if (argument == "--quick") {
      options.quick = true;
    } else if (argument == "--no-header") {
      options.header = false;
    } else if (argument == "--csv" && has_value) {
      options.csv = argv[++i];
    } else if (argument == "--only" && has_value) {
      options.only = argv[++i];
    } else if (argument == "--peers" && has_value) {
      options.peers = argv[++i];
    } else {
      std::fprintf(stderr,
                   "%s: unknown argument '%s'; known: --quick, --csv FILE, --only NAME, --peers NAME, --no-header\n",
                   argv[0], argv[i]);
      std::exit(2);
    }
  }
  if (options.header) print_header();
  return options;
}

void measure(const Options& options, const Work& work, std::vector<Method>& methods) {
  std::erase_if(methods, [&](const Method& method) { return !options.takes(method.name); });
  for (const Method& method : methods) timed_ns(work, method);
  for (int run = 0; run < kRuns; ++run) {
    for (Method& method : methods) method.ns.push_back(timed_ns(work, method));
  }
  const Method* best = nullptr;
  for (std::size_t i = 1; i < methods.size(); ++i) {
    if (methods[i].name.starts_with("collided")) continue;  // another form of ours
    if (best == nullptr || median(methods[i].ns) < median(best->ns)) best = &methods[i];
  }
  for (const Method& method : methods) {
    const bool ours = &method == methods.data();
    const double ratio = ours ? (best != nullptr ? median_ratio(*best, method) : 1) : median_ratio(method, methods[0]);
    write_row(options, work, method, ratio, ours ? work.note : "");
  }
}

}  // namespace collided::bench
