#include "client/library/asking/question_encoding.hpp"

#include <cmath>

#include "client/library/connection/errors.hpp"

namespace collided::client {
namespace {

using wire_contract::NumberField;
using wire_contract::NumberRule;

constexpr const char* kTooLarge = ": allowed are numbers up to 1e290";
static_assert(wire_contract::kMostCoordinate == 1e290);

}  // namespace

std::optional<std::string> fault(const NumberField& field, const double* row) {
  const double* numbers = row + field.first;
  if (wire_contract::is_kept(field, numbers)) { return std::nullopt; }
  std::string text = field.name;
  bool is_finite = true;
  bool is_zero = true;
  for (std::size_t i = 0; i < field.count; ++i) {
    text += ' ' + words(numbers[i]);
    is_finite = is_finite && std::isfinite(numbers[i]);
    is_zero = is_zero && numbers[i] == 0;
  }
  switch (field.rule) {
    case NumberRule::point: return text + (is_finite ? kTooLarge : " is not finite");
    case NumberRule::direction:
      return text + (!is_finite ? " is not finite" : is_zero ? " has no direction" : kTooLarge);
    case NumberRule::size: return text + ": allowed 0 to 1e290";
    case NumberRule::reach: return text + ": allowed 0 to inf";
    case NumberRule::rotation: break;
  }
  return text + " has norm " + words(wire_contract::quaternion_norm(numbers[0], numbers[1], numbers[2], numbers[3])) +
         ", allowed 1 +- " + words(wire_contract::kUnitQuaternionSlack);
}

std::optional<std::string> finite_fault(const Vec3& value, const char* name) {
  return fault({name, 0, 3, NumberRule::point}, value.data());
}

std::optional<std::string> size_fault(double value, const char* name) {
  return fault({name, 0, 1, NumberRule::size}, &value);
}

std::optional<std::string> rotation_fault(const Quat& rotation) {
  const double numbers[] = {rotation.w(), rotation.x(), rotation.y(), rotation.z()};
  return fault({"rotation", 0, 4, NumberRule::rotation}, numbers);
}

}  // namespace collided::client
