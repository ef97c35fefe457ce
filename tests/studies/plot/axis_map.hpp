#pragma once

#include <utility>
#include <vector>

#include "tests/studies/plot/plot.hpp"
#include "client/draw/svg.hpp"

namespace collided::draw {

/// Maps values to pixels along one axis of a plot, and chooses its ticks. Immutable.
class AxisMap {
 public:
  AxisMap(const Axis& axis, const std::vector<double>& values, double first_px, double last_px);

  /// The place of a value.
  double pixel(double value) const;
  /// The value at a fraction of the axis.
  double value_at(double fraction) const;
  /// Ticks as (value, text): round values within the axis, few enough for texts of that size.
  std::vector<std::pair<double, std::string>> ticks(double room_px) const;
  /// Whether some value has no place on a logarithmic axis, so it is drawn at its low end.
  bool has_zero() const { return has_zero_; }
  double low() const { return low_; }
  double high() const { return high_; }

 private:
  void choose_logarithmic(const std::vector<double>& values);
  void choose_linear(const std::vector<double>& values);

  Scale scale_;
  double first_px_;
  double last_px_;
  double low_ = 0;
  double high_ = 1;
  bool has_zero_ = false;
};

}  // namespace collided::draw
