#pragma once

#include <random>
#include <string>
#include <variant>
#include <vector>

#include "server/geometry/convex_hull.hpp"
#include "server/world/world.hpp"

namespace collided::oracle {
using namespace engine;

/// A world of all kinds: a bumpy static sheet in parts, and moving spheres, boxes, capsules, meshes and compounds.
class MixedWorld {
 public:
  explicit MixedWorld(std::mt19937_64& random) : random_(random), world(WorldOptions{}) {
    load_sheet();
    for (int i = 0; i < 60; ++i) add(i);
    add_many_parts();
    world.step(0, 1, {});
  }

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vec3 point(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
  Pose pose() {
    Quat turned(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    return {.position = point(4), .rotation = turned.normalized()};
  }

  /// Near the edges of where things are, one of them along the axes. Most rays meet one.
  void add_half_spaces() {
    for (int i = 0; i < 2; ++i) {
      ObjectDefinition definition;
      definition.name = "half_space" + std::to_string(i);
      definition.pose = i == 0 ? Pose{.position = {0, 0, -3}, .rotation = Quat::Identity()}
                               : Pose{.position = Vec3(-2, -2, -2), .rotation = pose().rotation};
      definition.shape.primitives.push_back(
          HalfSpace{{0, 0, 0}, i == 0 ? Vec3(0, 0, 1) : Vec3(definition.pose.rotation.inverse() * Vec3(1, 1, 1))});
      definition.moving = false;
      world.define(definition);
    }
    world.step(1, 1, {});
  }

  World& operator*() { return world; }
  const std::vector<ObjectId>& movers() const { return movers_; }

 private:
  void load_sheet() {
    Scene scene;
    scene.name = "sheet";
    constexpr std::uint32_t kSide = 24;
    for (std::uint32_t y = 0; y <= kSide; ++y) {
      for (std::uint32_t x = 0; x <= kSide; ++x) {
        scene.mesh.vertices.push_back({x / 3.0 - 4, y / 3.0 - 4, uniform(-0.3, 0.3)});
      }
    }
    for (std::uint32_t y = 0; y < kSide; ++y) {
      const std::uint32_t first = static_cast<std::uint32_t>(scene.mesh.triangles.size());
      for (std::uint32_t x = 0; x < kSide; ++x) {
        const std::uint32_t v = y * (kSide + 1) + x;
        scene.mesh.triangles.push_back({v, v + 1, v + kSide + 1});
        scene.mesh.triangles.push_back({v + 1, v + kSide + 2, v + kSide + 1});
      }
      scene.parts.push_back({.name = "sheet/" + std::to_string(y),
                             .first_triangle = first,
                             .triangle_count = 2 * kSide,
                             .filter = {.layers = 1u << (y % 2)}});
    }
    auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
    world.add_scene(indexed);
  }

  Primitive convex_of_kind(int kind) {
    switch (kind) {
      case 0: return Capsule{point(0.4), point(0.4), uniform(0.05, 0.3)};
      case 1: return Cylinder{point(0.4), point(0.4), uniform(0.05, 0.3)};
      case 2: return Cone{point(0.4), point(0.4), uniform(0.05, 0.3)};
      case 3: return Ellipsoid{.center = point(0.2), .half_m = {0.1, uniform(0.1, 0.5), 0.3}};
      default: break;
    }
    const std::vector<Vec3> points{point(0.5), point(0.5), point(0.5), point(0.5), point(0.5), point(0.5)};
    return Hull{std::make_shared<const TriangleMesh>(*convex_hull(points))};
  }

  void add(int i) {
    ObjectDefinition definition;
    definition.name = "object" + std::to_string(i);
    definition.pose = pose();
    if (i % 5 == 3 || i % 5 == 4) {
      auto mesh = std::make_shared<TriangleMesh>();
      mesh->vertices = {point(0.5), point(0.5), point(0.5), point(0.5)};
      mesh->triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
      definition.shape.mesh = mesh;
    }
    if (i % 5 == 0 || i % 5 == 4) definition.shape.primitives.push_back(Sphere{point(0.2), uniform(0.1, 0.4)});
    if (i % 5 == 1 || i % 5 == 4) {
      definition.shape.primitives.push_back(Box{.center = point(0.2), .half_m = {0.1, uniform(0.1, 0.5), 0.3}});
    }
    if (i % 5 == 2) definition.shape.primitives.push_back(convex_of_kind(i / 5 % 5));
    definition.filter.group = i % 7 == 0 ? 1 : 0;
    definition.moving = i % 9 != 0;
    const auto defined = world.define(definition);
    if (definition.moving) movers_.push_back(std::get<ObjectId>(defined));
  }

  /// A cloud and a line, each with so many parts that they have an index, and a mesh between two of the line.
  void add_many_parts() {
    for (int i = 0; i < 4; ++i) {
      ObjectDefinition definition;
      definition.name = "many" + std::to_string(i);
      definition.pose = pose();
      definition.moving = i < 3;
      for (int k = 0; k < 40; ++k) {
        if (i % 2 == 0) definition.shape.primitives.push_back(Sphere{point(1), uniform(0.02, 0.1)});
        else definition.shape.primitives.push_back(Capsule{point(1), point(1), uniform(0, 0.05)});
      }
      const auto defined = world.define(definition);
      if (definition.moving) movers_.push_back(std::get<ObjectId>(defined));
    }
  }

  std::mt19937_64& random_;
  std::vector<ObjectId> movers_;

 public:
  World world;
};

}  // namespace collided::oracle
