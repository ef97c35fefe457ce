#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "collided/client.hpp"
#include "idl/instant.hpp"
#include "idl/topics.hpp"

namespace collided::client {

/// The instant as the server takes it.
inline wire_contract::AskedInstant instant_of(const Instant& instant) {
  return {.kind = static_cast<wire_contract::AskedInstant::Kind>(instant.kind), .ns = instant.time.count()};
}

/// How a question type is sent: its kind, how many numbers each question has, and its name in errors.
template <class Question>
struct QuestionWire;
template <>
struct QuestionWire<RayQuestion> {
  static constexpr auto kind = wire_contract::QueryKind::ray;
  static constexpr std::uint32_t number_count = wire_contract::kRayNumbers;
  static constexpr const char* noun = "ray";
};
template <>
struct QuestionWire<SphereQuestion> {
  static constexpr auto kind = wire_contract::QueryKind::sphere;
  static constexpr std::uint32_t number_count = wire_contract::kSphereNumbers;
  static constexpr const char* noun = "sphere";
};
template <>
struct QuestionWire<BoxQuestion> {
  static constexpr auto kind = wire_contract::QueryKind::box;
  static constexpr std::uint32_t number_count = wire_contract::kBoxNumbers;
  static constexpr const char* noun = "box";
};
template <>
struct QuestionWire<NearQuestion> {
  static constexpr auto kind = wire_contract::QueryKind::near;
  static constexpr std::uint32_t number_count = wire_contract::kNearNumbers;
  static constexpr const char* noun = "near";
};

template <>
struct QuestionWire<SweepQuestion> {
  static constexpr auto kind = wire_contract::QueryKind::sweep;
  static constexpr std::uint32_t number_count = wire_contract::kSweepNumbers;
  static constexpr const char* noun = "sweep";
};

/// Why a question cannot be asked, such as "direction 0 0 0 has no direction"; nothing: it can.
std::optional<std::string> fault(const RayQuestion& question);
std::optional<std::string> fault(const SphereQuestion& question);
std::optional<std::string> fault(const BoxQuestion& question);
std::optional<std::string> fault(const NearQuestion& question);
std::optional<std::string> fault(const SweepQuestion& question);

/// Whether a question can be asked, quicker than by fault(). Written so that a question with NaN cannot.
inline bool can_be_asked(const RayQuestion& question) {
  const Vec3& d = question.direction;
  return question.origin.allFinite() && d.allFinite() && (d[0] != 0 || d[1] != 0 || d[2] != 0) &&
         question.length_m >= 0;
}
template <class Question>
bool can_be_asked(const Question& question) {
  return !fault(question);
}

/// Writes a question as QuestionWire::number_count numbers.
void encode(const RayQuestion& question, double* numbers);
void encode(const SphereQuestion& question, double* numbers);
void encode(const BoxQuestion& question, double* numbers);
void encode(const NearQuestion& question, double* numbers);
void encode(const SweepQuestion& question, double* numbers);

/// Why a value is not acceptable; nothing: it is. A rotation has norm 1 within kUnitQuaternionSlack.
std::optional<std::string> rotation_fault(const Quat& rotation);
std::optional<std::string> finite_fault(const Vec3& value, const char* name);
/// A size is finite and not negative.
std::optional<std::string> size_fault(double value, const char* name);

}  // namespace collided::client
