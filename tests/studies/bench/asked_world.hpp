#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "server/intake/scene.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/bench/changing_world.hpp"

namespace collided::bench {

inline constexpr double kRadius_m = 0.5;

inline Vec3 in_cube(double side_m, std::mt19937_64& random) {
  std::uniform_real_distribution<double> along(-side_m / 2, side_m / 2);
  const double x = along(random), y = along(random);
  return {x, y, along(random)};
}

/// Whole answers about a world.
class AskedWorld : public ChangingWorld {
 public:
  using ChangingWorld::ChangingWorld;
  void ask(const Questions& asked) { answer(*world_.newest(), asked, answers_, scratch_); }

 protected:
  void load(const std::string& name, TriangleMesh mesh) {
    Scene scene{.name = name, .mesh = std::move(mesh), .parts = {}, .objects = {}};
    scene.parts.push_back({.name = name, .triangle_count = static_cast<std::uint32_t>(scene.mesh.triangles.size())});
    world_.add_scene(World::index_scene(std::move(scene), {}));
  }

 private:
  Answers answers_;
  QueryScratch scratch_;
};

/// Balls that have moved, in a cube or over hills as wide as it.
class AskedCrowd : public AskedWorld {
 public:
  AskedCrowd(std::size_t count, double side_m, int hills, std::mt19937_64& random) : AskedWorld(count + 1) {
    for (std::size_t i = 0; i < count; ++i)
      define(std::to_string(i), Sphere{Vec3::Zero(), kRadius_m}, in_cube(side_m, random));
    if (hills > 0) load("hills", scenes::terrain(static_cast<std::uint32_t>(hills), side_m, 7));
    step();
    for (std::size_t i = 0; i < count; ++i) {
      poses_[i].position.x() += 0.01;
      if (!world_.move(ids_[i], poses_[i], time_ns_ + kPeriodNs, false)) std::abort();
    }
    step();
  }
};

/// Small meshes, each a scene of its own.
class ManyScenes : public AskedWorld {
 public:
  ManyScenes(std::size_t count, double side_m, std::mt19937_64& random) : AskedWorld(count + 1) {
    for (std::size_t i = 0; i < count; ++i) {
      TriangleMesh mesh = scenes::icosphere(1, kRadius_m);
      const Vec3 at = in_cube(side_m, random);
      for (Vec3& vertex : mesh.vertices) vertex += at;
      load(std::to_string(i), std::move(mesh));
    }
    step();
  }
};

/// Questions of one kind about a cube.
inline std::vector<double> questions_about(QuestionKind kind, double side_m, std::size_t count,
                                           std::mt19937_64& random) {
  constexpr double kNoEnd = std::numeric_limits<double>::infinity();
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 at = in_cube(side_m, random);
    const Vec3 way = in_cube(1, random).normalized();
    const Vec3 to = at + 2 * way;
    numbers.insert(numbers.end(), {at.x(), at.y(), at.z()});
    switch (kind) {
      case QuestionKind::ray: numbers.insert(numbers.end(), {way.x(), way.y(), way.z(), kNoEnd}); break;
      case QuestionKind::sphere: numbers.push_back(1); break;
      case QuestionKind::box: numbers.insert(numbers.end(), {1, 1, 1, 1, 0, 0, 0}); break;
      case QuestionKind::near: numbers.push_back(kNoEnd); break;
      case QuestionKind::sweep: numbers.insert(numbers.end(), {1, 0, 0, 0, to.x(), to.y(), to.z(), 1, 0, 0, 0}); break;
      default: std::abort();
    }
  }
  return numbers;
}

}  // namespace collided::bench
