#include <algorithm>

#include "server/exact_phase/arithmetic/ladder.hpp"
#include "server/exact_phase/kernels/triangle_kernel.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/exact_phase/ray/ray_hit_value.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/pose.hpp"

namespace collided::engine {
namespace {

using namespace kernel;

Triangle face_of(const Hull& hull, const TriangleCorners& corner) {
  return {vertex_of(hull, corner[0]), vertex_of(hull, corner[1]), vertex_of(hull, corner[2])};
}

/// Whether the point is behind all faces or on them.
ExactResult behind_all_faces(const Hull& hull, const Vec3& point) {
  ExactResult all{Decision::yes, Level::filter};
  for (const TriangleCorners& corner : hull.mesh->triangles) {
    const Triangle face = face_of(hull, corner);
    const ExactResult behind = climb([&]<class N>() {
      const Vector<N> a = Vector<N>(face.a) - Vector<N>(point);
      return at_most(N(0.0),
                     dot(a, cross(Vector<N>(face.b) - Vector<N>(face.a), Vector<N>(face.c) - Vector<N>(face.a))));
    });
    all = {both(all.decision, behind.decision), std::max(all.level, behind.level)};
    if (all.decision == Decision::no) break;
  }
  return all;
}

}  // namespace

ExactResult cast_ray(const Ray& ray, const Hull& hull, RayHit& hit) {
  const ExactResult inside = behind_all_faces(hull, ray.origin);
  ExactResult verdict = inside;
  // Without the length limit: the faces beyond it show where a ray that starts inside leaves.
  const Ray endless{ray.origin, ray.direction};
  RayHit first;
  RayHit last;
  bool met = false;
  for (const TriangleCorners& corner : hull.mesh->triangles) {
    const Triangle face = face_of(hull, corner);
    RayHit own;
    const ExactResult crossed = cast_ray(endless, face, own);
    if (!crossed.yes()) {
      if (crossed.decision == Decision::undecided) verdict = joined(verdict, crossed);
      continue;
    }
    if (!met || own.distance_m > last.distance_m) last = own;
    if (!met || own.distance_m < first.distance_m) first = own;
    met = true;
    if (inside.yes()) continue;
    RayHit unread;
    verdict = joined(verdict, cast_ray(ray, face, unread));
  }
  if (!verdict.yes()) return verdict;
  const Bounded leave(last.distance_m, last.distance_error_m);
  set_interval(ray, inside.yes(), Bounded(first.distance_m, first.distance_error_m), leave, hit);
  hit.normal = inside.yes() && last.normal.dot(ray.direction) < 0 ? Vec3(-last.normal)
               : inside.yes()                                     ? last.normal
                                                                  : first.normal;
  return verdict;
}

}  // namespace collided::engine
