#include "server/world/plan.hpp"

#include <variant>

namespace collided {
namespace {

struct Counts {
  std::uint64_t static_triangles = 0;
  std::uint32_t moving = 0;
  std::uint32_t placed = 0;  // objects with shapes of their own that stay where they are
  std::uint32_t moving_meshes = 0;
  std::uint32_t lone_spheres = 0;
};

Counts count(const Snapshot& snapshot) {
  Counts counts;
  for (const auto& scene : snapshot.scenes) counts.static_triangles += scene->mesh.triangles.size();
  for (const auto& info : *snapshot.objects) {
    if (!info || info->scene_part != 0xffffffff) continue;
    ++(info->moving ? counts.moving : counts.placed);
    if (info->moving && info->mesh) ++counts.moving_meshes;
    const bool lone_sphere = !info->mesh && info->primitives.size() == 1 &&
                             std::holds_alternative<Sphere>(info->primitives.front());
    if (info->moving && lone_sphere) ++counts.lone_spheres;
  }
  return counts;
}

std::string number(std::uint64_t n, const char* what) { return std::to_string(n) + ' ' + what; }

}  // namespace

std::vector<PlanRow> plan_of(const Snapshot& snapshot, bool events_wanted) {
  const Counts c = count(snapshot);
  std::uint64_t bytes = 0;
  for (const auto& scene : snapshot.scenes) bytes += scene->bytes();
  const bool has_static = c.static_triangles > 0;
  const bool has_objects = c.moving + c.placed > 0;
  std::vector<PlanRow> rows;
  rows.push_back({"bsp_tree (static)", has_static,
                  has_static ? number(c.static_triangles, "static triangles, ") + number(bytes, "bytes all in")
                             : "no static triangle is loaded",
                  has_static ? "" : "its memory and a walk a question"});
  rows.push_back({"grid (objects)", has_objects,
                  has_objects ? number(c.moving, "moving and ") + number(c.placed, "placed objects")
                              : "no object moves or is placed",
                  has_objects ? "" : "a rebuild a step and a walk a question"});
  rows.push_back({"pair search", c.moving > 0, c.moving > 0 ? number(c.moving, "movers") : "nothing moves",
                  c.moving > 0 ? "" : "the whole collision step"});
  rows.push_back({"swept test", c.lone_spheres > 0,
                  c.lone_spheres > 0 ? number(c.lone_spheres, "moving spheres") : "no moving sphere",
                  c.lone_spheres > 0 ? "" : "a second exact test a candidate"});
  rows.push_back({"mesh x mesh", c.moving_meshes > 0,
                  c.moving_meshes > 0 ? number(c.moving_meshes, "moving meshes") : "no moving mesh",
                  c.moving_meshes > 0 ? "" : "an index a mesh"});
  rows.push_back({"contact points", events_wanted && c.moving > 0,
                  events_wanted ? "somebody subscribes to events" : "nobody subscribes to events",
                  events_wanted ? "" : "point, normal and depth of every touching pair"});
  rows.push_back({"FCL", false, "every pair offered is decided by our own exact tests", "its start and its memory"});
  return rows;
}

std::vector<PairRow> pair_table() {
  const std::string exact = "own, exact";
  const std::string parts = "own, exact, part by part";
  std::vector<PairRow> rows;
  for (const char* b : {"sphere", "box", "capsule"}) {
    rows.push_back({"ray", b, exact});
    rows.push_back({"sphere", b, exact});
    rows.push_back({"box", b, exact});
    rows.push_back({"capsule", b, exact});
  }
  for (const char* a : {"ray", "sphere", "box", "capsule", "mesh"}) rows.push_back({a, "mesh", parts});
  for (const char* a : {"ray", "sphere", "box", "capsule", "mesh"}) rows.push_back({a, "compound", parts});
  return rows;
}

}  // namespace collided
