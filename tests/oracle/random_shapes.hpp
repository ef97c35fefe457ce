#pragma once

#include <random>

#include "server/geometry/convex_hull.hpp"
#include "server/geometry/pose.hpp"
#include "server/geometry/ray.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::oracle {
using namespace engine;

/// What coordinates look like. Random ones never touch; the lattices touch all the time, the second with rounding.
enum class Family { random, lattice, tenths, far_lattice, tiny, needles };
inline constexpr Family kFamilies[] = {Family::random,      Family::lattice, Family::tenths,
                                       Family::far_lattice, Family::tiny,    Family::needles};
/// Those whose squares and triple products stay in the range of double, for twins that compute in it.
inline constexpr Family kFamiliesOfUsualSize[] = {Family::random, Family::lattice, Family::tenths, Family::far_lattice,
                                                  Family::needles};
inline const char* name(Family f) {
  static constexpr const char* kNames[] = {"random", "lattice", "tenths", "far_lattice", "tiny", "needles"};
  return kNames[static_cast<int>(f)];
}

/// Shapes of one family, a few lattice steps or units across.
class RandomShapes {
 public:
  RandomShapes(std::mt19937_64& generator, Family family) : generator_(generator), family_(family) {}

  double coordinate() {
    const double step = static_cast<double>(std::uniform_int_distribution<int>(0, 4)(generator_));
    switch (family_) {
      case Family::random: return uniform(-1, 1);
      case Family::lattice: return step;
      case Family::tenths: return step * 0.1;
      case Family::far_lattice: return 1e6 + step * 0.25;
      case Family::tiny: return step * 0x1p-560;
      case Family::needles: return uniform(0, 1) < 0.5 ? uniform(-1, 1) : uniform(-1, 1) * 1e-6;
    }
    return 0;
  }
  double size() {
    if (family_ == Family::random || family_ == Family::needles) return uniform(0, 0.8);
    const double step = static_cast<double>(std::uniform_int_distribution<int>(0, 3)(generator_));
    if (family_ == Family::tenths) return step * 0.1;
    if (family_ == Family::far_lattice) return step * 0.25;
    return family_ == Family::tiny ? step * 0x1p-560 : step;
  }
  Vec3 point() { return {coordinate(), coordinate(), coordinate()}; }

  Sphere sphere() { return {point(), size()}; }
  Capsule capsule() { return {point(), point(), size()}; }
  Triangle triangle() { return {point(), point(), point()}; }
  Box box() {
    Box box{point(), Mat3::Identity(), Vec3(size(), size(), size())};
    const int kind = std::uniform_int_distribution<int>(0, 2)(generator_);
    if (kind == 1 || family_ == Family::random) {
      const Quat q = Quat(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized();
      box.axes = frame_of(Pose{Vec3::Zero(), q}).rotation;
    } else if (kind == 2) {
      box.axes << 0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1;  // 3-4-5: not quite orthonormal in double
    }
    return box;
  }
  /// Ends apart, which the kinds with an axis need.
  Cylinder cylinder() {
    Cylinder cylinder{point(), point(), size()};
    while (cylinder.a == cylinder.b) cylinder.b = point();
    return cylinder;
  }
  Cone cone() {
    const Cylinder like = cylinder();
    return {like.a, like.b, like.radius_m};
  }
  Ellipsoid ellipsoid() {
    const Box like = box();
    Ellipsoid ellipsoid{like.center, like.axes, like.half_m};
    for (double& half : ellipsoid.half_m) {
      while (half == 0) half = size();
    }
    return ellipsoid;
  }
  /// Of six points; in families of few coordinates tried until they span space.
  Hull hull() {
    std::optional<TriangleMesh> mesh;
    while (!mesh) {
      std::vector<Vec3> points;
      for (int i = 0; i < 6; ++i) points.push_back(point());
      mesh = convex_hull(points);
    }
    return {std::make_shared<const TriangleMesh>(std::move(*mesh))};
  }
  /// Of the kinds 0 to 6: sphere, box, capsule, hull, cylinder, cone, ellipsoid.
  Primitive solid(int kind) {
    switch (kind) {
      case 0: return sphere();
      case 1: return box();
      case 2: return capsule();
      case 3: return hull();
      case 4: return cylinder();
      case 5: return cone();
      default: return ellipsoid();
    }
  }
  Ray ray(bool limited) {
    Ray ray{point(), point() - point()};
    while (ray.direction.isZero(0)) ray.direction = point() - point();
    if (limited) ray.length_m = uniform(0, 1) < 0.3 ? size() : size() * 2;
    return ray;
  }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator_); }

  std::mt19937_64& generator_;
  Family family_;
};

}  // namespace collided::oracle
