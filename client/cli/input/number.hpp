#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace collided::cli {

/// What a number measures. It decides which units are allowed, and the default unit (named first).
enum class Measure {
  none,      // no unit
  length,    // metres: nm um mm cm m km in ft
  angle,     // radians: rad deg
  duration,  // seconds: ns us ms s min h
  rate,      // per second: Hz kHz
  speed,     // metres per second: mm/s m/s km/h
};

/// A number with its unit, in SI units; may be infinite. Throws Failure with the text if it is not a number, is `nan`
/// or out of range, or has an unknown unit.
double parse_number(std::string_view text, Measure measure = Measure::none);

/// The same, but infinity is refused too.
double parse_finite(std::string_view text, Measure measure = Measure::none);

/// All numbers of texts such as "0,0,5", or "0" "0" "5", or "20" "cm", in order.
std::vector<double> parse_numbers(const std::vector<std::string>& texts, Measure measure = Measure::none);

/// Exactly three finite numbers separated by commas.
Eigen::Vector3d parse_vector(std::string_view text, Measure measure = Measure::none);

/// A time of 0 or more, rounded to nanoseconds; "inf" is the largest one.
std::chrono::nanoseconds parse_duration(std::string_view text);

/// A whole number of up to 32 bits, decimal, 0x or 0b.
std::uint32_t parse_bits(std::string_view text);

/// A count, in digits only, of at least `low`.
std::uint64_t parse_count(std::string_view text, std::uint64_t low = 0);

/// Whether the whole text is a number, or several with commas or colons, possibly with units: `-1`, `-.5`, `-inf`,
/// `-3mm`, `-1,0,5`, `-1,0,0:1,1,1`. Such a token is never an option.
bool is_number_text(std::string_view text);

/// The shortest text that reads back as the same double; without an exponent from 1e-4 to 1e15.
std::string format_number(double value);

/// Three such numbers with blanks between.
std::string format_vector(const Eigen::Vector3d& value);

/// A number with two significant digits, for the error bound of a value.
std::string format_bound(double value);

/// A count for people, with separated thousands: "18 204".
std::string format_count(std::uint64_t value);
/// A count with its noun: "1 object", "18 204 objects".
std::string counted(std::uint64_t count, std::string_view what);

/// A time for people: "254 ms", "2.1 us", "3 h 12 m".
std::string format_duration(std::chrono::nanoseconds value);

}  // namespace collided::cli
