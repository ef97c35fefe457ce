#include "server/world/sweep.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <variant>

#include "server/exact_phase/general_shapes.hpp"
#include "server/exact_phase/contact.hpp"

namespace collided {
namespace {

template <class Part>
void sweep_any(SphereSweep& sweep, const Part& part, std::uint32_t triangle) {
  SweptTouch& found = sweep.found;
  TimeBracket bracket;
  const Verdict verdict = first_contact(sweep.mover, part, sweep.width, bracket);
  ++found.exact_tests;
  if (verdict.decision == Decision::undecided) found.undecided = true;
  if (!verdict.yes()) return;
  if (!found.take(bracket, wire_contract::kNoTriangle, triangle)) return;
  const Vec3 center = sweep.mover.start + bracket.high * (sweep.mover.end - sweep.mover.start);
  found.contact = contact(Sphere{.center = center, .radius_m = sweep.mover.radius_m}, part);
}

double width_along(const TriangleMesh& mesh, const Vec3& n) {
  double least = n.dot(mesh.vertices[0]);
  double most = least;
  for (const Vec3& vertex : mesh.vertices) {
    least = std::min(least, n.dot(vertex));
    most = std::max(most, n.dot(vertex));
  }
  return most - least;
}

/// Along the axes and the normals of some triangles, spread evenly.
double least_width_m(const TriangleMesh& mesh) {
  constexpr std::size_t kNormals = 32;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) least = std::min(least, width_along(mesh, Vec3::Unit(k)));
  const std::size_t count = mesh.triangles.size();
  for (std::size_t i = 0; i < count; i += std::max<std::size_t>(1, count / kNormals)) {
    const Triangle t = mesh.triangle(static_cast<std::uint32_t>(i));
    const Vec3 n = (t.b - t.a).cross(t.c - t.a).stableNormalized();
    if (!n.isZero(0)) least = std::min(least, width_along(mesh, n));
  }
  return least;
}

double least_width_of(const Sphere& s) { return 2 * s.radius_m; }
double least_width_of(const Box& b) { return 2 * b.half_m.minCoeff(); }
double least_width_of(const Capsule& c) { return 2 * c.radius_m; }
double least_width_of(const Cylinder& c) { return std::min((c.b - c.a).norm(), 2 * c.radius_m); }
double least_width_of(const Cone& c) { return std::min((c.base - c.apex).norm(), c.radius_m); }
double least_width_of(const Ellipsoid& e) { return 2 * e.half_m.minCoeff(); }
double least_width_of(const HalfSpace&) { return std::numeric_limits<double>::infinity(); }
double least_width_of(const Hull& h) { return least_width_m(*h.mesh) / 2; }

}  // namespace

std::optional<Sphere> lone_sphere(const ObjectInfo& info) {
  if (info.mesh || info.primitives.size() != 1) return std::nullopt;
  const Sphere* sphere = std::get_if<Sphere>(&info.primitives.front());
  return sphere != nullptr ? std::optional(*sphere) : std::nullopt;
}

Aabb bounds(const MovingSphere& mover) {
  return bounds(Capsule{.a = mover.start, .b = mover.end, .radius_m = mover.radius_m});
}

void sweep_part(SphereSweep& sweep, const Triangle& part, std::uint32_t triangle) { sweep_any(sweep, part, triangle); }

void sweep_object(SphereSweep& sweep, const Placed& other, WalkCost& cost) {
  visit_primitives_near(*other.info, *other.frame, bounds(sweep.mover), cost, [&](const Primitive& primitive) {
    std::visit([&](const auto& part) { sweep_any(sweep, place(*other.frame, part), wire_contract::kNoTriangle); },
               primitive);
    return true;
  });
  if (!other.info->mesh) return;
  struct Context {
    SphereSweep& sweep;
    const Placed& other;
  } context{sweep, other};
  const auto candidate = [](void* raw, std::uint32_t triangle) {
    Context& c = *static_cast<Context*>(raw);
    sweep_any(c.sweep, place(*c.other.frame, c.other.info->mesh->mesh->triangle(triangle)), triangle);
    return true;
  };
  const IndexedMesh& mesh = *other.info->mesh;
  mesh.tree.walk_box(seen_from(*other.frame, bounds(sweep.mover), mesh.radius_m), candidate, &context, cost);
}

SweptTouch turned_round(SweptTouch touch) {
  std::swap(touch.a_triangle, touch.b_triangle);
  touch.contact.normal = -touch.contact.normal;
  return touch;
}

MoverSize size_of(const ObjectInfo& info) {
  MoverSize size{.reach_m = 0, .least_width_m = std::numeric_limits<double>::infinity()};
  const BodyWay nowhere;
  for (const Primitive& primitive : info.primitives) {
    // It does not move.
    if (std::holds_alternative<HalfSpace>(primitive)) continue;
    size.reach_m = std::max(size.reach_m, PartOnWay(part_of(primitive), nowhere).reach_m);
    size.least_width_m = std::min(size.least_width_m,
                                  std::visit([](const auto& own) { return least_width_of(own); }, primitive));
  }
  if (info.mesh && !info.mesh->mesh->vertices.empty()) {
    size.reach_m = std::max(size.reach_m, info.mesh->radius_m);
    size.least_width_m = std::min(size.least_width_m, least_width_m(*info.mesh->mesh));
  }
  return size;
}

/// A turn by an angle t changes the matrix by sqrt(8) sin(t / 2), of which t is at most pi / sqrt(8) times as much.
double longest_way_m(const Frame& from, const Frame& to, double reach_m) {
  const double turn_rad = 1.1108 * (to.rotation - from.rotation).norm();
  return (to.position - from.position).norm() + turn_rad * reach_m;
}

/// An arc bulges out of its chord by no more than an eighth of reach angle^2.
Aabb bounds(const ObjectInfo& info, const BodyWay& way, double reach_m) {
  Aabb all = bounds_of(info, way.from);
  all.extend(bounds_of(info, way.to));
  return grown(all, reach_m * way.turn_rad * way.turn_rad / 8 + 2 * way.error_m(reach_m));
}

}  // namespace collided
