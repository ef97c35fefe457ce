#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "collided/client.hpp"

namespace collided::model {

/// Boxes along the axes whose faces lie on a lattice of an eighth of a metre: what meets what is a matter of comparing whole numbers.
using Lattice = std::array<int, 3>;
inline constexpr double kStep_m = 0.125;
inline Vec3 metres(const Lattice& at) { return {at[0] * kStep_m, at[1] * kStep_m, at[2] * kStep_m}; }

/// A rectangle at the height z as an OBJ of two triangles named "sheet"; corners and height on the lattice.
std::string sheet(std::array<int, 2> low, std::array<int, 2> high, int z);

struct PlainBox {
  Vec3 low;
  Vec3 high;
};
bool share_a_point(const PlainBox& a, const PlainBox& b);
double gap(const PlainBox& a, const PlainBox& b);
/// How far one has to go along an axis until the two part; only of boxes that overlap.
double depth(const PlainBox& a, const PlainBox& b);
double gap(const Vec3& point, const PlainBox& box);

/// Where a ray along an axis enters it; 0 where it begins inside.
struct AxisRay {
  Vec3 origin;
  int axis = 0;
  int sign = 1;
  double length_m = INFINITY;
};
std::optional<double> entry(const AxisRay& ray, const PlainBox& box);
/// When a box that moves along an axis by travel_m while time runs from 0 to 1 first shares a point with another.
std::optional<double> first_contact(const PlainBox& moving, int axis, double travel_m, const PlainBox& box);

/// One thing in the world: boxes about an origin. A scene's is flat, and made of triangles.
struct PlainObject {
  std::vector<std::array<Lattice, 2>> parts;  // centre and half
  Lattice origin{};
  std::uint32_t layers = 1;
  std::uint32_t mask = 0xffffffff;
  std::uint32_t group = 0;
  bool is_scene = false;

  std::vector<PlainBox> boxes() const;
};
bool may_meet(const PlainObject& a, const PlainObject& b);
bool share_a_point(const PlainObject& a, const PlainObject& b);

/// Everything by name, and what may answer a question.
struct PlainBoxes {
  std::map<std::string, PlainObject> objects;

  using Pair = std::pair<std::string, std::string>;  // in order
  std::set<Pair> contacts() const;
  std::map<std::string, std::vector<PlainBox>> allowed(const AskOptions& options) const;
};

}  // namespace collided::model
