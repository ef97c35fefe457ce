#include "client/library/asking/question_encoding.hpp"

#include <algorithm>
#include <cmath>

#include "client/library/connection/errors.hpp"

namespace collided::client {
namespace {

using wire_contract::kUnitQuaternionSlack;

void put(double*& numbers, const Vec3& value) { numbers = std::copy_n(value.data(), 3, numbers); }

void put(double*& numbers, const Quat& rotation) {
  *numbers++ = rotation.w();
  put(numbers, Vec3(rotation.vec()));
}

// Of a reach, which may be endless.
std::optional<std::string> length_fault(double value, const char* name) {
  if (value >= 0) { return std::nullopt; }
  return std::string(name) + ' ' + words(value) + ": allowed 0 to inf";
}

}  // namespace

std::optional<std::string> finite_fault(const Vec3& value, const char* name) {
  if (value.allFinite()) { return std::nullopt; }
  return std::string(name) + ' ' + words(value) + " is not finite";
}

std::optional<std::string> size_fault(double value, const char* name) {
  if (value >= 0 && std::isfinite(value)) { return std::nullopt; }
  return std::string(name) + ' ' + words(value) + ": allowed 0 or more, and finite";
}

std::optional<std::string> rotation_fault(const Quat& rotation) {
  const double norm = rotation.norm();
  if (std::abs(norm - 1) <= kUnitQuaternionSlack) { return std::nullopt; }
  return "rotation " + words(rotation.w()) + ' ' + words(Vec3(rotation.vec())) + " has norm " + words(norm) +
         ", allowed 1 +- " + words(kUnitQuaternionSlack);
}

std::optional<std::string> fault(const RayQuestion& question) {
  if (auto found = finite_fault(question.origin, "origin")) { return found; }
  if (auto found = finite_fault(question.direction, "direction")) { return found; }
  // Not by its norm: the squares of a tiny direction vanish.
  if ((question.direction.array() == 0).all()) {
    return "direction " + words(question.direction) + " has no direction";
  }
  return length_fault(question.length_m, "length");
}

std::optional<std::string> fault(const SphereQuestion& question) {
  auto found = finite_fault(question.center, "center");
  return found ? found : size_fault(question.radius_m, "radius");
}

std::optional<std::string> fault(const BoxQuestion& question) {
  if (auto found = finite_fault(question.center, "center")) { return found; }
  if (!question.half_m.allFinite() || !(question.half_m.array() >= 0).all()) {
    return "half size " + words(question.half_m) + ": allowed 0 or more, and finite";
  }
  return rotation_fault(question.rotation);
}

std::optional<std::string> fault(const NearQuestion& question) {
  auto found = finite_fault(question.point, "point");
  return found ? found : length_fault(question.within_m, "largest distance");
}

std::optional<std::string> fault(const SweepQuestion& question) {
  for (const auto& [pose, name] : {std::pair(&question.from, "from"), std::pair(&question.to, "to")}) {
    auto found = finite_fault(pose->position, name);
    if (!found) found = rotation_fault(pose->rotation);
    if (found) return found;
  }
  return std::nullopt;
}

void encode(const RayQuestion& question, double* numbers) {
  put(numbers, question.origin);
  put(numbers, question.direction);
  *numbers = question.length_m;
}

void encode(const SphereQuestion& question, double* numbers) {
  put(numbers, question.center);
  *numbers = question.radius_m;
}

void encode(const BoxQuestion& question, double* numbers) {
  put(numbers, question.center);
  put(numbers, question.half_m);
  put(numbers, question.rotation);
}

void encode(const SweepQuestion& question, double* numbers) {
  for (const Pose* pose : {&question.from, &question.to}) {
    put(numbers, pose->position);
    put(numbers, pose->rotation);
  }
}

void encode(const NearQuestion& question, double* numbers) {
  put(numbers, question.point);
  *numbers = question.within_m;
}

}  // namespace collided::client
