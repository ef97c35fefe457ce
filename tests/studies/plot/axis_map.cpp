#include "tests/studies/plot/axis_map.hpp"

#include <algorithm>
#include <cmath>

namespace collided::draw {

AxisMap::AxisMap(const Axis& axis, const std::vector<double>& values, double first_px, double last_px)
    : scale_(axis.scale), first_px_(first_px), last_px_(last_px) {
  if (scale_ == Scale::logarithmic) {
    choose_logarithmic(values);
  } else {
    choose_linear(values);
  }
  if (axis.low) low_ = *axis.low;
  if (axis.high) high_ = *axis.high;
}

void AxisMap::choose_logarithmic(const std::vector<double>& values) {
  double least = INFINITY;
  double largest = 0;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    if (v <= 0) {
      has_zero_ = true;
      continue;
    }
    least = std::min(least, v);
    largest = std::max(largest, v);
  }
  if (!(least <= largest)) least = largest = 1;
  low_ = std::pow(10.0, std::floor(std::log10(least) - 0.05));
  high_ = std::pow(10.0, std::ceil(std::log10(largest) + 0.05));
  // Zeros are drawn one decade below the smallest value.
  if (has_zero_) low_ /= 10;
}

void AxisMap::choose_linear(const std::vector<double>& values) {
  double least = INFINITY;
  double largest = -INFINITY;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    least = std::min(least, v);
    largest = std::max(largest, v);
  }
  if (!(least <= largest)) return;
  const double pad = largest > least ? 0.05 * (largest - least) : 0.5 * std::max(1.0, std::abs(least));
  low_ = least >= 0 && least < 0.3 * largest ? 0 : least - pad;
  high_ = largest + pad;
}

double AxisMap::pixel(double value) const {
  double part = 0;
  if (scale_ == Scale::logarithmic) {
    part = value > 0 ? std::log(value / low_) / std::log(high_ / low_) : 0;
  } else {
    part = (value - low_) / (high_ - low_);
  }
  return first_px_ + std::clamp(part, 0.0, 1.0) * (last_px_ - first_px_);
}

double AxisMap::value_at(double fraction) const {
  return scale_ == Scale::logarithmic ? low_ * std::pow(high_ / low_, fraction) : low_ + fraction * (high_ - low_);
}

std::vector<std::pair<double, std::string>> AxisMap::ticks(double room_px) const {
  std::vector<std::pair<double, std::string>> result;
  const double most = std::max(2.0, std::abs(last_px_ - first_px_) / room_px);
  if (scale_ == Scale::logarithmic) {
    const int first = static_cast<int>(std::ceil(std::log10(low_) - 1e-9));
    const int last = static_cast<int>(std::floor(std::log10(high_) + 1e-9));
    const int step = std::max(1, static_cast<int>(std::ceil((last - first) / most)));
    for (int power = first; power <= last; power += step) {
      if (has_zero_ && power == first) {
        result.emplace_back(low_, "0");
      } else {
        result.emplace_back(std::pow(10.0, power), "1e" + std::to_string(power));
      }
    }
    return result;
  }
  const double rough = (high_ - low_) / most;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double nice : {1.0, 2.0, 5.0}) {
    if (nice * power >= rough) {
      step = nice * power;
      break;
    }
  }
  for (double k = std::ceil(low_ / step - 1e-9); k * step <= high_ * (1 + 1e-12); ++k) {
    const double value = k * step + 0.0;  // not -0
    result.emplace_back(value, tick_text(value));
  }
  return result;
}

}  // namespace collided::draw
