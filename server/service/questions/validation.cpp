#include "server/service/questions/validation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

#include "idl/question_rules.hpp"
#include "idl/topics.hpp"

namespace collided::engine::service {
namespace {

/// Length of the well-formed UTF-8 sequence at the start of the text; 0 where there is none.
///
/// source  The Unicode Standard, table 3-7
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const auto follows = [&](std::size_t i, unsigned low = 0x80, unsigned high = 0xBF) {
    return byte(i) >= low && byte(i) <= high;
  };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF) return follows(1) ? 2 : 0;
  if (lead >= 0xE0 && lead <= 0xEF) {
    const unsigned low = lead == 0xE0 ? 0xA0 : 0x80;
    const unsigned high = lead == 0xED ? 0x9F : 0xBF;
    return follows(1, low, high) && follows(2) ? 3 : 0;
  }
  if (lead >= 0xF0 && lead <= 0xF4) {
    const unsigned low = lead == 0xF0 ? 0x90 : 0x80;
    const unsigned high = lead == 0xF4 ? 0x8F : 0xBF;
    return follows(1, low, high) && follows(2) && follows(3) ? 4 : 0;
  }
  return 0;
}

/// Bytes of the printable character at the start of a text that is not empty; 0 where there is none.
std::size_t printable_length(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  const bool control = lead < 0x20 || lead == 0x7F;
  return control ? 0 : utf8_length(text);
}

}  // namespace

bool read_pose(const double* numbers, Pose& pose) {
  if (!wire_contract::keeps_rules<wire_contract::kPoseFields>(numbers)) return false;
  pose.position = {numbers[0], numbers[1], numbers[2]};
  pose.rotation = Quat(numbers[3], numbers[4], numbers[5], numbers[6]);
  return true;
}

std::variant<Pose, Refusal> checked_pose(std::span<const double> numbers) {
  if (numbers.size() != wire_contract::kPoseNumbers) {
    return Refusal{fmt::format("a pose of {} numbers; {} are needed", numbers.size(), wire_contract::kPoseNumbers)};
  }
  for (const double number : numbers) {
    if (!std::isfinite(number)) return Refusal{fmt::format("a pose with {}", number)};
  }
  Pose pose;
  if (read_pose(numbers.data(), pose)) return pose;
  return Refusal{fmt::format("quaternion norm {:.9g}, allowed 1 +- {:g}",
                             Quat(numbers[3], numbers[4], numbers[5], numbers[6]).norm(),
                             wire_contract::kUnitQuaternionSlack)};
}

bool is_good_name(std::string_view name) {
  if (name.empty() || name.size() > wire_contract::kMaxNameBytes) return false;
  while (!name.empty()) {
    const std::size_t length = printable_length(name);
    if (length == 0) return false;
    name.remove_prefix(length);
  }
  return true;
}

std::string printable(std::string_view name) {
  constexpr std::size_t kMostBytes = 80;
  std::string text = "'";
  while (!name.empty() && text.size() < kMostBytes) {
    const std::size_t length = printable_length(name);
    text += length == 0 ? std::string_view("?") : name.substr(0, length);
    name.remove_prefix(length == 0 ? 1 : length);
  }
  return text + (name.empty() ? "'" : "...'");
}

}  // namespace collided::engine::service
