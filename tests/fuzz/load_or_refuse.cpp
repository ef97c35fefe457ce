#include <algorithm>
#include <string>
#include <unordered_set>

#include "server/intake/readers/names.hpp"
#include "server/intake/readers/reading.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace collided::fuzz {
using namespace engine;

void load_or_refuse(const std::string& file, const std::uint8_t* data, std::size_t size) {
  Scene scene;
  LoadReport report;
  try {
    const LoadOptions options{.name = {}, .max_triangles = 100'000, .progress = {}, .cancelled = {}};
    scene = load_scene_from_memory({reinterpret_cast<const char*>(data), size}, file, options, report);
  } catch (const LoadError& error) {
    require(std::string(error.what()).ends_with(" Nothing was loaded."), "an error says its consequence");
    require(flaw_of_name(std::string(error.what()).substr(0, 200)).empty(), "an error is printable");
    return;
  }
  for (const Vec3& vertex : scene.mesh.vertices) { require(vertex.allFinite(), "every vertex is finite"); }
  for (const TriangleCorners& corners : scene.mesh.triangles) {
    require(*std::max_element(corners.begin(), corners.end()) < scene.mesh.vertices.size(), "corners are vertices");
  }
  require(scene.mesh.triangles.size() <= 100'000, "the limit of triangles is kept");
  std::unordered_set<std::string> names;
  std::uint64_t covered = 0;
  for (const Part& part : scene.parts) {
    require(part.first_triangle == covered && part.triangle_count > 0, "parts tile the triangles");
    covered += part.triangle_count;
    require(flaw_of_name(part.name).empty() && names.insert(part.name).second, "names are fit and unique");
  }
  require(covered == scene.mesh.triangles.size(), "parts cover the triangles");
  for (const SceneObject& object : scene.objects) {
    require(flaw_of_name(object.name).empty() && names.insert(object.name).second, "names are fit and unique");
    require(!object.shape.empty() && object.pose.position.allFinite(), "an object has a shape and a place");
  }
}

}  // namespace collided::fuzz
