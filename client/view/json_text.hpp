#pragma once

#include <chrono>
#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "collided/geometry.hpp"

/// Numbers, vectors and texts in the page's format.
namespace collided::view {

/// The value as text; bytes that are not UTF-8 become U+FFFD.
inline std::string text_of(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// A number; infinity is a text, since JSON has none, as in the command line's output.
inline nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(value > 0 ? "inf" : value < 0 ? "-inf" : "nan");
}

inline nlohmann::json numbers(const Vec3& v) { return {number(v.x()), number(v.y()), number(v.z())}; }

inline void append(nlohmann::json& list, double value) { list.push_back(number(value)); }

inline void append(nlohmann::json& list, const Vec3& v) {
  for (int axis = 0; axis < 3; ++axis) append(list, v[axis]);
}

/// The parts in the order w x y z.
inline void append(nlohmann::json& list, const Quat& q) {
  for (const double part : {q.w(), q.x(), q.y(), q.z()}) append(list, part);
}

inline double seconds(std::chrono::nanoseconds time) { return static_cast<double>(time.count()) * 1e-9; }

}  // namespace collided::view
