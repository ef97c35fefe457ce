#include <algorithm>

#include "server/intake/mesh/mend.hpp"
#include "server/intake/mesh/mesh_health.hpp"
#include "tests/fuzz/fuzz_target.hpp"

// A mesh of the bytes: the first says the widest crack, then three bytes a vertex as sixteenths with a little shift,
// and after a byte 255 three a triangle. Many points are then on others' edges, beside each other or on one line.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace collided;
  using namespace collided::engine;
  if (size < 8) return 0;
  const double crack_m = 0.001 * data[0];
  TriangleMesh mesh;
  std::size_t at = 1;
  for (; at + 3 <= size && data[at] != 255 && mesh.vertices.size() < 200; at += 3) {
    const auto coordinate = [&](std::size_t k) { return (data[at + k] >> 4) + 0.0005 * (data[at + k] & 15); };
    mesh.vertices.emplace_back(coordinate(0), coordinate(1), coordinate(2));
  }
  if (mesh.vertices.empty()) return 0;
  for (++at; at + 3 <= size && mesh.triangles.size() < 200; at += 3) {
    TriangleCorners corners{};
    for (std::size_t k = 0; k < 3; ++k) corners[k] = data[at + k] % static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.triangles.push_back(corners);
  }
  const MendedMesh mended = mend(mesh, crack_m);
  fuzz::require(mended.mesh.vertices.size() == mesh.vertices.size(), "no vertex comes or goes");
  fuzz::require(mended.origin.size() == mended.mesh.triangles.size(), "each triangle tells what it was");
  for (std::size_t i = 0; i < mended.origin.size(); ++i) {
    fuzz::require(i < mesh.triangles.size() ? mended.origin[i] == i : mended.origin[i] < mesh.triangles.size(),
                  "triangles keep their places");
    fuzz::require(
        *std::max_element(mended.mesh.triangles[i].begin(), mended.mesh.triangles[i].end()) < mesh.vertices.size(),
        "corners are vertices");
  }
  if (mesh.triangles.empty()) return 0;
  const double reach_m = std::max(mended.report.crack_m, examine(mesh).seam_reach.on_edge_m);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const double moved_m = (mended.mesh.vertices[i] - mesh.vertices[i]).norm();
    // Rounds follow each other, each within its reach of where the last one left it.
    fuzz::require(moved_m <= 8 * reach_m, "no point goes far");
    fuzz::require(moved_m <= 8 * mended.report.largest_move_m, "no point goes farther than is told");
  }
  fuzz::require(mended.mesh.triangles.size() < 200 * 60, "pieces stay few");
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  using namespace std::string_literals;
  return {
      "\x05\x00\x00\x00\x10\x00\x00\x10\x10\x00\x00\x10\x00\x18\x08\x00\x20\x00\x00\xff\x00\x01\x02\x00\x02\x03\x01\x05\x04\x04\x05\x02"s,
      "\x01\x00\x00\x00\x40\x00\x00\x40\x40\x00\x00\x40\x00\x41\x20\x00\x41\x40\x01\x80\x00\x00\x80\x40\x00\xff\x00\x01\x02\x00\x02\x03\x01\x06\x04\x04\x06\x07\x04\x07\x05"s,
  };
}
