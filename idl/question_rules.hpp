#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>

#include "collided/codes.hpp"
#include "idl/unit_quaternion.hpp"

/// Rules for the numbers of a question. The client checks them before it sends. The server checks them again on
/// arrival, since clients may not use this library.
namespace collided::wire_contract {

/// The largest magnitude of an input coordinate or length, metres: in a question, a pose, a shape, a file or a command.
/// A few of them can be added without overflow of a double, so that distances between objects are finite.
inline constexpr double kMostCoordinate = 1e290;

/// False for NaN and infinity.
constexpr bool is_coordinate(double x) { return x <= kMostCoordinate && x >= -kMostCoordinate; }
template <class Vector>
bool are_coordinates(const Vector& v) {
  return is_coordinate(v[0]) && is_coordinate(v[1]) && is_coordinate(v[2]);
}

/// point      coordinates
/// direction  coordinates, and not 0 0 0
/// size       a coordinate, 0 or more
/// reach      0 or more; may be infinite
/// rotation   a unit quaternion w x y z
enum class NumberRule : std::uint8_t { point, direction, size, reach, rotation };

/// Numbers of a row that belong together, and their name in errors.
struct NumberField {
  const char* name;
  std::size_t first;
  std::size_t count;
  NumberRule rule;
};

inline constexpr NumberField kRayFields[] = {{"origin", 0, 3, NumberRule::point},
                                             {"direction", 3, 3, NumberRule::direction},
                                             {"length", 6, 1, NumberRule::reach}};
inline constexpr NumberField kSphereFields[] = {{"center", 0, 3, NumberRule::point},
                                                {"radius", 3, 1, NumberRule::size}};
inline constexpr NumberField kBoxFields[] = {{"center", 0, 3, NumberRule::point},
                                             {"half size", 3, 3, NumberRule::size},
                                             {"rotation", 6, 4, NumberRule::rotation}};
inline constexpr NumberField kNearFields[] = {{"point", 0, 3, NumberRule::point},
                                              {"largest distance", 3, 1, NumberRule::reach}};
inline constexpr NumberField kInsideFields[] = {{"point", 0, 3, NumberRule::point}};
inline constexpr NumberField kSweepFields[] = {{"from", 0, 3, NumberRule::point},
                                               {"rotation", 3, 4, NumberRule::rotation},
                                               {"to", 7, 3, NumberRule::point},
                                               {"rotation", 10, 4, NumberRule::rotation}};
inline constexpr NumberField kPoseFields[] = {{"position", 0, 3, NumberRule::point},
                                              {"rotation", 3, 4, NumberRule::rotation}};

/// Number of numbers in a row.
inline constexpr std::uint32_t kRayNumbers = 7;
inline constexpr std::uint32_t kSphereNumbers = 4;
inline constexpr std::uint32_t kBoxNumbers = 10;
inline constexpr std::uint32_t kNearNumbers = 4;
inline constexpr std::uint32_t kInsideNumbers = 3;
inline constexpr std::uint32_t kPoseNumbers = 7;
inline constexpr std::uint32_t kSweepNumbers = 2 * kPoseNumbers;
/// Number of numbers in a question of this kind; for what-if in the pose of each object; 0 for kinds without questions
/// about the world.
constexpr std::uint32_t numbers_of(codes::QuestionKind kind) {
  switch (kind) {
    case codes::QuestionKind::ray: return kRayNumbers;
    case codes::QuestionKind::sphere: return kSphereNumbers;
    case codes::QuestionKind::box: return kBoxNumbers;
    case codes::QuestionKind::near: return kNearNumbers;
    case codes::QuestionKind::sweep: return kSweepNumbers;
    case codes::QuestionKind::inside: return kInsideNumbers;
    case codes::QuestionKind::what_if: return kPoseNumbers;
    default: return 0;
  }
}

/// True if the field's numbers satisfy its rule. NaN never does. Always inline: with a constant field it is a few
/// comparisons.
///
/// numbers  those of the field
[[gnu::always_inline]] constexpr bool is_kept(const NumberField& field, const double* numbers) {
  if (field.rule == NumberRule::rotation) return is_unit_quaternion(numbers[0], numbers[1], numbers[2], numbers[3]);
  bool are_coordinates = true;
  bool any_not_zero = false;
  bool none_negative = true;
  for (std::size_t i = 0; i < field.count; ++i) {
    are_coordinates = are_coordinates && is_coordinate(numbers[i]);
    any_not_zero = any_not_zero || numbers[i] != 0;
    none_negative = none_negative && numbers[i] >= 0;
  }
  switch (field.rule) {
    case NumberRule::point: return are_coordinates;
    case NumberRule::direction: return are_coordinates && any_not_zero;
    case NumberRule::size: return are_coordinates && none_negative;
    case NumberRule::reach: return none_negative;
    default: return false;
  }
}

/// True if a row satisfies all rules; kFields is one of the lists above.
template <const auto& kFields>
bool keeps_rules(const double* row) {
  return [&]<std::size_t... i>(std::index_sequence<i...>) {
    return (is_kept(kFields[i], row + kFields[i].first) && ...);
  }
  (std::make_index_sequence<std::size(kFields)>());
}

}  // namespace collided::wire_contract
