// Readers and the health report on one core: megabytes of file a second, memory at its peak beside what came out, and
// the seconds that a mesh of a million triangles takes to be checked.
// Each row runs in a process of its own, pinned to one core, and tells the best of three.

#include <fmt/format.h>
#include <fmt/os.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <functional>
#include <string>

#include "server/exact_phase/edge_kinds.hpp"
#include "server/intake/file_bytes.hpp"
#include "server/intake/mesh/mend.hpp"
#include "server/intake/mesh/mesh_health.hpp"
#include "server/intake/readers/reading.hpp"
#include "server/world/objects/self_intersections.hpp"
#include "tests/scenes/mesh_files.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::bench {
using namespace engine;
namespace {

constexpr int kRepeats = 3;
constexpr std::uint32_t kCells = 708;  // 2 * 708^2 triangles: a million

/// Of the processor, all threads together: others may use the core in between.
double processor_s() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double seconds(const std::function<void()>& work) {
  double best = 1e9;
  for (int i = 0; i < kRepeats; ++i) {
    const double start = processor_s();
    work();
    best = std::min(best, processor_s() - start);
  }
  return best;
}

long peak_bytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss * 1024;
}

/// In a process of its own on one core, so that peaks do not mix.
void alone(const std::function<void()>& row) {
  std::fflush(stdout);
  const pid_t child = ::fork();
  if (child == 0) {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(0, &one);
    ::sched_setaffinity(0, sizeof one, &one);
    row();
    std::fflush(stdout);
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
}

void write(const std::string& path, const std::string& bytes) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  std::fwrite(bytes.data(), 1, bytes.size(), file);
  std::fclose(file);
}

void read_row(const std::string& path, Scene (*read)(const Reading&)) {
  const auto file_mb = static_cast<double>(std::filesystem::file_size(path)) / 1e6;
  const long before = peak_bytes();
  double result = 0;
  LoadReport report;
  {
    const Scene scene = load_scene(path, {}, report);
    result = static_cast<double>(scene.mesh.vertices.size() * sizeof(Vec3) +
                                 scene.mesh.triangles.size() * sizeof(TriangleCorners));
  }
  const auto peak = static_cast<double>(peak_bytes() - before);
  const double whole_s = seconds([&] {
    LoadReport unread;
    load_scene(path, {}, unread);
  });
  const FileBytes bytes(path, FileBytes::Access::copied, {});
  const double reader_s = seconds([&] {
    LoadReport unread;
    const LoadOptions options;
    read({"terrain", bytes.bytes(), options, unread});
  });
  std::printf(
      "  %-5s %6.1f MB  reader %5.0f MB/s  whole load %5.0f MB/s  peak %5.1f MB beside %5.1f of file and %4.1f of "
      "result: %4.2f\n",
      std::filesystem::path(path).extension().c_str(), file_mb, file_mb / reader_s, file_mb / whole_s, peak / 1e6,
      file_mb, result / 1e6, peak / (file_mb * 1e6 + result));
}

void check_rows(const TriangleMesh& mesh) {
  MeshHealth health;
  std::printf("  health report        %6.3f s\n", seconds([&] { health = examine(mesh); }));
  std::printf("  creases, silhouettes %6.3f s\n",
              seconds([&] { edge_kinds(mesh, health.edges, {.eye = Vec3(3, 2, 30)}); }));
  Bvh tree;
  std::printf("  index                %6.3f s\n",
              seconds([&] { tree = Bvh::build(mesh, {.threads = 1, .progress = {}, .cancelled = {}}); }));
  std::printf("  self-intersections   %6.3f s\n", seconds([&] { self_intersections(mesh, tree); }));
  TriangleMesh flat = mesh;
  for (Vec3& v : flat.vertices) v[2] = 0;
  const Bvh flat_tree = Bvh::build(flat, {.threads = 1, .progress = {}, .cancelled = {}});
  std::printf("  the same, laid flat  %6.3f s\n", seconds([&] { self_intersections(flat, flat_tree); }));
  std::printf("  mending a clean mesh %6.3f s\n", seconds([&] { mend(mesh, 0); }));
}

}  // namespace
}  // namespace collided::bench

int main() {
  using namespace collided;
  using namespace collided::bench;
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("collided_intake_bench_{}", ::getpid());
  std::filesystem::create_directory(folder);
  const auto path = [&](const char* ending) { return (folder / (std::string("terrain") + ending)).string(); };
  alone([&] {
    const TriangleMesh mesh = scenes::terrain(kCells, 100, 7);
    write(path(".obj"), scenes::obj_file(mesh));
    write(path(".stl"), scenes::stl_file(mesh));
    write(path(".ply"), scenes::ply_file(mesh));
    write(path(".off"), scenes::off_file(mesh));
  });
  std::printf("reading %u triangles, names, weld report and all\n", 2 * kCells * kCells);
  alone([&] { read_row(path(".obj"), read_obj); });
  alone([&] { read_row(path(".off"), read_off); });
  alone([&] { read_row(path(".stl"), read_stl); });
  alone([&] { read_row(path(".ply"), read_ply); });
  std::filesystem::remove_all(folder);
  std::printf("checking them\n");
  alone([&] { check_rows(scenes::terrain(kCells, 100, 7)); });
  return 0;
}
