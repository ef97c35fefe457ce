#include "tests/studies/report/measure.hpp"

#include <algorithm>
#include <cmath>

#include "tests/studies/bench/clock.hpp"

namespace collided::report {
using namespace engine;
namespace {

using oracle::Wide;

void score(Row& row, const std::vector<Answer>& answers, const std::vector<Truth>& truth, double extent) {
  std::vector<double> errors;
  double worst_ratio = kUnknown;
  double worst_bound = kUnknown;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Answer& given = answers[i];
    if (given.undecided) {
      ++row.undecided;
      continue;
    }
    if (given.yes != truth[i].yes) {
      ++(given.yes ? row.false_hits : row.missed);
      continue;
    }
    if (!given.yes) continue;
    if (!std::isfinite(given.value)) {
      errors.push_back(INFINITY);
      continue;
    }
    const Wide off = abs(Wide(given.value) - truth[i].value);
    const Wide floor = std::max(abs(truth[i].value), Wide(0x1p-53 * extent));
    errors.push_back(static_cast<double>(floor > 0 ? Wide(off / floor) : Wide(0)));
    if (!std::isnan(given.bound)) {
      // 1e-90 absorbs the hundred digits of the truth itself.
      const Wide ratio = off <= truth[i].value * Wide(1e-90) ? Wide(0) : Wide(off / Wide(given.bound));
      const double r = given.bound > 0 || off == 0 ? static_cast<double>(ratio) : (ratio == 0 ? 0.0 : INFINITY);
      worst_ratio = std::isnan(worst_ratio) ? r : std::max(worst_ratio, r);
      const double relative = given.bound > 0 ? static_cast<double>(Wide(Wide(given.bound) / floor)) : 0.0;
      worst_bound = std::isnan(worst_bound) ? relative : std::max(worst_bound, relative);
    }
  }
  row.bound_ratio = worst_ratio;
  row.bound_max = worst_bound;
  if (errors.empty()) return;
  std::sort(errors.begin(), errors.end());
  row.error_max = errors.back();
  row.error_p50 = errors[errors.size() / 2];
}

}  // namespace

double timed(const std::function<void()>& work) {
  const double start = bench::thread_seconds();
  work();
  return bench::thread_seconds() - start;
}

std::vector<Row> measure(const std::string& study, const std::string& scene, const std::vector<Method>& methods,
                         const std::vector<Truth>& truth, double extent, int repeats) {
  std::vector<std::vector<double>> seconds(methods.size());
  std::vector<std::vector<Answer>> answers(methods.size());
  for (int repeat = 0; repeat < repeats; ++repeat) {
    for (std::size_t m = 0; m < methods.size(); ++m) seconds[m].push_back(methods[m].pass(answers[m]));
  }
  std::vector<Row> rows;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    Row row{.study = study,
            .scene = scene,
            .series = methods[m].series,
            .label = methods[m].label,
            .knob = methods[m].knob,
            .note = methods[m].note};
    row.n = static_cast<long>(truth.size());
    if (answers[m].size() == truth.size() && !truth.empty()) {
      std::sort(seconds[m].begin(), seconds[m].end());
      const double to_ns = 1e9 / static_cast<double>(truth.size());
      row.ns = to_ns * seconds[m][seconds[m].size() / 2];
      row.ns_low = to_ns * seconds[m].front();
      row.ns_high = to_ns * seconds[m].back();
      score(row, answers[m], truth, extent);
    } else {
      row.note = row.note.empty() ? "ended its process" : row.note + "; ended its process";
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace collided::report
