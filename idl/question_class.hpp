#pragma once

#include <cstdint>

#include "idl/topics.hpp"

namespace collided::wire_contract {

/// How much a question matters while not all can be answered: low ones are refused first, high ones never.
enum class QuestionClass : std::uint8_t { normal, low, high };

/// Query.mode holds both: the class in its two upper bits, the RayMode below.
inline constexpr int kClassShift = 6;
inline constexpr std::uint8_t mode_byte(RayMode mode, QuestionClass importance) {
  return static_cast<std::uint8_t>(static_cast<unsigned>(mode) | static_cast<unsigned>(importance) << kClassShift);
}
inline constexpr RayMode ray_mode(std::uint8_t byte) {
  return static_cast<RayMode>(byte & ((1U << kClassShift) - 1));
}
inline constexpr QuestionClass question_class(std::uint8_t byte) {
  return static_cast<QuestionClass>(byte >> kClassShift);
}

}  // namespace collided::wire_contract
