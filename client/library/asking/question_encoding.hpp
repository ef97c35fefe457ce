#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "collided/client.hpp"
#include "idl/instant.hpp"
#include "idl/question_rules.hpp"
#include "idl/topics.hpp"

namespace collided::client {

/// The instant in the server's form.
inline wire_contract::AskedInstant instant_of(const Instant& instant) {
  return {.kind = static_cast<wire_contract::AskedInstant::Kind>(instant.kind), .ns = instant.time.count()};
}

/// The wire form of a question type: its kind, its number of numbers per question, and its name in errors.
template <class Question>
struct QuestionWire;
template <>
struct QuestionWire<RayQuestion> {
  static constexpr auto kind = wire_contract::QuestionKind::ray;
  static constexpr std::uint32_t number_count = wire_contract::kRayNumbers;
  static constexpr const char* noun = "ray";
  static constexpr const auto& fields = wire_contract::kRayFields;
};
template <>
struct QuestionWire<SphereQuestion> {
  static constexpr auto kind = wire_contract::QuestionKind::sphere;
  static constexpr std::uint32_t number_count = wire_contract::kSphereNumbers;
  static constexpr const char* noun = "sphere";
  static constexpr const auto& fields = wire_contract::kSphereFields;
};
template <>
struct QuestionWire<BoxQuestion> {
  static constexpr auto kind = wire_contract::QuestionKind::box;
  static constexpr std::uint32_t number_count = wire_contract::kBoxNumbers;
  static constexpr const char* noun = "box";
  static constexpr const auto& fields = wire_contract::kBoxFields;
};
template <>
struct QuestionWire<NearQuestion> {
  static constexpr auto kind = wire_contract::QuestionKind::near;
  static constexpr std::uint32_t number_count = wire_contract::kNearNumbers;
  static constexpr const char* noun = "near";
  static constexpr const auto& fields = wire_contract::kNearFields;
};

template <>
struct QuestionWire<InsideQuestion> {
  static constexpr auto kind = wire_contract::QuestionKind::inside;
  static constexpr std::uint32_t number_count = wire_contract::kInsideNumbers;
  static constexpr const char* noun = "inside";
  static constexpr const auto& fields = wire_contract::kInsideFields;
};

template <>
struct QuestionWire<SweepQuestion> {
  static constexpr auto kind = wire_contract::QuestionKind::sweep;
  static constexpr std::uint32_t number_count = wire_contract::kSweepNumbers;
  static constexpr const char* noun = "sweep";
  static constexpr const auto& fields = wire_contract::kSweepFields;
};

inline void put(double*& numbers, const Vec3& value) { numbers = std::copy_n(value.data(), 3, numbers); }
inline void put(double*& numbers, const Quat& rotation) {
  *numbers++ = rotation.w();
  put(numbers, Vec3(rotation.vec()));
}
inline void put(double*& numbers, double value) { *numbers++ = value; }
inline void put(double*& numbers, const Pose& pose) {
  put(numbers, pose.position);
  put(numbers, pose.rotation);
}

/// Writes a question as QuestionWire::number_count numbers.
inline void encode(const RayQuestion& question, double* numbers) {
  put(numbers, question.origin);
  put(numbers, question.direction);
  put(numbers, question.length_m);
}
inline void encode(const SphereQuestion& question, double* numbers) {
  put(numbers, question.center);
  put(numbers, question.radius_m);
}
inline void encode(const BoxQuestion& question, double* numbers) {
  put(numbers, question.center);
  put(numbers, question.half_m);
  put(numbers, question.rotation);
}
inline void encode(const NearQuestion& question, double* numbers) {
  put(numbers, question.point);
  put(numbers, question.within_m);
}
inline void encode(const InsideQuestion& question, double* numbers) { put(numbers, question.point); }
inline void encode(const SweepQuestion& question, double* numbers) {
  put(numbers, question.from);
  put(numbers, question.to);
}

/// Why a field's numbers violate its rule, such as "direction 0 0 0 has no direction"; nothing: they do not.
///
/// row  of the question that has the field
std::optional<std::string> fault(const wire_contract::NumberField& field, const double* row);

/// Why a question is invalid; nothing: it is valid.
template <class Question>
std::optional<std::string> fault(const Question& question) {
  using Wire = QuestionWire<Question>;
  std::array<double, Wire::number_count> row;
  encode(question, row.data());
  if (wire_contract::keeps_rules<Wire::fields>(row.data())) { return std::nullopt; }
  for (const wire_contract::NumberField& field : Wire::fields) {
    if (auto found = fault(field, row.data())) { return found; }
  }
  return std::nullopt;
}

/// Why a value is not acceptable; nothing: it is.
std::optional<std::string> rotation_fault(const Quat& rotation);
std::optional<std::string> finite_fault(const Vec3& value, const char* name);
/// A size is finite and not negative.
std::optional<std::string> size_fault(double value, const char* name);

}  // namespace collided::client
