#include <fmt/format.h>

#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/intake/scene.hpp"

namespace collided::engine {
namespace {

void add_part(Scene& scene, const std::string& name, const TriangleMesh& mesh) {
  const auto first_vertex = static_cast<std::uint32_t>(scene.mesh.vertices.size());
  const auto first_triangle = static_cast<std::uint32_t>(scene.mesh.triangles.size());
  scene.mesh.vertices.insert(scene.mesh.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  for (const TriangleCorners& corners : mesh.triangles) {
    scene.mesh.triangles.push_back({corners[0] + first_vertex, corners[1] + first_vertex, corners[2] + first_vertex});
  }
  scene.parts.push_back(
      {scene.name + "/" + name, first_triangle, static_cast<std::uint32_t>(mesh.triangles.size()), {}});
}

/// Three boards between two side panels, 2.4 m long and 1.2 m high, centred at (x, y).
void add_shelf(Scene& scene, const std::string& name, double x, double y) {
  constexpr double kHalfLength_m = 1.2;
  constexpr double kHalfDepth_m = 0.4;
  constexpr double kBoard_m = 0.04;
  constexpr double kTop_m = 1.2;
  const auto add = [&](const std::string& part, const Vec3& low, const Vec3& high) {
    add_part(scene, name + "/" + part, box_mesh(Vec3(x, y, 0) + low, Vec3(x, y, 0) + high));
  };
  const auto add_board = [&](const std::string& part, double top_m) {
    add(part, {-kHalfLength_m, -kHalfDepth_m, top_m - kBoard_m}, {kHalfLength_m, kHalfDepth_m, top_m});
  };
  add_board("bottom", 0.2);
  add_board("middle", 0.7);
  add_board("top", kTop_m);
  const double panel_top_m = kTop_m - kBoard_m;
  add("left", {-kHalfLength_m, -kHalfDepth_m, 0}, {-kHalfLength_m + kBoard_m, kHalfDepth_m, panel_top_m});
  add("right", {kHalfLength_m - kBoard_m, -kHalfDepth_m, 0}, {kHalfLength_m, kHalfDepth_m, panel_top_m});
}

/// A deck of 1.2 x 0.8 m, with or without a load on it.
SceneObject pallet(const std::string& name, double x, double y, double load_height_m) {
  constexpr double kHalfDeck_m = 0.072;
  SceneObject object{.name = name, .pose = {.position = {x, y, 0}}};
  object.shape.primitives.push_back(Box{.center = {0, 0, kHalfDeck_m}, .half_m = {0.6, 0.4, kHalfDeck_m}});
  if (load_height_m > 0) {
    object.shape.primitives.push_back(
        Box{.center = {0, 0, 2 * kHalfDeck_m + load_height_m / 2}, .half_m = {0.55, 0.35, load_height_m / 2}});
  }
  return object;
}

}  // namespace

Scene embedded_scene() {
  constexpr double kHalfX_m = 8;
  constexpr double kHalfY_m = 6;
  constexpr double kWall_m = 0.2;
  constexpr double kHeight_m = 4;
  const double outer_x_m = kHalfX_m + kWall_m;
  const double outer_y_m = kHalfY_m + kWall_m;
  Scene scene{.name = "warehouse"};
  add_part(scene, "floor", box_mesh({-outer_x_m, -outer_y_m, -kWall_m}, {outer_x_m, outer_y_m, 0}));
  add_part(scene, "wall_north", box_mesh({-outer_x_m, kHalfY_m, 0}, {outer_x_m, outer_y_m, kHeight_m}));
  add_part(scene, "wall_south", box_mesh({-outer_x_m, -outer_y_m, 0}, {outer_x_m, -kHalfY_m, kHeight_m}));
  add_part(scene, "wall_east", box_mesh({kHalfX_m, -kHalfY_m, 0}, {outer_x_m, kHalfY_m, kHeight_m}));
  add_part(scene, "wall_west", box_mesh({-outer_x_m, -kHalfY_m, 0}, {-kHalfX_m, kHalfY_m, kHeight_m}));
  add_shelf(scene, "shelf_1", -4, -3);
  add_shelf(scene, "shelf_2", 4, -3);
  add_shelf(scene, "shelf_3", 0, 0);
  add_shelf(scene, "shelf_4", 0, 4);
  const double loads_m[] = {0, 0.6, 0.9, 0, 1.2, 0.3};
  for (unsigned i = 0; i < 6; ++i) {
    const unsigned row = i / 2;
    scene.objects.push_back(pallet(fmt::format("pallet_{:02}", i + 1), i % 2 == 0 ? -5 : 5, row * 1.5, loads_m[i]));
  }
  return scene;
}

}  // namespace collided::engine
