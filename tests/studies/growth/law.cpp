#include "tests/studies/growth/law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace collided::growth {
namespace {

std::string text_of(const homework::Slope& slope) {
  return slope.known() ? fmt::format("{:5.2f} +- {:.2f}", slope.exponent, slope.half) : "unknown";
}

std::string short_text(double value) { return fmt::format("{:.3g}", value); }

}  // namespace

Sample sample_of(double x, std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {x, values[values.size() / 2], values.front(), values.back()};
}

std::string Theory::text() const {
  const std::string base = power == 0 ? "" : power == 1 ? "n" : fmt::format("n^{:.2f}", power);
  if (!times_log) return base.empty() ? "constant" : base;
  return base.empty() ? "log n" : base + " log n";
}

double Theory::exponent(const std::vector<double>& x) const {
  if (!times_log) return power;
  std::vector<double> y;
  for (const double size : x) y.push_back(std::pow(size, power) * std::log(size));
  return homework::fit(x, y).exponent;
}

Judgement judge(const Law& law) {
  Judgement judgement;
  std::vector<double> x, y, upper_x, upper_y;
  for (const Sample& sample : law.samples) {
    x.push_back(sample.x);
    y.push_back(sample.median);
  }
  if (x.empty()) return judgement;
  const double middle = std::sqrt(x.front() * x.back());
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (x[i] < 0.99 * middle) continue;
    upper_x.push_back(x[i]);
    upper_y.push_back(y[i]);
  }
  judgement.all = homework::fit(x, y);
  judgement.upper = homework::fit(upper_x, upper_y);
  judgement.known = judgement.upper.known();
  if (!judgement.known) return judgement;
  judgement.expected = law.theory.exponent(upper_x);
  judgement.deviation = judgement.upper.exponent - judgement.expected;
  judgement.deviates = std::abs(judgement.deviation) > std::max(kTolerance, judgement.upper.half);
  return judgement;
}

std::string table(const std::vector<Law>& laws) {
  std::string text = fmt::format("{:<12} {:<34} {:>17} {:>28} {:>15} {:>15} {:>16}\n", "grows with", "what",
                                 "from .. to", "it costs", "exponent", "upper half", "theory");
  for (const Law& law : laws) {
    if (law.samples.empty()) continue;
    const Judgement judgement = judge(law);
    const Sample& first = law.samples.front();
    const Sample& last = law.samples.back();
    text += fmt::format("{:<12} {:<34} {:>17} {:>28} {:>15} {:>15} {:>16}\n", law.knob, law.what,
                        short_text(first.x) + " .. " + short_text(last.x),
                        short_text(first.median) + " .. " + short_text(last.median) + " " + law.unit,
                        text_of(judgement.all), text_of(judgement.upper),
                        law.theory.text() + (judgement.known ? fmt::format(": {:.2f}", judgement.expected) : ""));
    if (!judgement.known) text += "             not judged: fewer than three sizes in the upper half\n";
    if (judgement.deviates) {
      text +=
          fmt::format("             {} than theory by {:.2f}: {}\n", judgement.deviation > 0 ? "steeper" : "flatter",
                      std::abs(judgement.deviation), law.reason.empty() ? "the reason is not known" : law.reason);
    }
  }
  return text;
}

}  // namespace collided::growth
