#include "client/cli/output/readable.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"

namespace collided::cli {
namespace {

constexpr double kMicrometre = 1e-6;
constexpr double kLeastPlain = 1e-4;  // smaller values are written with an exponent
constexpr int kLeastDigits = 4;

/// The exponent of ten of the last digit shown.
int last_digit(double value, double error) {
  const double size = std::abs(value);
  const double by_digits = size > 0 ? std::pow(10.0, std::floor(std::log10(size)) - (kLeastDigits - 1)) : kMicrometre;
  const double resolution = std::max(std::min(kMicrometre, by_digits), error);
  return static_cast<int>(std::floor(std::log10(resolution) + 1e-9));  // the log of 1e-6 may be a rounding below -6
}

/// Fixed notation without trailing zeros, and without a sign if only zeros are left.
std::string fixed(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, std::max(0, decimals));
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

/// Notation with an exponent and this many digits, without trailing zeros: "3.142e-07".
std::string with_digits(double value, int digits) {
  const std::string rounded = fmt::format("{:.{}e}", value, digits - 1);
  double shown = value;
  std::from_chars(rounded.data(), rounded.data() + rounded.size(), shown);
  return format_number(shown);
}

}  // namespace

std::string readable_number(double value, double error) {
  if (!std::isfinite(value)) return format_number(value);
  if (!std::isfinite(error)) error = 0;  // no bound is known; show all digits of the value
  if (value == 0) return "0";
  const double size = std::abs(value);
  if (size < kLeastPlain) {
    if (error >= size) return "0";
    const int digits = static_cast<int>(std::floor(std::log10(size))) - last_digit(value, error) + 1;
    return with_digits(value, std::clamp(digits, 1, kLeastDigits));
  }
  constexpr double kMostPlain = 1e15;
  return size < kMostPlain ? fixed(value, -last_digit(value, error)) : fmt::format("{:.6g}", value);
}

std::string readable_length(double metres, double error_m, Digits digits) {
  if (digits == Digits::all) {
    return (metres == 0 ? "0" : format_number(metres) + " m") +
           (error_m == 0 ? " exact" : " ±" + format_bound(error_m));
  }
  std::string text = readable_number(metres, error_m);
  if (text != "0") text += " m";
  const bool matters = error_m > std::pow(10.0, last_digit(metres, 0)) / 2;
  return matters ? text + " ±" + format_bound(error_m) : text;
}

std::string readable_point(const Eigen::Vector3d& point, double error_m, Digits digits) {
  if (digits == Digits::all) return format_vector(point);
  // One resolution for all three: a coordinate of 1e-17 m next to one of 2 m is only rounding.
  const double shown =
      std::max(std::isfinite(error_m) ? error_m : 0, std::min(kMicrometre, 1e-4 * point.cwiseAbs().maxCoeff()));
  return fmt::format("{} {} {}", readable_number(point.x(), shown), readable_number(point.y(), shown),
                     readable_number(point.z(), shown));
}

std::string readable_direction(const Eigen::Vector3d& direction, Digits digits) {
  if (digits == Digits::all) return format_vector(direction);
  return fmt::format("{} {} {}", fixed(direction.x(), kLeastDigits), fixed(direction.y(), kLeastDigits),
                     fixed(direction.z(), kLeastDigits));
}

}  // namespace collided::cli
