#include "server/service/options/quantities.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>

namespace collided::engine::service {
namespace {

/// Takes the number from the start of the text and leaves the rest.
std::optional<double> take_number(std::string_view& text) {
  std::string_view digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{}) return std::nullopt;
  text = digits.substr(static_cast<std::size_t>(end - digits.data()));
  return value;
}

using Unit = std::pair<std::string_view, double>;
constexpr std::array<Unit, 6> kTimes{{{"ns", 1}, {"us", 1e3}, {"ms", 1e6}, {"s", 1e9}, {"min", 60e9}, {"h", 3600e9}}};
constexpr std::array<Unit, 8> kLengths{
    {{"um", 1e-6}, {"mm", 1e-3}, {"cm", 1e-2}, {"dm", 0.1}, {"m", 1}, {"km", 1e3}, {"in", 0.0254}, {"ft", 0.3048}}};

}  // namespace

bool is_number(std::string_view text) { return take_number(text).has_value() && text.empty(); }

std::optional<std::int64_t> parse_whole(std::string_view text) {
  std::string digits;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool separator = text[i] == '_' && i > 0 && i + 1 < text.size();
    if (!separator) digits += text[i];
  }
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_duration_ns(std::string_view text) {
  const std::optional<double> value = take_number(text);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  if (text.empty() && *value == 0) return 0;
  for (const auto& [name, nanoseconds] : kTimes) {
    if (text != name) continue;
    const double total = *value * nanoseconds;
    // A hundred years, so that the sum of two still fits.
    if (std::abs(total) > 3.2e18) return std::nullopt;
    return static_cast<std::int64_t>(std::llround(total));
  }
  return std::nullopt;
}

std::optional<double> parse_length_m(std::string_view text) {
  const std::optional<double> value = take_number(text);
  if (!value || !std::isfinite(*value) || *value < 0) return std::nullopt;
  while (text.starts_with(' ')) text.remove_prefix(1);
  if (text.empty()) return value;
  for (const auto& [name, metres] : kLengths) {
    if (text == name) return *value * metres;
  }
  return std::nullopt;
}

std::optional<std::array<double, 6>> parse_box_m(std::string_view text) {
  std::array<double, 6> box{};
  for (std::size_t i = 0; i < box.size(); ++i) {
    const std::size_t end = i == 2 ? text.find(':') : i == 5 ? text.size() : text.find(',');
    if (end == std::string_view::npos) return std::nullopt;
    std::string_view length = text.substr(0, end);
    const std::optional<double> value = take_number(length);
    if (!value || std::isnan(*value)) return std::nullopt;
    const auto unit =
        std::find_if(kLengths.begin(), kLengths.end(), [&](const Unit& known) { return known.first == length; });
    if (!length.empty() && unit == kLengths.end()) return std::nullopt;
    box[i] = length.empty() ? *value : *value * unit->second;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  const bool is_ordered = box[0] <= box[3] && box[1] <= box[4] && box[2] <= box[5];
  return is_ordered ? std::optional(box) : std::nullopt;
}

std::optional<double> parse_unit_m(std::string_view text) {
  for (const auto& [name, metres] : kLengths) {
    if (text == name) return metres;
  }
  const std::optional<double> value = take_number(text);
  if (!value || !text.empty() || !std::isfinite(*value) || *value <= 0) return std::nullopt;
  return value;
}

bool is_namespace(std::string_view name) {
  bool good = !name.empty() && name.size() <= 64 && !(name[0] >= '0' && name[0] <= '9');
  for (const char c : name) {
    good = good && ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '/');
  }
  return good;
}

bool is_network_word(std::string_view word) {
  const auto allowed = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
           std::string_view("._-:%[]").find(c) != std::string_view::npos;
  };
  return !word.empty() && std::all_of(word.begin(), word.end(), allowed);
}

}  // namespace collided::engine::service
