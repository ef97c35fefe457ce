#include "client/cli/input/number.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "client/cli/failure.hpp"

namespace collided::cli {
namespace {

struct Unit {
  std::string_view name;
  Measure measure;
  // The value in SI is value * times / over. Both are exact integers if the unit allows it, so that 3.5mm is the double
  // nearest to 0.0035.
  double times;
  double over;
};

constexpr double kPi = 3.14159265358979323846;
constexpr std::array kUnits{
    Unit{"nm", Measure::length, 1, 1e9},    Unit{"um", Measure::length, 1, 1e6},
    Unit{"µm", Measure::length, 1, 1e6},    Unit{"mm", Measure::length, 1, 1e3},
    Unit{"cm", Measure::length, 1, 100},    Unit{"m", Measure::length, 1, 1},
    Unit{"km", Measure::length, 1000, 1},   Unit{"in", Measure::length, 254, 1e4},
    Unit{"ft", Measure::length, 3048, 1e4}, Unit{"rad", Measure::angle, 1, 1},
    Unit{"deg", Measure::angle, kPi, 180},  Unit{"°", Measure::angle, kPi, 180},
    Unit{"ns", Measure::duration, 1, 1e9},  Unit{"us", Measure::duration, 1, 1e6},
    Unit{"µs", Measure::duration, 1, 1e6},  Unit{"ms", Measure::duration, 1, 1e3},
    Unit{"s", Measure::duration, 1, 1},     Unit{"min", Measure::duration, 60, 1},
    Unit{"h", Measure::duration, 3600, 1},  Unit{"Hz", Measure::rate, 1, 1},
    Unit{"kHz", Measure::rate, 1000, 1},    Unit{"mm/s", Measure::speed, 1, 1e3},
    Unit{"m/s", Measure::speed, 1, 1},      Unit{"km/h", Measure::speed, 1000, 3600},
};

/// The number at the start of a text and the rest.
struct Split {
  double value = 0;
  std::string_view rest;
  std::errc error{};
  bool starts_as_number = false;
};

Split split_number(std::string_view text) {
  // from_chars takes '-' but not '+'; "+-1" stays an error.
  std::string_view body = text;
  if (body.size() > 1 && body[0] == '+' && body[1] != '-') body.remove_prefix(1);
  Split split;
  const auto [end, error] = std::from_chars(body.data(), body.data() + body.size(), split.value);
  split.error = error;
  split.starts_as_number = error != std::errc::invalid_argument;
  if (split.starts_as_number) split.rest = body.substr(static_cast<std::size_t>(end - body.data()));
  return split;
}

const Unit* find_unit(std::string_view name) {
  for (const Unit& unit : kUnits) {
    if (unit.name == name) return &unit;
  }
  return nullptr;
}

std::string unit_names(Measure measure) {
  std::string names;
  for (const Unit& unit : kUnits) {
    if (unit.measure == measure) fmt::format_to(std::back_inserter(names), "{}{}", names.empty() ? "" : " ", unit.name);
  }
  return names;
}

double with_unit(const Split& split, std::string_view text, Measure measure) {
  if (split.rest.empty()) return split.value;
  if (measure == Measure::none) throw bad_use(fmt::format("'{}' is not a number", text));
  const Unit* unit = find_unit(split.rest);
  if (unit == nullptr || unit->measure != measure) {
    throw bad_use(fmt::format("'{}': '{}' is not a unit here; known: {}", text, split.rest, unit_names(measure)));
  }
  return split.value * unit->times / unit->over;
}

}  // namespace

double parse_number(std::string_view text, Measure measure) {
  const Split split = split_number(text);
  if (!split.starts_as_number) throw bad_use(fmt::format("'{}' is not a number", text));
  if (split.error == std::errc::result_out_of_range) {
    throw bad_use(fmt::format("'{}' is out of the range of a double (about 4.9e-324 to 1.8e308)", text));
  }
  if (std::isnan(split.value)) throw bad_use(fmt::format("'{}' has no place in a question or a pose", text));
  return with_unit(split, text, measure);
}

double parse_finite(std::string_view text, Measure measure) {
  const double value = parse_number(text, measure);
  if (!std::isfinite(value)) throw bad_use(fmt::format("'{}' must be finite here", text));
  return value;
}

namespace {

/// The texts with each separate unit, as in `20 cm`, joined to the number before it.
std::vector<std::string> with_units_joined(const std::vector<std::string>& texts, Measure measure) {
  std::vector<std::string> joined;
  for (const std::string& text : texts) {
    const Unit* unit = find_unit(text);
    const bool follows_number =
        !joined.empty() && split_number(joined.back()).starts_as_number && split_number(joined.back()).rest.empty();
    if (unit != nullptr && unit->measure == measure && follows_number) joined.back() += text;
    else joined.push_back(text);
  }
  return joined;
}

}  // namespace

std::vector<double> parse_numbers(const std::vector<std::string>& texts, Measure measure) {
  std::vector<double> numbers;
  const std::vector<std::string> joined = with_units_joined(texts, measure);
  for (const std::string_view text : joined) {
    std::size_t begin = 0;
    while (true) {
      const std::size_t comma = text.find_first_of(",:", begin);
      numbers.push_back(parse_number(text.substr(begin, comma - begin), measure));
      if (comma == std::string_view::npos) break;
      begin = comma + 1;
    }
  }
  return numbers;
}

Eigen::Vector3d parse_vector(std::string_view text, Measure measure) {
  const std::vector<double> numbers = parse_numbers({std::string(text)}, measure);
  if (numbers.size() != 3) throw bad_use(fmt::format("'{}' holds {} numbers where 3 are needed", text, numbers.size()));
  for (const double number : numbers) {
    if (!std::isfinite(number)) throw bad_use(fmt::format("'{}' must be finite here", text));
  }
  return {numbers[0], numbers[1], numbers[2]};
}

std::chrono::nanoseconds parse_duration(std::string_view text) {
  const double seconds = parse_number(text, Measure::duration);
  if (seconds < 0) throw bad_use(fmt::format("'{}' is a time below 0", text));
  constexpr double kMostSeconds = 9.2e9;  // int64 nanoseconds end at 9.22e9 s
  if (seconds > kMostSeconds) return std::chrono::nanoseconds::max();
  return std::chrono::nanoseconds(std::llround(seconds * 1e9));
}

std::uint32_t parse_bits(std::string_view text) {
  std::string_view digits = text;
  int base = 10;
  if (digits.starts_with("0x")) base = 16;
  if (digits.starts_with("0b")) base = 2;
  if (base != 10) digits.remove_prefix(2);
  std::uint32_t bits = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), bits, base);
  if (error != std::errc{} || end != digits.data() + digits.size()) {
    throw bad_use(fmt::format("'{}' is not a set of 32 bits (decimal, 0x1f or 0b101)", text));
  }
  return bits;
}

std::uint64_t parse_count(std::string_view text, std::uint64_t low) {
  std::uint64_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc{} || end != text.data() + text.size()) throw bad_use(fmt::format("'{}' is not a count", text));
  if (count < low) throw bad_use(fmt::format("'{}' is below the smallest count here, {}", text, low));
  return count;
}

bool is_number_text(std::string_view text) {
  if (text.empty()) return false;
  std::size_t begin = 0;
  while (true) {
    const std::size_t comma = text.find(',', begin);
    const Split split = split_number(text.substr(begin, comma - begin));
    if (!split.starts_as_number) return false;
    if (!split.rest.empty() && find_unit(split.rest) == nullptr) return false;
    if (comma == std::string_view::npos) return true;
    begin = comma + 1;
  }
}

std::string format_number(double value) {
  constexpr double kLeastPlain = 1e-4;
  constexpr double kMostPlain = 1e15;  // above this, plain notation would show digits that no double holds
  std::array<char, 40> text{};
  const double size = std::abs(value);
  const bool is_plain = size == 0 || (size >= kLeastPlain && size < kMostPlain);
  char* const end = text.data() + text.size();
  const auto result = is_plain ? std::to_chars(text.data(), end, value, std::chars_format::fixed)
                               : std::to_chars(text.data(), end, value);
  return {text.data(), result.ptr};
}

std::string format_vector(const Eigen::Vector3d& value) {
  // Adding 0 turns -0 into 0, since people would take the sign for a mistake.
  return fmt::format("{} {} {}", format_number(value.x() + 0.0), format_number(value.y() + 0.0),
                     format_number(value.z() + 0.0));
}

std::string format_bound(double value) {
  const std::string text = fmt::format("{:.2g}", value);
  double rounded = value;
  std::from_chars(text.data(), text.data() + text.size(), rounded);
  return std::abs(value) < 1 ? text : format_number(rounded);
}

std::string format_count(std::uint64_t value) {
  if (value < 1000) return std::to_string(value);
  return fmt::format("{} {:03}", format_count(value / 1000), value % 1000);
}

std::string counted(std::uint64_t count, std::string_view what) {
  return fmt::format("{} {}{}", format_count(count), what, count == 1 ? "" : "s");
}

std::string format_duration(std::chrono::nanoseconds value) {
  const double seconds = static_cast<double>(value.count()) * 1e-9;
  const double size = std::abs(seconds);
  if (size < 1e-6) return fmt::format("{} ns", value.count());
  if (size < 1e-3) return fmt::format("{:.3g} us", seconds * 1e6);
  if (size < 1) return fmt::format("{:.3g} ms", seconds * 1e3);
  if (size < 120) return fmt::format("{:.3g} s", seconds);
  const auto minutes = static_cast<long long>(seconds / 60);
  if (size < 7200) return fmt::format("{} m {} s", minutes, static_cast<long long>(seconds) % 60);
  return fmt::format("{} h {} m", minutes / 60, minutes % 60);
}

}  // namespace collided::cli
