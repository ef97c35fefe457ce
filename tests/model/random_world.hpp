#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "server/geometry/convex_hull.hpp"
#include "server/intake/scene.hpp"
#include "server/world/world.hpp"

namespace collided::model {
using namespace engine;

/// What a random sequence of operations is made of: a few names, shapes of every kind, scenes of two parts and an object.
class RandomWorld {
 public:
  explicit RandomWorld(std::mt19937_64& random) : random_(random) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  bool chance(double probability) { return uniform(0, 1) < probability; }
  int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  Vec3 point(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
  Quat turn() { return Quat(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized(); }
  Pose pose() { return {.position = point(kReach), .rotation = turn()}; }
  /// Some step on from where it is; mostly small, so that what is near stays near.
  Pose next(const Pose& pose) {
    if (!only_slow_meshes && chance(0.15)) return this->pose();
    const double size = only_slow_meshes ? 0.003 : chance(0.7) ? 0.03 : 0.5;
    const Quat small = Quat(1, uniform(-size, size), uniform(-size, size), uniform(-size, size)).normalized();
    return {.position = pose.position + point(size),
            .rotation = chance(0.5) ? pose.rotation : Quat((small * pose.rotation).normalized())};
  }

  template <class Items>
  const auto& one_of(const Items& items) {
    return items[static_cast<std::size_t>(below(static_cast<int>(items.size())))];
  }
  std::string name() {
    return one_of(
        std::vector<std::string>{"ape", "bat", "cat", "cow", "dog", "eel", "elk", "fox", "gnu", "hen", "ibex", "jay"});
  }
  /// Few values, so that objects share them and questions meet some and not others.
  std::uint32_t layers() { return 1u << below(3); }
  Filter filter() {
    return {.layers = layers(), .mask = chance(0.5) ? 0xffffffffu : 5u, .group = chance(0.8) ? 0u : 1u};
  }
  ObjectDefinition definition(const std::string& name) {
    ObjectDefinition made;
    made.name = name;
    made.shape = shape();
    made.pose = pose();
    made.filter = filter();
    made.moving = chance(0.85);
    return made;
  }
  Scene scene(const std::string& name);
  Shape shape();

  bool only_slow_meshes = false;  // what is known of their distances is kept from step to step

 private:
  static constexpr double kReach = 1.6;
  std::shared_ptr<const TriangleMesh> mesh();
  Primitive solid(int kind);

  std::mt19937_64& random_;
  std::vector<std::shared_ptr<const TriangleMesh>> meshes_;
};

}  // namespace collided::model
