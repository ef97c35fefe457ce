#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/intake/scene_file/scene_index.hpp"
#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  collided::fuzz::load_or_refuse("fuzz.cscene", data, size);
  // The checksum refuses nearly all; what is behind it must hold as well.
  std::vector<std::uint8_t> sealed(data, data + size);
  const std::size_t tables = collided::engine::table_bytes({reinterpret_cast<const char*>(data), size});
  collided::engine::seal_scene(std::as_writable_bytes(std::span(sealed).first(tables)));
  collided::fuzz::load_or_refuse("fuzz.cscene", sealed.data(), sealed.size());
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  using namespace collided;
  using namespace collided::engine;
  Scene small{.name = "s"};
  small.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.1}};
  small.mesh.triangles = {{0, 1, 2}};
  small.parts = {{"s", 0, 1, {}}};
  SceneObject object{.name = "o"};
  object.shape.primitives.emplace_back(Sphere{{0, 0, 0}, 1});
  object.shape.primitives.emplace_back(Box{.center = {1, 0, 0}, .half_m = {1, 1, 1}});
  object.shape.primitives.emplace_back(Capsule{{0, 0, 0}, {1, 0, 0}, 1});
  object.shape.mesh = std::make_shared<const TriangleMesh>(small.mesh);
  small.objects = {object};
  std::vector<std::string> seeds;
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("fuzz_" + std::to_string(::getpid()) + ".cscene");
  Scene with_index = small;
  const auto index = std::make_shared<const std::vector<std::byte>>(Bvh::build(small.mesh).saved(small.mesh));
  with_index.index = with_index.objects[0].index = {*index, index};
  Scene with_levels = small;
  with_levels.collapses = {{0, 1}};
  for (const Scene& scene : {small, with_index, with_levels, embedded_scene()}) {
    save_scene(path.string(), scene);
    std::ifstream file(path, std::ios::binary);
    seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  std::filesystem::remove(path);
  return seeds;
}
