#pragma once

#include <string>

#include <Eigen/Core>

// Numbers for people. For machines, format_number() of number.hpp writes every digit.
namespace collided::cli {

/// rounded: as many digits as people need and the error bound justifies. all: every digit, and each length with its
/// bound (--verbose).
enum class Digits { rounded, all };

/// The value rounded to a micrometre or to four digits, whichever is finer, and no finer than its error: "1.8".
///
/// error  bound of the value, in its unit; 0: exact
std::string readable_number(double value, double error = 0);

/// A length in metres, "1.8 m". Its error bound follows if it is larger than the rounding, and always with Digits::all:
/// "1.7999999999999998 m ±2.2e-16", "0.2 m exact".
std::string readable_length(double metres, double error_m, Digits digits);

/// A point, "6 0 1.2", with coordinates rounded like lengths.
std::string readable_point(const Eigen::Vector3d& point, double error_m, Digits digits);

/// A direction of length 1, four digits after the point: "0 0.7071 0.7071".
std::string readable_direction(const Eigen::Vector3d& direction, Digits digits);

}  // namespace collided::cli
