#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "server/intake/scene.hpp"
#include "tests/scenes/mesh_files.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/unit/memory/counting.hpp"

namespace collided::engine {
namespace {

// At its peak a load holds the file as far as it is not yet read, what is read and not yet in place, and the mesh.
constexpr double kMostMeshes = 3;
constexpr std::uint32_t kCells = 708;  // 2 * 708^2 triangles: a million

/// As modellers write it: three times the text of a plain one, and five times the mesh.
std::string obj_file_with_normals(const TriangleMesh& mesh) {
  std::string text;
  for (const Vec3& v : mesh.vertices) {
    text += fmt::format("v {:.9g} {:.9g} {:.9g}\nvt {:.6f} {:.6f}\nvn {:.6f} {:.6f} {:.6f}\n", v[0], v[1], v[2],
                        v[0] / 100, v[1] / 100, 0.1, 0.2, 0.97);
  }
  for (const TriangleCorners& t : mesh.triangles) {
    text += fmt::format("f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  return text;
}

struct Format {
  const char* name;
  const char* ending;
  std::string (*file)(const TriangleMesh&);
};

class LoadMemory : public testing::TestWithParam<Format> {};

TEST_P(LoadMemory, AMillionTrianglesTakeAtMostThriceTheirMesh) {
  const std::string path =
      (std::filesystem::temp_directory_path() /
       ("collided_load_memory_" + std::to_string(::getpid()) + GetParam().name + GetParam().ending))
          .string();
  std::ofstream(path, std::ios::binary) << GetParam().file(scenes::terrain(kCells, 100, 7));
  const double file_bytes = static_cast<double>(std::filesystem::file_size(path));
  const std::size_t before = test::held_bytes();
  test::most_held_from_now();
  LoadReport report;
  const Scene scene = load_scene(path, {}, report);
  const auto peak = static_cast<double>(test::most_held_bytes() - before);
  std::filesystem::remove(path);
  ASSERT_EQ(scene.mesh.triangles.size(), std::size_t{2} * kCells * kCells);
  const auto mesh = static_cast<double>(scene.mesh.vertices.size() * sizeof(Vec3) +
                                        scene.mesh.triangles.size() * sizeof(TriangleCorners));
  std::printf("%s: %.1f MB held at the peak, %.1f of file, %.1f of mesh: %.2f\n", GetParam().name, peak / 1e6,
              file_bytes / 1e6, mesh / 1e6, peak / mesh);
  EXPECT_GE(peak, mesh) << "what was counted is less than what came back";
  EXPECT_LE(peak, kMostMeshes * mesh);
}

INSTANTIATE_TEST_SUITE_P(Formats, LoadMemory,
                         testing::Values(Format{"obj", ".obj", scenes::obj_file},
                                         Format{"obj_with_normals", ".obj", obj_file_with_normals},
                                         Format{"off", ".off", scenes::off_file},
                                         Format{"stl", ".stl", scenes::stl_file},
                                         Format{"ply", ".ply", scenes::ply_file}),
                         [](const auto& format) { return std::string(format.param.name); });

}  // namespace
}  // namespace collided::engine
