#pragma once

#include <random>

#include "tests/extreme/worlds.hpp"

namespace collided::extreme {
using namespace engine;

/// Where coordinates come from. On the lattice of halves a good part of all things touch exactly; random ones are
/// multiples of 2^-20, so that shifts, mirrorings and exact turns of them are exact as well.
enum class Ground { lattice, random };
inline constexpr Ground kGrounds[] = {Ground::lattice, Ground::random};

/// A scene as plain data, so that it can be changed before it is built: balls, boxes, capsules, meshes, compounds.
struct Cast {
  std::vector<ObjectDefinition> movers;
  TriangleMesh scene;
};

class Mixer {
 public:
  Mixer(std::mt19937_64& random, Ground ground) : random_(random), ground_(ground) {}

  double coordinate(int reach) {
    const int finer = ground_ == Ground::lattice ? 2 : 1 << 20;
    return static_cast<double>(std::uniform_int_distribution<int>(-reach * finer, reach * finer)(random_)) / finer;
  }
  double size() {
    const int finer = ground_ == Ground::lattice ? 2 : 1 << 20;
    return static_cast<double>(std::uniform_int_distribution<int>(finer / 2, finer)(random_)) / finer;
  }
  Vec3 point(int reach) {
    const double x = coordinate(reach);
    const double y = coordinate(reach);
    return {x, y, coordinate(reach)};
  }

  Cast cast(int count) {
    Cast all;
    for (int i = 0; i < count; ++i) {
      ObjectDefinition body;
      body.name = "body" + std::to_string(i);
      body.pose.position = point(4);
      if (i % 4 == 0) body.shape.primitives.push_back(Sphere{Vec3::Zero(), size()});
      if (i % 4 == 1 || i % 8 == 0) {
        const double x = size();
        const double y = size();
        body.shape.primitives.push_back(Box{.center = Vec3::Zero(), .half_m = {x, y, size()}});
      }
      if (i % 4 == 2) body.shape.primitives.push_back(Capsule{point(1), point(1), size()});
      if (i % 4 == 3) {
        TriangleMesh mesh;
        mesh.vertices = {point(1), point(1), point(1), point(1)};
        mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
        body.shape.mesh = shared_mesh(mesh);
      }
      all.movers.push_back(body);
    }
    for (std::uint32_t i = 0; i < 60; ++i) {
      for (int k = 0; k < 3; ++k) all.scene.vertices.push_back(point(4));
      all.scene.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return all;
  }

  std::vector<double> rays(int count) {
    std::vector<double> numbers;
    for (int i = 0; i < count; ++i) {
      const Vec3 from = point(6);
      Vec3 along = point(2);
      while (along.isZero(0)) along = point(2);
      numbers.insert(numbers.end(), {from.x(), from.y(), from.z(), along.x(), along.y(), along.z(),
                                     i % 2 == 0 ? kEndless : 4 * size()});
    }
    return numbers;
  }
  std::vector<double> balls(int count) {
    std::vector<double> numbers;
    for (int i = 0; i < count; ++i) {
      const Vec3 center = point(5);
      numbers.insert(numbers.end(), {center.x(), center.y(), center.z(), size()});
    }
    return numbers;
  }
  std::vector<double> boxes(int count) {
    std::vector<double> numbers;
    for (int i = 0; i < count; ++i) {
      const Vec3 center = point(5);
      const double half = size();
      numbers.insert(numbers.end(), {center.x(), center.y(), center.z(), half, size(), half, 1, 0, 0, 0});
    }
    return numbers;
  }
  std::vector<double> questions(QuestionKind kind, int count) {
    if (kind == QuestionKind::ray) return rays(count);
    return kind == QuestionKind::box ? boxes(count) : balls(count);
  }

 private:
  std::mt19937_64& random_;
  Ground ground_;
};

inline constexpr QuestionKind kKinds[] = {QuestionKind::ray, QuestionKind::sphere, QuestionKind::box,
                                          QuestionKind::near};

/// Objects get their ids in the order of the cast.
inline void build(Stage& stage, const Cast& cast) {
  if (!cast.scene.triangles.empty()) stage.load("scene", cast.scene);
  for (const ObjectDefinition& body : cast.movers)
    stage.add(body.name, body.shape, body.pose, body.moving, body.filter);
  stage.step();
}

/// The same answers by the same objects, distances times `scale` within both bounds; points and normals aside.
inline void expect_same_story(const Answers& before, const Answers& after, double scale) {
  ASSERT_EQ(before.answers, after.answers);
  ASSERT_EQ(before.hit_counts, after.hit_counts);
  for (std::size_t i = 0; i < before.hits.size(); ++i) {
    const AnswerHit& a = before.hits[i];
    const AnswerHit& b = after.hits[i];
    ASSERT_EQ(a.object, b.object) << i;
    ASSERT_EQ(a.flags, b.flags) << i;
    ASSERT_LE(std::abs(a.distance_m * scale - b.distance_m), a.error_m * scale + b.error_m) << i;
  }
}

}  // namespace collided::extreme
