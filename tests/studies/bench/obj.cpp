#include "tests/studies/bench/obj.hpp"

#include <fstream>
#include <sstream>

namespace collided::bench {
using namespace engine;

TriangleMesh read_obj(const std::string& path) {
  TriangleMesh mesh;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vec3 vertex;
      words >> vertex[0] >> vertex[1] >> vertex[2];
      mesh.vertices.push_back(vertex);
    } else if (kind == "f") {
      TriangleCorners corners{};
      for (std::uint32_t& corner : corners) {
        std::string word;
        words >> word;
        // "corner/texture/normal": the number before the first slash, counted from one.
        corner = static_cast<std::uint32_t>(std::stoul(word) - 1);
      }
      mesh.triangles.push_back(corners);
    }
  }
  return mesh;
}

}  // namespace collided::bench
