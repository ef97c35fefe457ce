#include "server/intake/readers/polygons.hpp"

#include <fmt/format.h>

#include "server/intake/limits.hpp"
#include "server/intake/readers/vertex_buffer.hpp"

namespace collided::engine {

void Polygons::complain(const char* place, const std::string& what) const {
  if (places_ == Places::lines) { refuse_line(reading_, place, what); }
  refuse_byte(reading_, static_cast<std::size_t>(place - reading_.begin()), what);
}

void Polygons::no_vertex(std::int64_t number, const char* place) const {
  complain(place, fmt::format("vertex number {}, allowed 0 to {}", number,
                              static_cast<std::int64_t>(mesh_.vertices.size()) - 1));
}

void Polygons::add(std::span<const std::uint32_t> corners, const char* place) {
  if (corners.size() < 3) {
    ++short_count_;
    if (reading_.options.strict) {
      complain(place, fmt::format("face of {} corners, at least 3 are needed", corners.size()));
    }
    return;
  }
  const std::uint64_t triangle_count = mesh_.triangles.size() + corners.size() - 2;
  if (triangle_count > reading_.options.max_triangles) { check_triangle_count(reading_, triangle_count); }
  if (corners.size() > 3) counts_.measure(corners, mesh_.vertices);
  const std::size_t first_new = mesh_.triangles.size();
  switch (triangulate(corners, mesh_.vertices, mesh_.triangles)) {
    case PolygonKind::convex:
    case PolygonKind::concave: return;
    case PolygonKind::crossing:
      if (reading_.options.strict) { complain(place, "polygon crosses or touches itself"); }
      counts_.split(corners, mesh_.vertices, std::span(mesh_.triangles).subspan(first_new));
      check_vertex_count(reading_, mesh_.vertices.size());
      return;
    case PolygonKind::too_long:
      complain(place, fmt::format("polygon of {} corners that crosses or touches itself, limit {}", corners.size(),
                                  kMaxConcaveCorners));
  }
}

void Polygons::add_strip(std::span<const std::uint32_t> corners, const char* place) {
  for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
    if (const TriangleCorners triangle = strip_triangle(corners, i); !is_collapsed(triangle)) add(triangle, place);
  }
}

void Polygons::report() const {
  if (short_count_ > 0) {
    reading_.report.refused.push_back(fmt::format("{} faces of fewer than 3 corners left out", short_count_));
  }
  counts_.report(reading_.report);
}

Scene Polygons::take_scene() {
  Scene scene;
  scene.mesh = std::move(mesh_);
  scene.parts.push_back({.name = {}, .triangle_count = static_cast<std::uint32_t>(scene.mesh.triangles.size())});
  return scene;
}

}  // namespace collided::engine
