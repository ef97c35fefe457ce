#pragma once

#include <vector>

namespace collided::homework {

/// y = c x^exponent, fitted to the logarithms by least squares; the true exponent of such data lies within
/// exponent +- half at 95 % confidence (Student's t with points - 2 degrees of freedom).
struct Slope {
  double exponent = 0;
  double half = 0;
  std::size_t points = 0;

  bool known() const { return points >= 3; }
  double low() const { return exponent - half; }
  double high() const { return exponent + half; }
};

/// Of fewer than three points nothing is known.
Slope fit(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace collided::homework
