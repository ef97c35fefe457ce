#include "server/broad_phase/hierarchy/bvh_primitive.hpp"

#include <atomic>
#include <mutex>

#include "server/broad_phase/hierarchy/bvh_threads.hpp"

namespace collided::engine::bvh {

Primitive local_primitive(const TriangleMesh& mesh, const LocalFrame& frame, std::uint32_t number) {
  const Triangle world = mesh.triangle(number);
  const Vec3 low = frame.to_local(world.a.cwiseMin(world.b).cwiseMin(world.c));
  const Vec3 high = frame.to_local(world.a.cwiseMax(world.b).cwiseMax(world.c));
  Primitive primitive;
  for (int axis = 0; axis < 3; ++axis) {
    primitive.low[axis] = round_down(low[axis]);
    primitive.high[axis] = round_up(high[axis]);
  }
  primitive.low[3] = std::bit_cast<float>(number);
  primitive.high[3] = 0;
  return primitive;
}

void set_lane(const TriangleMesh& mesh, const LocalFrame& frame, bool has_corners, std::uint32_t number, int lane,
              Leaf& leaf) {
  const Triangle world = mesh.triangle(number);
  const Vec3 first = frame.to_local(world.a);
  const Vec3 base = has_corners ? Vec3::Zero() : first;
  const Vec3 second = frame.to_local(world.b) - base;
  const Vec3 third = frame.to_local(world.c) - base;
  for (int axis = 0; axis < 3; ++axis) {
    leaf.a[axis][lane] = static_cast<float>(first[axis]);
    leaf.b[axis][lane] = static_cast<float>(second[axis]);
    leaf.c[axis][lane] = static_cast<float>(third[axis]);
  }
  leaf.triangle[lane] = number;
}

MeshFrame mesh_frame(const TriangleMesh& mesh, unsigned threads) {
  constexpr std::size_t kRun = 65536;
  Aabb bounds;
  std::mutex mutex;
  in_runs(threads, mesh.triangles.size(), kRun, [&](std::size_t begin, std::size_t end) {
    Aabb own;
    for (std::size_t i = begin; i < end; ++i) {
      for (const std::uint32_t corner : mesh.triangles[i]) own.extend(mesh.vertices[corner]);
    }
    const std::lock_guard lock(mutex);
    bounds.extend(own.low);
    bounds.extend(own.high);
  });
  MeshFrame found{local_frame(bounds), false};
  std::atomic<bool> all_floats{true};
  in_runs(threads, mesh.triangles.size(), kRun, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && all_floats.load(std::memory_order_relaxed); ++i) {
      for (const std::uint32_t corner : mesh.triangles[i]) {
        if (!found.frame.is_float(mesh.vertices[corner])) all_floats = false;
      }
    }
  });
  found.has_corners = all_floats;
  return found;
}

}  // namespace collided::engine::bvh
