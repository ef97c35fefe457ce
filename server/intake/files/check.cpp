#include "server/intake/files/check.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "server/intake/files/volumes.hpp"
#include "server/intake/mesh_health.hpp"

namespace collided::files {
namespace {

std::string point_text(const Vec3& point) {
  return fmt::format("{} {} {}", shortest(point.x()), shortest(point.y()), shortest(point.z()));
}

nlohmann::json point_json(const Vec3& point) {
  return {point.x(), point.y(), point.z()};
}

void print_json(const Scene& scene, const MeshHealth& health, const LoadReport& report) {
  nlohmann::json object{{"scene", scene.name},
                        {"parts", scene.parts.size()},
                        {"objects", scene.objects.size()},
                        {"triangles", health.triangle_count},
                        {"vertices", health.vertex_count},
                        {"equal_vertices", health.equal_vertex_count},
                        {"zero_area", health.zero_area_count},
                        {"duplicates", health.duplicate_count},
                        {"edges", health.edge_count},
                        {"boundary_edges", health.boundary_edge_count},
                        {"nonmanifold_edges", health.nonmanifold_edge_count},
                        {"inconsistent_edges", health.inconsistent_edge_count},
                        {"components", health.component_count},
                        {"closed", health.is_closed},
                        {"oriented", health.is_consistently_oriented},
                        {"notes", report.notes},
                        {"mended", report.mended},
                        {"refused", report.refused},
                        {"warnings", report.warnings},
                        {"seconds", report.seconds}};
  if (!health.bounds.empty()) object["bounds"] = {point_json(health.bounds.low), point_json(health.bounds.high)};
  std::puts(object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

std::string surface_text(const MeshHealth& health) {
  if (health.is_closed && health.is_consistently_oriented) return "closed, of one orientation: 'inside' has a meaning";
  if (health.is_closed) return fmt::format("closed, but {} edges are run along twice the same way", grouped(health.inconsistent_edge_count));
  return fmt::format("open: {} boundary edges, {} edges of three and more triangles, {} run along twice the same way",
                     grouped(health.boundary_edge_count), grouped(health.nonmanifold_edge_count), grouped(health.inconsistent_edge_count));
}

void print_lines(const char* label, const std::vector<std::string>& lines) {
  for (const std::string& line : lines) fmt::print("  {:<9}{}\n", label, line);
}

void print_text(const Scene& scene, const MeshHealth& health, const LoadReport& report) {
  fmt::print("{}  {} parts, {} triangles, {} objects\n", scene.name, grouped(scene.parts.size()), grouped(health.triangle_count),
             grouped(scene.objects.size()));
  if (!health.bounds.empty()) fmt::print("  bounds   {}  to  {}\n", point_text(health.bounds.low), point_text(health.bounds.high));
  if (health.triangle_count > 0) {
    fmt::print("  surface  {}\n", surface_text(health));
    fmt::print("  pieces   {}\n", grouped(health.component_count));
    fmt::print("  points   {} vertices, {} of them equal to an earlier one\n", grouped(health.vertex_count), grouped(health.equal_vertex_count));
  }
  if (health.zero_area_count + health.duplicate_count > 0) {
    fmt::print("  idle     {} triangles without area, {} that repeat an earlier one\n", grouped(health.zero_area_count), grouped(health.duplicate_count));
  }
  print_lines("note", report.notes);
  print_lines("mended", report.mended);
  print_lines("refused", report.refused);
  print_lines("warning", report.warnings);
}

}  // namespace

int check(const FileOptions& file, bool as_json, const CheckTables& tables) {
  LoadReport report;
  const Scene scene = load(file, report);
  const MeshHealth health = examine(scene.mesh);
  if (as_json) print_json(scene, health, report);
  else print_text(scene, health, report);
  if (tables.volumes) print_volumes(scene);
  if (tables.encodings) print_encodings(scene);
  return report.refused.empty() ? 0 : 1;
}

}  // namespace collided::files
