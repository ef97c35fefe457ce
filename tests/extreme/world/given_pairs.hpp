#pragma once

#include <gtest/gtest.h>

#include <random>
#include <string>

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

  /// A world with just the two.
  struct Pair {
    extreme::Stage stage;
    PairReport report;

    Pair(const GivenSample& a, const Pose& a_pose, const GivenSample& b, const Pose& b_pose) {
      const ObjectId first = stage.add("a", a.shape, a_pose);
      const ObjectId second = stage.add("b", b.shape, b_pose);
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
