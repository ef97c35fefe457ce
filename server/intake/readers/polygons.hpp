#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/intake/polygons/polygon_counts.hpp"
#include "server/intake/polygons/triangulate.hpp"
#include "server/intake/readers/reading.hpp"

namespace collided::engine {

/// Faces of any number of corners on their way to one unnamed part: what OFF and PLY share. Counts what it has to
/// leave out or to guess, and says so in the end.
/// place  where the face stands, for complaints: a pointer into the text, or into the bytes of a binary file
class Polygons {
 public:
  enum class Places { lines, bytes };

  explicit Polygons(const Reading& reading, Places places = Places::lines) : reading_(reading), places_(places) {}

  std::vector<Vec3>& vertices() { return mesh_.vertices; }

  std::uint32_t vertex_number(std::int64_t number, const char* place) const;
  void add(std::span<const std::uint32_t> corners, const char* place);
  /// Corners 0 1 2, 1 2 3, ...: each new one makes a triangle with the two before, every other one turned round.
  void add_strip(std::span<const std::uint32_t> corners, const char* place);

  void report() const;
  Scene take_scene();

 private:
  [[noreturn]] void complain(const char* place, const std::string& what) const;

  const Reading& reading_;
  Places places_;
  TriangleMesh mesh_;
  std::uint64_t short_count_ = 0;
  PolygonCounts counts_;
};

}  // namespace collided::engine
