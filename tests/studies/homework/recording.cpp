#include "tests/studies/homework/recording.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>

#include "client/cli/publish/response/spheres.hpp"
#include "server/intake/mesh/sphere_mesh.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "tests/studies/homework/method.hpp"

namespace collided::homework {
using namespace engine;
namespace {

constexpr std::size_t kSizes = 16;
constexpr double kSpeed = 0.5;  // m/s an axis
constexpr double kSpin = 3;     // rad/s
constexpr double kStep = 1 / 60.0;
constexpr int kSettling = 30;  // frames before the recording

/// Uniform in [low, high), the same on every machine, unlike std's distributions.
double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

Vec3 uniform_vector(std::mt19937_64& random, double most) {
  const double x = uniform(random, -most, most), y = uniform(random, -most, most);
  return {x, y, uniform(random, -most, most)};
}

std::shared_ptr<const IndexedMesh> sphere(double radius_m, std::size_t polygons) {
  // Nearly square cells: 2 lon (lat - 1) triangles with lon = 2 (lat - 1), so that 256 is 16 by 9.
  const auto bands = static_cast<unsigned>(std::max(1.0, std::round(std::sqrt(static_cast<double>(polygons) / 4))));
  auto mesh =
      std::make_shared<const TriangleMesh>(latitude_longitude_sphere(radius_m, std::max(3u, 2 * bands), bands + 1));
  Bvh tree = Bvh::build(*mesh, {.threads = 1, .progress = {}, .cancelled = {}});
  return indexed_mesh(std::move(mesh), std::move(tree));
}

/// A place in a cell of its own for each, so that few overlap from the start, however many there are.
std::vector<Vec3> places(const std::vector<double>& radii, std::mt19937_64& random) {
  const auto count = static_cast<std::size_t>(std::ceil(std::cbrt(static_cast<double>(radii.size()))));
  std::vector<std::size_t> cells(count * count * count);
  std::iota(cells.begin(), cells.end(), std::size_t{0});
  for (std::size_t i = cells.size(); i > 1; --i) std::swap(cells[i - 1], cells[random() % i]);
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const double side = 1.0 / static_cast<double>(count);
    const Vec3 cell(static_cast<double>(cells[i] % count), static_cast<double>(cells[i] / count % count),
                    static_cast<double>(cells[i] / (count * count)));
    const Vec3 place = side * (cell + Vec3::Constant(0.5)) - Vec3::Constant(0.5) + uniform_vector(random, side / 4);
    const double most = 0.5 - radii[i];
    result.push_back(place.cwiseMin(most).cwiseMax(-most));
  }
  return result;
}

}  // namespace

Recording record(const Problem& problem) {
  std::mt19937_64 random(problem.seed);
  Recording recording;
  std::vector<double> radius_of_size;
  for (std::size_t i = 0; i < kSizes; ++i) {
    const double share = 0.5 + (static_cast<double>(i) + 0.5) / kSizes;
    radius_of_size.push_back(share * problem.relative_size / 2);
    recording.sizes.push_back(sphere(radius_of_size.back(), problem.polygons));
  }
  recording.polygons = recording.sizes[0]->mesh->triangles.size();
  std::vector<double> radii;
  for (std::size_t i = 0; i < problem.objects; ++i) {
    recording.size_of.push_back(random() % kSizes);
    radii.push_back(radius_of_size[recording.size_of.back()]);
  }
  const std::vector<Vec3> place = places(radii, random);
  std::vector<response::Sphere> spheres;
  for (std::size_t i = 0; i < problem.objects; ++i) {
    const Vec3 velocity = uniform_vector(random, kSpeed);
    spheres.push_back({radii[i], place[i], velocity, uniform_vector(random, kSpin / std::sqrt(3.0))});
  }
  response::Spheres motion({}, std::move(spheres));
  const auto poses = [&] {
    std::vector<Pose> all;
    for (const response::Sphere& s : motion.spheres()) all.push_back({.position = s.position, .rotation = s.rotation});
    return all;
  };
  recording.poses.push_back(poses());
  CollidedWorld world(recording);  // says who touches whom
  recording.poses.clear();
  for (std::size_t frame = 0; frame < kSettling + problem.frames; ++frame) {
    const std::vector<Pose> now = poses();
    world.frame(now);
    if (frame >= kSettling) recording.poses.push_back(now);
    world.for_each_change([&](std::size_t a, std::size_t b, bool began) {
      if (began) {
        motion.contact_began(a, b);
      } else {
        motion.contact_ended(a, b);
      }
    });
    motion.step(kStep);
  }
  return recording;
}

}  // namespace collided::homework
