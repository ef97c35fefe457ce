#include "server/service/questions/validation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

#include "idl/outside_text.hpp"
#include "idl/question_rules.hpp"
#include "idl/topics.hpp"

namespace collided::engine::service {
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
    if (!wire_contract::is_coordinate(number))
      return Refusal{fmt::format("a pose with {}, allowed are numbers up to 1e290", number)};
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
    const std::size_t length = wire_contract::printable_length(name);
    if (length == 0) return false;
    name.remove_prefix(length);
  }
  return true;
}

std::string printable(std::string_view name) { return wire_contract::in_quotes(name); }

}  // namespace collided::engine::service
