#include "tests/studies/homework/slope.hpp"

#include <boost/math/distributions/students_t.hpp>

#include <cmath>

namespace collided::homework {

Slope fit(const std::vector<double>& x, const std::vector<double>& y) {
  Slope slope{.points = x.size()};
  if (!slope.known()) return slope;
  const auto count = static_cast<double>(x.size());
  double mean_u = 0, mean_v = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_u += std::log(x[i]) / count;
    mean_v += std::log(y[i]) / count;
  }
  double uu = 0, uv = 0, vv = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double u = std::log(x[i]) - mean_u, v = std::log(y[i]) - mean_v;
    uu += u * u;
    uv += u * v;
    vv += v * v;
  }
  slope.exponent = uv / uu;
  const double left = std::max(0.0, vv - slope.exponent * uv);
  const double quantile = boost::math::quantile(boost::math::students_t(count - 2), 0.975);
  slope.half = quantile * std::sqrt(left / (count - 2) / uu);
  return slope;
}

}  // namespace collided::homework
