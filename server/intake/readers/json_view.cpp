#include "server/intake/readers/json_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "server/intake/limits.hpp"

namespace collided::engine {

using nlohmann::json;

json parse_json(const Reading& reading, std::string_view text) {
  if (text.size() > kMaxJsonBytes)
    refuse(reading, fmt::format("{} bytes of JSON text, limit {}", text.size(), kMaxJsonBytes));
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    const auto before = static_cast<std::size_t>(text.data() - reading.begin());
    refuse_byte(reading, before + error.byte, "the JSON text breaks off or is wrong here");
  } catch (const json::exception& error) {  // a number out of range
    refuse(reading, fmt::format("the JSON text is wrong: {}", in_quotes(std::string_view(error.what()))));
  }
}

void JsonView::complain(const std::string& what) const {
  if (motion_.empty()) refuse(*reading_, "the root " + what);
  // The file names its members, so the path may contain anything and be of any length.
  constexpr std::size_t kShown = 120;
  std::string motion = motion_.substr(0, kShown) + (motion_.size() > kShown ? "..." : "");
  std::replace_if(
      motion.begin(), motion.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  refuse(*reading_, fmt::format("{} {}", motion, what));
}

JsonView JsonView::at(const char* key) const {
  if (!value_->is_object()) complain("is not an object");
  const auto found = value_->find(key);
  if (found == value_->end()) complain(fmt::format("has no member \"{}\"", key));
  return {*this, *found, key};
}

JsonView JsonView::at(std::size_t index) const {
  if (index >= size()) complain(fmt::format("has {} elements, number {} is asked for", size(), index));
  return {*this, (*value_)[index], std::to_string(index)};
}

JsonView JsonView::element(const char* key, std::size_t index) const { return at(key).at(index); }

std::size_t JsonView::size() const {
  if (!value_->is_array()) complain("is not an array");
  return value_->size();
}

double JsonView::number() const {
  if (!value_->is_number()) complain("is not a number");
  const double number = value_->get<double>();
  if (!std::isfinite(number)) complain("is not finite");
  return number;
}

std::uint64_t JsonView::index(std::uint64_t end) const {
  const bool is_whole =
      value_->is_number_integer() && (value_->is_number_unsigned() || value_->get<std::int64_t>() >= 0);
  if (!is_whole) complain("is not a whole number of 0 or more");
  const auto number = value_->get<std::uint64_t>();
  if (number >= end) complain(fmt::format("is {}, allowed are numbers below {}", number, end));
  return number;
}

std::string JsonView::text() const {
  if (!value_->is_string()) complain("is not text");
  return value_->get<std::string>();
}

}  // namespace collided::engine
