// Saved trees that somebody tampered with, made to look honest by right checksums: each is refused, or answers as the
// tree of a build would. (What checksums alone refuse is fuzz_scene_file's.)

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <random>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_saved.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/oracle/plain_ray.hpp"
#include "tests/scenes/meshes.hpp"

namespace {

using namespace collided;
using namespace collided::engine;

/// Small triangles and a few long slanted ones, so that some are split.
const TriangleMesh& fuzz_mesh() {
  static const TriangleMesh mesh = [] {
    TriangleMesh all = scenes::scattered(150, 0.1, 3);
    scenes::append(all, scenes::slanted(4, 1, 5));
    return all;
  }();
  return mesh;
}

using Seen = std::vector<std::uint8_t>;

void expect_complete(const Bvh& tree) {
  const TriangleMesh& mesh = fuzz_mesh();
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto point = [&] {
    const double x = number(random);
    const double y = number(random);
    return Vec3(x, y, number(random));
  };
  for (int i = 0; i < 8; ++i) {
    const Triangle aim = mesh.triangle(static_cast<std::uint32_t>(random() % mesh.triangles.size()));
    const Vec3 from = 2 * point();
    const Ray ray{from, (aim.a + aim.b + aim.c) / 3 - from};
    Seen seen(mesh.triangles.size());
    WalkCost cost;
    tree.walk_ray(
        ray, std::numeric_limits<double>::infinity(), 0, mesh,
        [&](std::uint32_t triangle, const Triangle& corners, double limit) {
          fuzz::require(triangle < fuzz_mesh().triangles.size(), "a candidate is a triangle");
          fuzz::require(corners.a == fuzz_mesh().triangle(triangle).a, "a candidate's corners are the mesh's");
          seen[triangle] = 1;
          return limit;
        },
        cost);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      fuzz::require(seen[t] != 0 || !oracle::plain_ray(ray, mesh.triangle(t)), "no triangle that a ray meets is lost");
    }
  }
  const Vec3 center = point();
  const Aabb asked{.low = center - Vec3::Constant(0.2), .high = center + Vec3::Constant(0.2)};
  Seen boxed(mesh.triangles.size());
  Seen near(mesh.triangles.size());
  WalkCost cost;
  const auto note = [&](std::uint32_t triangle) {
    boxed.at(triangle) = 1;
    return true;
  };
  tree.walk_box(asked, note, cost);
  const auto note_near = [&](std::uint32_t triangle, double limit) {
    near.at(triangle) = 1;
    return limit;
  };
  tree.walk_near(center, 0.04, 0, note_near, cost);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle triangle = mesh.triangle(t);
    for (const Vec3& corner : {triangle.a, triangle.b, triangle.c}) {
      const bool inside = ((corner - center).cwiseAbs().array() <= 0.2).all();
      fuzz::require(!inside || boxed[t] != 0, "no triangle with a corner in the box is lost");
      fuzz::require((corner - center).norm() > 0.1999 || near[t] != 0, "no triangle near the point is lost");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> bytes(size);
  if (size > 0) std::memcpy(bytes.data(), data, size);
  bvh::seal(bytes, fuzz_mesh());
  const auto loaded = Bvh::load(fuzz_mesh(), bytes, nullptr, 1);
  if (const auto* tree = std::get_if<Bvh>(&loaded)) expect_complete(*tree);
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  std::vector<std::string> seeds;
  for (const BvhForm form : {BvhForm::fast, BvhForm::best}) {
    const Bvh tree = Bvh::build(fuzz_mesh(), {.threads = 1, .progress = {}, .cancelled = {}, .form = form});
    const std::vector<std::byte> bytes = tree.saved(fuzz_mesh());
    seeds.emplace_back(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  return seeds;
}
