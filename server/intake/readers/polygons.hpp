#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/intake/polygons/polygon_counts.hpp"
#include "server/intake/polygons/triangulate.hpp"
#include "server/intake/readers/reading.hpp"

namespace collided::engine {

/// Collects faces of any number of corners as the triangles of one unnamed part, for OFF and PLY. Counts what it omits
/// or guesses, for the report. `place` is a pointer to the face in the file, for errors.
///
/// threads  one at a time
class Polygons {
 public:
  /// How errors name places: by line in a text file, by byte in a binary one.
  enum class Places { lines, bytes };

  explicit Polygons(const Reading& reading, Places places = Places::lines) : reading_(reading), places_(places) {}

  std::vector<Vec3>& vertices() { return mesh_.vertices; }

  /// The number as an index of a vertex. Throws a LoadError if there is no such vertex.
  std::uint32_t vertex_number(std::int64_t number, const char* place) const {
    if (static_cast<std::uint64_t>(number) >= mesh_.vertices.size()) no_vertex(number, place);
    return static_cast<std::uint32_t>(number);
  }
  /// Adds a face, cut into triangles.
  void add(std::span<const std::uint32_t> corners, const char* place);
  /// Adds a face of three corners.
  void add_triangle(const TriangleCorners& corners) {
    if (mesh_.triangles.size() >= reading_.options.max_triangles)
      check_triangle_count(reading_, mesh_.triangles.size() + 1);
    mesh_.triangles.push_back(corners);
  }
  /// Adds a triangle strip: each corner from the third on makes a triangle with the two before it, every other one
  /// turned over.
  void add_strip(std::span<const std::uint32_t> corners, const char* place);

  /// Reports what was omitted or guessed.
  void report() const;
  Scene take_scene();

 private:
  [[noreturn]] void complain(const char* place, const std::string& what) const;
  [[noreturn]] void no_vertex(std::int64_t number, const char* place) const;

  const Reading& reading_;
  Places places_;
  TriangleMesh mesh_;
  std::uint64_t short_count_ = 0;
  PolygonCounts counts_;
};

}  // namespace collided::engine
