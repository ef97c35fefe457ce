#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/studies/homework/slope.hpp"

namespace collided::growth {

/// One size, measured several times: the median and the range.
struct Sample {
  double x = 0;
  double median = 0;
  double low = 0;
  double high = 0;
};
Sample sample_of(double x, std::vector<double> values);

/// What theory says of the exponent: x to the power, times log x where it has one.
struct Theory {
  double power = 0;
  bool times_log = false;

  std::string text() const;
  /// The exponent that the fit would find in exact data at these sizes; a logarithm looks like a small power.
  double exponent(const std::vector<double>& x) const;
};

/// How one thing grows with one knob.
struct Law {
  std::string knob;  // triangles, movers, contacts, objects, scenes, pile, clients, subscribers
  std::string what;
  std::string unit;
  Theory theory;
  std::string reason{};  // why it deviates, told where it does
  std::vector<Sample> samples{};
};

/// The fit over all sizes, and over the upper half of the decades, where what a question costs at the least counts for
/// little: the law is judged there.
struct Judgement {
  homework::Slope all;
  homework::Slope upper;
  double expected = 0;   // of the upper half
  double deviation = 0;  // of the upper half from it
  bool known = false;
  bool deviates = false;
};

/// An exponent may be off by this much for reasons that no theory of operations has: caches, clocks, other programs.
inline constexpr double kTolerance = 0.1;

/// deviates: theory's exponent is farther from the fitted one than kTolerance, and the fit's own spread does not explain
/// it either.
Judgement judge(const Law& law);

/// The laws as plain text, one line each, with a line below those that deviate.
std::string table(const std::vector<Law>& laws);

}  // namespace collided::growth
