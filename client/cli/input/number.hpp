#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace collided::cli {

/// What a number measures: decides which units may follow it and what it is without one.
enum class Measure {
  none,      // no unit
  length,    // metres: nm um mm cm m km in ft
  angle,     // radians: rad deg
  duration,  // seconds: ns us ms s min h
  rate,      // per second: Hz kHz
  speed,     // metres per second: mm/s m/s km/h
};

/// One number with its unit, in SI. Throws Failure naming the text: not a number, `nan`, out of range, unknown unit.
double parse_number(std::string_view text, Measure measure = Measure::none);

/// As parse_number, but infinity is refused too.
double parse_finite(std::string_view text, Measure measure = Measure::none);

/// "0,0,5" or "0 0 5" given as separate texts: every number in order.
std::vector<double> parse_numbers(const std::vector<std::string>& texts, Measure measure = Measure::none);

/// Exactly three finite numbers separated by commas.
Eigen::Vector3d parse_vector(std::string_view text, Measure measure = Measure::none);

/// A time of at least 0, rounded to nanoseconds; "inf" is the largest.
std::chrono::nanoseconds parse_duration(std::string_view text);

/// Decimal, 0x or 0b; at most 32 bits.
std::uint32_t parse_bits(std::string_view text);

/// A count of at least `low`, digits only.
std::uint64_t parse_count(std::string_view text, std::uint64_t low = 0);

/// True for texts that parse whole as a number or a list of them with commas or colons, units allowed: `-1`, `-.5`, `-inf`,
/// `-3mm`, `-1,0,5`, `-1,0,0:1,1,1`. Such a token is never an option.
bool is_number_text(std::string_view text);

/// The shortest text that reads back to the same double.
std::string format_number(double value);

/// Three shortest numbers with blanks between.
std::string format_vector(const Eigen::Vector3d& value);

/// Two significant digits, for error bounds beside a value.
std::string format_bound(double value);

/// "18 204": thousands apart, for people.
std::string format_count(std::uint64_t value);

/// "254 ms", "2.1 us", "3 h 12 m": for people.
std::string format_duration(std::chrono::nanoseconds value);

}  // namespace collided::cli
