#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>

#include <array>
#include <optional>
#include <vector>

#include "server/geometry/pose.hpp"
#include "server/geometry/ray.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::oracle {
using namespace engine;

// The slow and sure twin of the exact phase: rationals, or 100 digits where a root is needed, and formulations that
// share nothing with the product's. Distances are least over every pair of faces by solving normal equations; boxes
// and triangles meet when an edge of one, clipped by the other, keeps something.

using Rational = boost::multiprecision::cpp_rational;
using Wide = boost::multiprecision::cpp_bin_float_100;
using Point = std::array<Rational, 3>;

Point exact(const Vec3& v);

/// origin + sum of parameters in [0, 1] times directions; for the inside of a triangle they also sum to at most 1; the
/// last direction of a ray has no upper limit.
struct Face {
  Point origin;
  std::vector<Point> directions;
  bool simplex = false;
  bool endless = false;
};

/// A closed set: the union of its faces of every dimension, grown by a radius.
struct Figure {
  std::vector<Face> faces;
  Rational radius = 0;
};

Figure figure(const Sphere& sphere);
Figure figure(const Box& box);
Figure figure(const Capsule& capsule);
Figure figure(const Triangle& triangle);
Figure segment_figure(const Point& a, const Point& b);

/// Of the figures without their radii.
Rational squared_distance(const Figure& a, const Figure& b);
bool overlaps(const Figure& a, const Figure& b);
/// The same for shapes without radius by clipping edges; faster, and a second opinion.
bool overlaps_by_clipping(const Box& a, const Box& b, const Point& shift_b = {});
bool overlaps_by_clipping(const Box& a, const Triangle& b, const Point& shift_b = {});
bool overlaps_by_clipping(const Triangle& a, const Triangle& b, const Point& shift_b = {});

Wide distance(const Figure& a, const Figure& b);

Figure shifted(Figure figure, const Point& by);
/// q v q* / |q|^2, and back.
Point turned(const Quat& q, const Point& v);
Point turned_back(const Quat& q, const Point& v);
/// The figure of a shape in its own frame where the pose has it, not rounded.
Figure placed(Figure figure, const Pose& pose);
/// All that a figure without triangles covers during a translation.
Figure swept(const Figure& figure, const Point& way);
/// Length of the shortest translation that parts two figures without radii, when they share a point: the nearest plane
/// through three points of the Minkowski difference that has all others on one side. Plain double.
double part_length(const Figure& a, const Figure& b);

/// First parameter s >= 0 (metres are s |direction|) at which the ray meets the triangle, length limit applied.
std::optional<Rational> first_parameter(const Ray& ray, const Triangle& triangle);
std::optional<Rational> first_parameter(const Ray& ray, const Box& box);
/// Whether a ray meets a ball or capsule.
bool ray_meets(const Ray& ray, const Figure& solid);
/// Distance of the first meeting, given that there is one.
Wide first_distance(const Ray& ray, const Figure& solid);
Wide length(const Vec3& v);

}  // namespace collided::oracle
