#include "server/programs/files/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <unordered_set>

#include "server/programs/files/mesh_findings.hpp"
#include "server/programs/files/progress_line.hpp"
#include "server/programs/files/volumes.hpp"

namespace collided::engine::files {
namespace {

using nlohmann::json;

constexpr std::size_t kWorstInTable = 3;
constexpr std::size_t kWorstInJson = 20;

std::string point_text(const Vec3& point) {
  return fmt::format("{} {} {}", shortest(point.x()), shortest(point.y()), shortest(point.z()));
}

json point_json(const Vec3& point) { return {point.x(), point.y(), point.z()}; }

/// Counts the triangles of the static mesh and, once each, those of the objects' meshes.
std::size_t triangles_of(const Scene& scene) {
  std::unordered_set<const TriangleMesh*> seen;
  std::size_t count = scene.mesh.triangles.size();
  for (const SceneObject& object : scene.objects) {
    const TriangleMesh* mesh = object.shape.mesh.get();
    if (mesh != nullptr && seen.insert(mesh).second) count += mesh->triangles.size();
  }
  return count;
}

/// Checks the static mesh and, once each, the objects' meshes.
///
/// progress  called with the fraction done in [0, 1], by triangles
std::vector<CheckedMesh> check_meshes(const Scene& scene, const Scrutiny& scrutiny,
                                      const std::function<void(double)>& progress) {
  std::vector<CheckedMesh> meshes;
  const auto all = static_cast<double>(std::max<std::size_t>(triangles_of(scene), 1));
  double done = 0;
  const auto add = [&](const std::string& name, const TriangleMesh& mesh, const std::vector<Part>* parts) {
    const auto share = static_cast<double>(mesh.triangles.size());
    meshes.push_back(
        check_mesh(name, mesh, parts, scrutiny, [&](double fraction) { progress((done + share * fraction) / all); }));
    done += share;
  };
  if (!scene.mesh.triangles.empty()) add(scene.name, scene.mesh, &scene.parts);
  std::unordered_set<const TriangleMesh*> seen;
  for (const SceneObject& object : scene.objects) {
    const TriangleMesh* mesh = object.shape.mesh.get();
    if (mesh == nullptr || !seen.insert(mesh).second) continue;
    add(object.name, *mesh, nullptr);
    meshes.back().cut = object.cut;
  }
  return meshes;
}

/// Every kind of finding with its count, even 0, so that a program that reads it need not ask whether it is there.
json mesh_json(const CheckedMesh& checked) {
  const MeshHealth& health = checked.health;
  json object{{"triangles", health.triangle_count},
              {"vertices", health.vertex_count},
              {"equal_vertices", health.equal_vertex_count},
              {"zero_area", health.zero_area_count},
              {"duplicates", health.duplicate_count},
              {"flipped", health.flipped.size()},
              {"edges", health.edge_count},
              {"boundary_edges", health.boundary_edge_count},
              {"nonmanifold_edges", health.nonmanifold_edge_count},
              {"inconsistent_edges", health.inconsistent_edge_count},
              {"crease_edges", checked.crease_edge_count},
              {"material_edges", checked.material_edge_count},
              {"pinched_points", health.pinched_points.size()},
              {"t_vertices", health.t_vertex_count()},
              {"cracks", health.crack_count()},
              {"crack_m", health.seam_reach.crack_m},
              {"on_edge_m", health.seam_reach.on_edge_m},
              {"self_intersections", checked.crossings.pairs.size()},
              {"self_intersections_complete", checked.crossings.is_complete},
              {"border_points_unseen", health.seam_unseen_count},
              {"components", health.component_count},
              {"unorientable", health.unorientable_count},
              {"closed", health.is_closed},
              {"oriented", health.is_consistently_oriented},
              {"manifold", health.is_manifold()}};
  if (!health.bounds.empty()) object["bounds"] = {point_json(health.bounds.low), point_json(health.bounds.high)};
  if (checked.silhouette_edge_count) object["silhouette_edges"] = *checked.silhouette_edge_count;
  if (const std::string doubt = unit_suspicion(health.bounds); !doubt.empty()) object["unit_doubt"] = doubt;
  json worst = json::object();
  for (const Finding& finding : findings_of(checked, kWorstInJson)) {
    json places = json::array();
    for (const Place& place : finding.worst) {
      places.push_back({{"object", place.object}, {"triangle", place.triangle}, {"detail", place.detail}});
    }
    worst[finding.key] = {{"places", places}, {"service", finding.consequence}};
  }
  object["findings"] = worst;
  return object;
}

/// One JSON object: the members of the static mesh in it, those of the objects' meshes in a list.
void print_json(const Scene& scene, const std::vector<CheckedMesh>& meshes, const LoadReport& report) {
  json object{{"scene", scene.name},      {"parts", scene.parts.size()}, {"objects", scene.objects.size()},
              {"triangles", 0},           {"placed", report.placed},     {"notes", report.notes},
              {"mended", report.mended},  {"refused", report.refused},   {"warnings", report.warnings},
              {"seconds", report.seconds}};
  json of_objects = json::array();
  for (const CheckedMesh& checked : meshes) {
    json one = mesh_json(checked);
    if (checked.parts != nullptr) {
      object.update(one);
    } else {
      one["object"] = checked.name;
      of_objects.push_back(std::move(one));
    }
  }
  if (!of_objects.empty()) object["object_meshes"] = std::move(of_objects);
  std::puts(object.dump(-1, ' ', false, json::error_handler_t::replace).c_str());
}

std::string surface_text(const MeshHealth& health) {
  if (health.is_closed && health.is_consistently_oriented) {
    return fmt::format("closed, of one orientation{}: 'inside' has a meaning",
                       health.is_manifold() ? ", manifold" : "");
  }
  if (health.is_closed) return "closed, but not of one orientation";
  return health.is_manifold() ? "open, manifold" : "open, not manifold";
}

void print_lines(const char* label, const std::vector<std::string>& lines) {
  for (const std::string& line : lines) fmt::print("  {:<9}{}\n", label, line);
}

std::string places_text(const Finding& finding, bool names_objects) {
  std::string text;
  for (const Place& place : finding.worst) {
    text += fmt::format("{}{}triangle {}{}{}", text.empty() ? "" : "; ", names_objects ? place.object + " " : "",
                        place.triangle, place.detail.empty() ? "" : " ", place.detail);
  }
  return text;
}

void print_mesh(const CheckedMesh& checked) {
  const MeshHealth& health = checked.health;
  fmt::print("  bounds   {}  to  {}\n", point_text(health.bounds.low), point_text(health.bounds.high));
  fmt::print("  surface  {}\n", surface_text(health));
  fmt::print("  pieces   {}\n", grouped(health.component_count));
  fmt::print("  points   {} vertices, {} of them equal to an earlier one\n", grouped(health.vertex_count),
             grouped(health.equal_vertex_count));
  fmt::print("  edges    {}, {} of them creases, {} between parts", grouped(health.edge_count),
             grouped(checked.crease_edge_count), grouped(checked.material_edge_count));
  if (checked.silhouette_edge_count) fmt::print(", {} silhouettes from there", grouped(*checked.silhouette_edge_count));
  fmt::print("\n");
  if (const std::string doubt = unit_suspicion(health.bounds); !doubt.empty()) fmt::print("  unit?    {}\n", doubt);
  if (!checked.crossings.is_complete)
    fmt::print("  unseen   the search for triangles that meet each other ended early: there are more\n");
  if (health.seam_unseen_count > 0) {
    fmt::print(
        "  unseen   {} points of the border were not looked at for cracks: too many borders lie near each other\n",
        grouped(health.seam_unseen_count));
  }
  const std::vector<Finding> findings = findings_of(checked, kWorstInTable);
  if (findings.empty()) {
    fmt::print("  nothing is wrong with it\n");
    return;
  }
  const bool names_objects = checked.parts != nullptr && checked.parts->size() > 1;
  for (const Finding& finding : findings) {
    fmt::print("  {:>11}  {:<20} {}\n", grouped(finding.count), finding.what, finding.consequence);
    if (!finding.worst.empty())
      fmt::print("               {}{}\n", finding.count > finding.worst.size() ? "the worst: " : "",
                 places_text(finding, names_objects));
  }
}

void print_text(const Scene& scene, const std::vector<CheckedMesh>& meshes, const LoadReport& report) {
  fmt::print("{}  {} parts, {} triangles, {} objects\n", scene.name, grouped(scene.parts.size()),
             grouped(scene.mesh.triangles.size()), grouped(scene.objects.size()));
  print_lines("placed", report.placed);
  for (const CheckedMesh& checked : meshes) {
    if (checked.parts == nullptr)
      fmt::print("{}  {} triangles\n", checked.name, grouped(checked.health.triangle_count));
    print_mesh(checked);
  }
  print_lines("note", report.notes);
  print_lines("mended", report.mended);
  print_lines("refused", report.refused);
  print_lines("warning", report.warnings);
}

}  // namespace

int check(const FileOptions& file, const CheckOptions& options) {
  // Share of the time, measured with a million triangles.
  constexpr double kLoaded = 0.15;
  LoadReport report;
  std::optional<ProgressLine> line(std::in_place, "checking");
  const Scene scene = load(file, report, [&](double fraction) { line->tell(kLoaded * fraction); });
  Scrutiny scrutiny{.crack_m = crack_in_metres(file), .crease_deg = options.crease_deg};
  if (!options.eye.empty()) scrutiny.eye = parse_point("--eye", options.eye);
  const std::vector<CheckedMesh> meshes =
      check_meshes(scene, scrutiny, [&](double fraction) { line->tell(kLoaded + (1 - kLoaded) * fraction); });
  line.reset();
  if (options.as_json) print_json(scene, meshes, report);
  else print_text(scene, meshes, report);
  if (options.volumes) print_volumes(scene);
  if (options.encodings) print_encodings(scene);
  return report.refused.empty() ? 0 : 1;
}

}  // namespace collided::engine::files
