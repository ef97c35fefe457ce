#include "server/world/query/plan.hpp"

#include <array>
#include <cstdio>
#include <unordered_set>
#include <variant>

#include "server/world/objects/part_index.hpp"
#include "server/world/objects/scene_levels.hpp"
#include "server/world/solids/solid.hpp"
#include "server/world/solids/winding.hpp"

namespace collided::engine {
namespace {

// Content of the scene, as far as the plan's sentences need it.
struct SceneCounts {
  std::uint64_t static_triangles = 0;
  std::uint32_t moving = 0;
  std::uint32_t placed = 0;  // static objects with shapes of their own
  std::uint32_t moving_meshes = 0;
  std::uint32_t lone_spheres = 0;
  std::uint32_t indexed_parts = 0;  // objects whose primitives have an index
  std::uint64_t parts = 0;          // primitives of those objects
  std::uint32_t with_mesh = 0;
  std::uint32_t meshes = 0;      // distinct ones among their meshes
  std::uint32_t solids = 0;      // objects with a mesh that was declared solid
  std::uint32_t by_winding = 0;  // objects with a mesh that is solid by winding number
  std::uint64_t winding_bytes = 0;
  std::uint32_t solid_trees = 0;
  std::uint64_t solid_triangles = 0;
  std::uint64_t tree_bytes = 0;
};

void count_solid(const SolidMesh& solid, SceneCounts& counts) {
  ++counts.solids;
  counts.solid_triangles += solid.surface->mesh->triangles.size();
  if (!solid.tree) return;
  ++counts.solid_trees;
  counts.tree_bytes += solid.tree->report().bytes;
}

SceneCounts count(const Snapshot& snapshot) {
  SceneCounts counts;
  std::unordered_set<const IndexedMesh*> meshes;
  for (const auto& scene : snapshot.scenes) counts.static_triangles += scene->mesh.triangles.size();
  for (const auto& info : snapshot.objects) {
    if (info && info->rare->solid) count_solid(*info->rare->solid, counts);
    if (info && info->rare->winding) {
      ++counts.by_winding;
      counts.winding_bytes += info->rare->winding->tree.bytes();
    }
    if (!info || info->scene_part != kNoScenePart) continue;
    ++(info->moving ? counts.moving : counts.placed);
    if (info->moving && info->mesh) ++counts.moving_meshes;
    if (info->mesh) ++counts.with_mesh;
    if (info->mesh) meshes.insert(info->mesh.get());
    if (info->rare->parts) ++counts.indexed_parts;
    if (info->rare->parts) counts.parts += info->primitives.size();
    const bool lone_sphere =
        !info->mesh && info->primitives.size() == 1 && std::holds_alternative<Sphere>(info->primitives.front());
    if (info->moving && lone_sphere) ++counts.lone_spheres;
  }
  counts.meshes = static_cast<std::uint32_t>(meshes.size());
  return counts;
}

std::string number(std::uint64_t n, const char* what) { return std::to_string(n) + ' ' + what; }

std::string with_digits(double value, int digits) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

// The error of each level of detail.
std::string level_words(const Snapshot& snapshot) {
  std::string words;
  for (const auto& scene : snapshot.scenes) {
    if (scene->levels.empty()) continue;
    words += (words.empty() ? "" : "; ") + scene->name + ": ";
    for (const auto& level : scene->levels) {
      words += (level == scene->levels.front() ? "" : ", ") +
               number(level->mesh.triangles.size(), "triangles within ") + with_digits(1e3 * level->off_by_m, 3) +
               " mm";
    }
  }
  return words;
}

/// How one scene's index was built and what it costs.
std::string index_words(const StaticScene& scene) {
  const BvhReport& report = scene.tree.report();
  const auto triangles = static_cast<double>(scene.mesh.triangles.size());
  std::string words = scene.name + ": nodes of " + std::to_string(BvhReport::kChildren) + ", leaves of " +
                      std::to_string(BvhReport::kLeafTriangles) + ", depth " + std::to_string(report.depth) + ", " +
                      with_digits(static_cast<double>(report.references) / triangles, 2) + " references and " +
                      with_digits(static_cast<double>(scene.bytes()) / triangles, 1) + " bytes a triangle, ";
  words += report.split_triangles > 0 ? std::to_string(report.split_triangles) + " triangles split, " : "no splits, ";
  return words + (report.is_loaded ? "loaded and checked in " : "built in ") + with_digits(1e3 * report.build_s, 0) +
         " ms";
}

/// The size of all static geometry, then each scene's index.
std::string tree_words(const Snapshot& snapshot, const SceneCounts& counts) {
  std::uint64_t bytes = 0;
  for (const auto& scene : snapshot.scenes) bytes += scene->bytes();
  std::string words = number(counts.static_triangles, "static triangles, ") + number(bytes, "bytes all in");
  for (const auto& scene : snapshot.scenes) {
    if (!scene->mesh.triangles.empty()) words += "; " + index_words(*scene);
    if (scene->tiles)
      words += "; " + scene->name + ": " + std::to_string(scene->tiles->tiles) + " of " +
               std::to_string(scene->tiles->tiles_of_file) + " tiles, " + std::to_string(scene->mesh.triangles.size()) +
               " of " + std::to_string(scene->tiles->triangles_of_file) + " triangles";
  }
  return words;
}

}  // namespace

std::vector<PlanRow> plan_of(const Snapshot& snapshot, bool events_wanted) {
  const SceneCounts c = count(snapshot);
  const bool has_static = c.static_triangles > 0;
  const bool has_objects = c.moving + c.placed > 0;
  std::vector<PlanRow> rows;
  rows.push_back({"bvh (static)", has_static, has_static ? tree_words(snapshot, c) : "no static triangle is loaded",
                  has_static ? "" : "its memory and a walk a question"});
  const std::string levels = level_words(snapshot);
  rows.push_back({"levels of detail", !levels.empty(),
                  levels.empty() ? "no scene was simplified ahead (collide convert --levels)"
                                 : levels + "; for distances asked --within four times as much",
                  levels.empty() ? "a third more memory" : ""});
  const bool is_swept = has_objects && snapshot.grid && snapshot.grid->is_swept();
  const std::string objects = number(c.moving, "moving and ") + number(c.placed, "placed objects");
  rows.push_back({"grid (objects)", has_objects && !is_swept,
                  !has_objects ? "no object moves or is placed"
                  : is_swept   ? objects + " are few: swept"
                               : objects,
                  has_objects && !is_swept ? "" : "a rebuild a step and a walk a question"});
  rows.push_back({"sweep-and-prune (objects)", is_swept,
                  is_swept      ? objects
                  : has_objects ? "more objects than a sweep is good for"
                                : "no object moves or is placed",
                  is_swept ? "" : "an order along one axis"});
  rows.push_back({"pair search", c.moving > 0, c.moving > 0 ? number(c.moving, "movers") : "nothing moves",
                  c.moving > 0 ? "" : "the whole collision step"});
  rows.push_back(
      {"swept test", c.moving > 0,
       c.moving > 0 ? number(c.lone_spheres, "moving spheres and ") + number(c.moving - c.lone_spheres, "other movers")
                    : "nothing moves",
       c.moving > 0 ? "" : "the first contact in time of a candidate"});
  rows.push_back({"mesh x mesh", c.moving_meshes > 0,
                  c.moving_meshes > 0 ? number(c.moving_meshes, "moving meshes") : "no moving mesh",
                  c.moving_meshes > 0 ? "" : "an index a mesh"});
  rows.push_back({"index of parts", c.indexed_parts > 0,
                  c.indexed_parts > 0
                      ? number(c.parts, "spheres, capsules and boxes in ") + number(c.indexed_parts, "objects")
                      : "no cloud, line or other object of many parts",
                  c.indexed_parts > 0 ? "" : "a tree an object"});
  rows.push_back({"shared meshes", c.with_mesh > c.meshes,
                  number(c.with_mesh, "objects with ") + number(c.meshes, "different meshes"),
                  c.with_mesh > c.meshes ? "" : "nothing: each mesh has its own memory and index"});
  rows.push_back({"solids (inside)", c.solids > 0,
                  c.solids > 0
                      ? number(c.solids, "meshes declared solid, ") + number(c.solid_triangles, "triangles; ") +
                            number(c.solid_trees, "have a BSP tree, ") + number(c.tree_bytes, "bytes") +
                            "; rays decide in the others, where that is faster"
                      : "no mesh is declared solid (--solid)",
                  c.solids > 0 ? "" : "a check a mesh, and a BSP tree"});
  if (c.by_winding > 0) {
    rows.push_back(
        {"solids by winding number", true,
         number(c.by_winding, "meshes that do not close, ") + number(c.winding_bytes, "bytes") +
             "; decides inside and near --signed alone: overlaps, pairs, rays and events take them as surfaces",
         ""});
  }
  const bool finds_contacts = events_wanted && c.moving > 0;
  rows.push_back({"contact points", finds_contacts,
                  finds_contacts  ? "somebody subscribes to events"
                  : events_wanted ? "nothing moves"
                                  : "nobody subscribes to events",
                  finds_contacts ? "" : "point, normal and depth of every touching pair"});
  if (snapshot.contacts_truncated) {
    rows.push_back(
        {"contacts over the limit", false, "more than max_contacts touch: truncated, events tell only some", ""});
  }
  rows.push_back({"FCL", false,
                  "every pair is decided by our own exact tests; collided-opinion, a process of its own, is started "
                  "where FCL's opinion is asked for (pair, menu, collided --audit with --opinion fcl)",
                  "its start and its memory"});
  return rows;
}

PlanRow plan_of_probes(std::size_t count, bool are_read) {
  if (count == 0) return {"probes", false, "no ray is fixed to an object", "a ray a probe and step"};
  if (!are_read) return {"probes", false, number(count, "probes; nobody reads them"), "a ray a probe and step"};
  return {"probes", true, number(count, "probes that somebody reads"), ""};
}

PlanRow plan_of_cut_searches(std::uint64_t count) {
  return {"searches of fences", true,
          number(count, "ended at their limit of looks so far: who came and went then may not have been told"), ""};
}

std::vector<PairRow> pair_table() {
  const std::string closed = "closed form, exact";
  const std::string searched =
      "search, then a certificate: exact, but undecided where round parts are within about 1e-8 of their size of "
      "touching";
  const std::string facets = "search, then a certificate or rationals: exact";
  const std::string parts = "part by part, as the parts are";
  const std::string plane = "reach along its normal: " + closed + "; of objects that do not move, alone in their shape";
  const std::array<const char*, 7> convex{"sphere", "box", "capsule", "cylinder", "cone", "ellipsoid", "hull"};
  constexpr std::size_t kClosedForms = 3;  // the first of these kinds, among themselves and against triangles
  constexpr std::size_t kHull = 6;
  std::vector<PairRow> rows;
  for (const char* b : convex) rows.push_back({"ray", b, closed});
  rows.push_back({"ray", "mesh", "triangle by triangle: " + closed});
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const auto how = [&](std::size_t j) {
      if (i < kClosedForms && j < kClosedForms) return closed;
      const bool flat = (i < kClosedForms || i == kHull) && (j < kClosedForms || j == kHull);
      return flat ? facets : searched;
    };
    for (std::size_t j = i; j < convex.size(); ++j) rows.push_back({convex[i], convex[j], how(j)});
    // Triangles are flat, like boxes.
    rows.push_back({convex[i], "mesh", "triangle by triangle: " + how(0)});
  }
  rows.push_back({"mesh", "mesh", "triangle by triangle: " + closed});
  rows.push_back({"ray", "half-space", plane});
  for (const char* a : convex) rows.push_back({a, "half-space", plane});
  rows.push_back({"mesh", "half-space", "triangle by triangle: " + plane});
  rows.push_back({"half-space", "half-space", "not asked: neither moves"});
  rows.push_back({"height field", "any",
                  "as a mesh, which it becomes when it is loaded: a surface; solid below is not offered, a half-space "
                  "or boxes are"});
  rows.push_back({"point cloud", "any", "ball by ball through an index of its own: as spheres"});
  rows.push_back({"polyline", "any", "piece by piece through an index of its own: as capsules"});
  rows.push_back({"scaled", "any",
                  "as its kind: one factor for every kind, three for meshes, height fields, hulls and for boxes and "
                  "ellipsoids along the axes; others are refused, mirror images too"});
  rows.push_back({"compound", "any", parts});
  return rows;
}

}  // namespace collided::engine
