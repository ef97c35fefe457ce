#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "server/geometry/convex_hull.hpp"
#include "server/world/query/pair_report.hpp"
#include "tests/extreme/worlds.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {

/// A shape of one part, for the world and for an oracle.
struct GivenSample {
  std::string name;
  Shape shape;
  ConvexPart part;
};

/// Posed shapes, and pairs of them that are brought to where they touch but for some roundings.
class GivenPairs : public testing::Test {
 protected:
  double any(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
  Vec3 point(double size) { return {any(-size, size), any(-size, size), any(-size, size)}; }
  /// Turned at random, by a quaternion that is not quite of length 1.
  Pose pose(double far_m) {
    std::normal_distribution<double> normal;
    Pose made{.position = Vec3::Constant(far_m) + point(1),
              .rotation = Quat(normal(random), normal(random), normal(random), normal(random)).normalized()};
    made.rotation.coeffs() *= 1 + any(-9e-7, 9e-7);
    return made;
  }
  template <class Solid>
  static GivenSample solid(const char* name, const Solid& own) {
    return {name, {.primitives = {own}, .mesh = nullptr}, Primitive(own)};
  }
  static GivenSample triangle(const Triangle& own) {
    TriangleMesh mesh;
    mesh.vertices = {own.a, own.b, own.c};
    mesh.triangles = {{0, 1, 2}};
    return {"triangle", extreme::mesh_shape(mesh), own};
  }

  static constexpr const char* kEndless = "half-space";
  static constexpr int kKinds = 8;
  static constexpr int kRound = 3;  // kinds before this one are round solids

  /// Everyday ones, and among the round ones also thin discs and needles.
  GivenSample solid_sample(int kind) {
    const double thin = any(0, 1) < 0.3 ? 1e-3 : 1;
    const Vec3 a = point(1);
    const Vec3 b = a + thin * (Vec3(0.5, 0.5, 0.5) + 0.5 * point(1));
    switch (kind) {
      case 0: return solid("cylinder", Cylinder{a, b, any(0.1, 1)});
      case 1: return solid("cone", Cone{a, b, any(0.1, 1)});
      case 2:
        return solid("ellipsoid", Ellipsoid{.center = a, .half_m = {any(0.1, 1), any(0.1, 1) * thin, any(0.1, 1)}});
      case 3: return solid("sphere", Sphere{a, any(0.1, 1)});
      case 4: return solid("capsule", Capsule{a, b, any(0.1, 0.5)});
      case 5: return solid("box", Box{.center = a, .half_m = {any(0.1, 1), any(0.1, 1), any(0.1, 1)}});
      case 6: {
        std::vector<Vec3> corners;
        for (int i = 0; i < 12; ++i) corners.push_back(point(1));
        return solid("hull", Hull{std::make_shared<const TriangleMesh>(*convex_hull(corners))});
      }
      default: return triangle({a, b, point(1)});
    }
  }

  /// A world with just the two.
  struct Pair {
    extreme::Stage stage;
    PairReport report;

    Pair(const GivenSample& a, const Pose& a_pose, const GivenSample& b, const Pose& b_pose) {
      // What has no end does not move.
      const ObjectId first = stage.add("a", a.shape, a_pose, a.name != kEndless);
      const ObjectId second = stage.add("b", b.shape, b_pose, b.name != kEndless);
      stage.step();
      report = report_pair(*stage.world.newest(), first, second, {});
    }
  };

  /// Moves b so that the two are apart, or in each other, by some roundings at most.
  static void bring_together(const GivenSample& a, const Pose& a_pose, const GivenSample& b, Pose& b_pose) {
    for (int i = 0; i < 3; ++i) {
      const PairReport report = Pair(a, a_pose, b, b_pose).report;
      const bool in_each_other = report.touches == Decision::yes;
      const Vec3 normal = in_each_other ? report.contact.normal : report.separation.normal;
      b_pose.position += (in_each_other ? report.contact.depth_m : -report.separation.distance_m) * normal;
    }
  }

  std::mt19937_64 random = oracle::seeded(73);
};

}  // namespace collided::engine
