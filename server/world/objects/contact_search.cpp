#include "server/world/objects/contact_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/exact_phase/distance/box_contact.hpp"
#include "server/exact_phase/overlap/separation_filter.hpp"
#include "server/exact_phase/part_convex.hpp"
#include "server/geometry/common_origin.hpp"
#include "server/geometry/placing_error.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/placed_box.hpp"

namespace collided::engine {
namespace {

/// Roundings between a mesh point in its own frame and the same point placed and seen back, in units of 2^-53 of the
/// largest length met. Placing: three products, three sums, and a matrix that is orthonormal to 6 roundings a row;
/// seeing back: one difference and the same again. Twice the sum (26) is taken.
/// At zero, WorldTest.FarFromOriginAMovingMeshIsStillFound fails.
constexpr double kPlacementRoundoffs = 52;

/// Limit of kept pairs of overlapping triangles: there may be as many as the product of both meshes.
constexpr std::size_t kMostMet = 1 << 20;

/// Visits the triangles of a mesh, in its own frame, near a box in world coordinates.
template <class Visit>
void near_triangles(const IndexedMesh& mesh, const Frame& frame, const Aabb& world, WalkCost& cost, Visit&& visit) {
  mesh.tree.walk_box(seen_from(frame, world, mesh.radius_m), visit, cost);
}

Contact flipped(Contact contact) {
  contact.normal = -contact.normal;
  return contact;
}

/// Bounds of the part of an endless primitive inside the box; for any other, its whole bounds.
Aabb bounds_near(const Primitive& a, const Aabb& box) {
  const auto* half_space = std::get_if<HalfSpace>(&a);
  return half_space != nullptr ? bounds_within(*half_space, box) : bounds(a);
}

/// The same for an object: a half-space is the only primitive of its object.
Aabb bounds_near(const Placed& a, const Aabb& box) {
  const bool endless = a.info->primitives.size() == 1 && std::holds_alternative<HalfSpace>(a.info->primitives.front());
  return endless ? bounds_near(place(a.frame, a.info->primitives.front()), box) : a.bounds;
}

void search_mesh(const Primitive& a, const GivenPart& given, const Placed& b, ContactSearch& touch, WalkCost& cost) {
  const Aabb near = bounds_near(a, b.bounds);
  if (near.empty()) return;
  const IndexedMesh& mesh = *b.info->mesh;
  near_triangles(mesh, b.frame, near, cost, [&](std::uint32_t triangle) {
    const GivenPart given_b = b.given(triangle);
    search_parts(a, kNoTriangle, place(b.frame, mesh.mesh->triangle(triangle)), triangle, touch, {given, given_b});
    return !touch.done();
  });
}

void search_meshes(const Placed& a, const Placed& b, ContactSearch& touch, WalkCost& cost) {
  PlacedTriangles of_a(*a.info->mesh->mesh, a.frame);
  PlacedTriangles of_b(*b.info->mesh->mesh, b.frame);
  const auto candidate = [&](std::uint32_t triangle_a, std::uint32_t triangle_b) {
    const GivenPart given_a = a.given(triangle_a);
    const GivenPart given_b = b.given(triangle_b);
    search_parts(of_a.at(triangle_a), triangle_a, of_b.at(triangle_b), triangle_b, touch, {given_a, given_b});
    if (touch.met != nullptr && touch.met->size() >= kMostMet) std::exchange(touch.met, nullptr)->clear();
    return !touch.done();
  };
  // A deadline may fall between two candidates that are far from each other.
  const auto is_over = [&] { return touch.deadline != nullptr && touch.deadline->is_over(); };
  walk_mesh_pairs(a, b, candidate, is_over, cost);
}

/// Tests a's mesh against b's primitives. The exact phase takes the primitive first, so the contact is flipped.
void search_mesh_primitives(const Placed& a, const Placed& b, ContactSearch& touch, WalkCost& cost) {
  visit_primitives_near(*b.info, b.frame, a.bounds, cost, [&](const Primitive& primitive) {
    ContactSearch turned;
    turned.wanted = touch.wanted;
    turned.deadline = touch.deadline;
    search_mesh(place(b.frame, primitive), b.given(primitive), a, turned, cost);
    touch.exact_tests += turned.exact_tests;
    touch.level = std::max(touch.level, turned.level);
    touch.undecided = touch.undecided || turned.undecided;
    if (!turned.yes) return true;
    const Contact contact = flipped(turned.contact);
    if (touch.wanted && deeper(contact, turned.b_triangle, kNoTriangle, touch)) {
      touch.contact = contact;
      touch.a_triangle = turned.b_triangle;
      touch.b_triangle = kNoTriangle;
    }
    touch.yes = true;
    return !touch.done();
  });
}

/// Bounds in world coordinates of everything inside a box of the frame that is at most reach_m from the frame's origin.
Aabb placed_bounds(const Frame& frame, const Aabb& own, double reach_m) {
  const Vec3 center = 0.5 * own.low + 0.5 * own.high;
  const Vec3 half = (own.high - center).cwiseMax(center - own.low);
  const Vec3 slack = Vec3::Constant(placement_slack(frame, center.lpNorm<1>() + half.lpNorm<1>(), reach_m));
  const Vec3 placed_center = place(frame, center);
  const Vec3 placed_half = frame.rotation.cwiseAbs() * half + slack;
  return {.low = placed_center - placed_half, .high = placed_center + placed_half};
}

}  // namespace

double placement_slack(const Vec3& frame_position, double distance_m, double reach_m) {
  const double largest_m = frame_position.lpNorm<1>() + distance_m + 2 * reach_m;
  return kPlacementRoundoffs * kRoundoff * largest_m + std::numeric_limits<double>::min();
}

namespace {

/// How far off the part's placing may be inside the box of the other part.
double placing_error_within(const ConvexPart& part, const GivenPart& given, const ConvexPart& other) {
  const HalfSpace* ground = half_space_of(part);
  if (ground == nullptr || half_space_of(other) != nullptr) return given.placing_error_m(0);
  const Aabb box = bounds_of_part(other);
  return given.placing_error_m(
      (box.high - ground->point).cwiseAbs().cwiseMax((box.low - ground->point).cwiseAbs()).norm());
}

}  // namespace

double placing_error_m(const ConvexPart& a, const ConvexPart& b, const GivenPair& given) {
  return (placing_error_within(a, given.a, b) + placing_error_within(b, given.b, a)) * (1 + kBoundSlack);
}

Decision quickly_decided(const Primitive& a, const Primitive& b, double off_m) {
  const Box* box_a = std::get_if<Box>(&a);
  const Box* box_b = std::get_if<Box>(&b);
  if (box_a == nullptr || box_b == nullptr) return Decision::undecided;
  return kernel::quickly_overlaps(*box_a, *box_b, off_m);
}

ExactResult decided_as_given(const ConvexPart& a, const ConvexPart& b, const GivenPair& given, double off_m,
                             ExactResult verdict) {
  if (verdict.yes() && surely_meet(a, b, off_m)) return verdict;
  const Decision as_given = overlaps_as_given(a, b, given);
  return as_given == Decision::undecided ? verdict : ExactResult{as_given, Level::rational};
}

Contact contact_as_given(const ConvexPart& a, const ConvexPart& b) {
  const Separation apart = separation(a, b);
  Contact found{.point = apart.on_a,
                .normal = apart.normal.isZero(0) ? Vec3(Vec3::UnitZ()) : apart.normal,
                .depth_error_m = apart.distance_m + apart.error_m};
  if (half_space_of(a) != nullptr || half_space_of(b) != nullptr) return found;
  // Nearest points closer than their error give no direction; a contact's normal comes from the parts' faces.
  const kernel::Convex set_a = convex_of(a);
  const kernel::Convex set_b = convex_of(b);
  double push_m = kernel::push_along(found.normal, set_a, set_b).high();
  const Vec3 by_faces = contact(a, b).normal;
  const double by_faces_m = kernel::push_along(by_faces, set_a, set_b).high();
  if (by_faces_m < push_m) {
    push_m = by_faces_m;
    found.normal = by_faces;
  }
  // Moving that far in any direction separates them.
  found.depth_error_m = std::max(found.depth_error_m, push_m);
  return found;
}

namespace {

/// A second object's mesh in the first one's frame.
struct SeenMesh {
  Mat3 rotation;
  Vec3 position;
  double slack_m;  // twice the slack of placing one
};

SeenMesh seen_mesh(const Placed& a, const Placed& b) {
  const Mat3 back = a.frame.rotation.transpose();
  const Vec3 between = b.frame.position - a.frame.position;
  return {.rotation = back * b.frame.rotation,
          .position = back * between,
          .slack_m = 2 * placement_slack(a.frame, between.lpNorm<1>() + b.frame.position.lpNorm<1>(),
                                         a.info->mesh->radius_m + b.info->mesh->radius_m)};
}

}  // namespace

void walk_mesh_pairs(const Placed& a, const Placed& b, Bvh::PairCandidate candidate, Bvh::Interrupt is_over,
                     WalkCost& cost, double gap_m) {
  const SeenMesh seen = seen_mesh(a, b);
  a.info->mesh->tree.walk_pairs(b.info->mesh->tree, seen.rotation, seen.position, seen.slack_m + gap_m, candidate,
                                is_over, cost);
}

void walk_near_mesh_pairs(const Placed& a, const Placed& b, double limit_m, Bvh::NearPairCandidate candidate,
                          Bvh::Interrupt is_over, WalkCost& cost) {
  const SeenMesh seen = seen_mesh(a, b);
  a.info->mesh->tree.walk_near_pairs(b.info->mesh->tree, seen.rotation, seen.position, seen.slack_m, limit_m, candidate,
                                     is_over, cost);
}

namespace {

/// Bounds of a placed box whose points may be off by off_m, a few roundings wider than the tightest: the bounds of a
/// turning mover change in every step.
Aabb bounds_of_turned(const Box& placed, double off_m) {
  // The products, which may underflow, and their sums; then the two sums with the centre.
  constexpr double kUnderflows = 8 * std::numeric_limits<double>::denorm_min();
  Aabb box;
  for (int k = 0; k < 3; ++k) {
    const double reach =
        (std::abs(placed.axes(k, 0)) * placed.half_m[0] + std::abs(placed.axes(k, 1)) * placed.half_m[1]) +
        std::abs(placed.axes(k, 2)) * placed.half_m[2];
    const double own_m = (reach + off_m) * (1 + kFewSlack);
    const double wide_m = own_m + kFewSlack * (std::abs(placed.center[k]) + own_m) + kUnderflows;
    box.low[k] = placed.center[k] - wide_m;
    box.high[k] = placed.center[k] + wide_m;
  }
  return box;
}

}  // namespace

Aabb bounds_as_given(const Frame& frame, const Primitive& own) {
  if (const auto* box = std::get_if<Box>(&own)) {
    const double off_m = engine::placing_error_m(frame, own);
    if (off_m > 0) return bounds_of_turned(place(frame, *box), off_m);
  }
  const Aabb placed = bounds(place(frame, own));
  const Vec3 off = Vec3::Constant(std::holds_alternative<HalfSpace>(own) ? 0 : engine::placing_error_m(frame, own));
  return {.low = placed.low - off, .high = placed.high + off};
}

Aabb bounds_of(const ObjectInfo& info, const Frame& frame) {
  Aabb all;
  if (info.rare->parts) {
    all.extend(placed_bounds(frame, info.rare->parts->tree.bounds(), info.rare->parts->radius_m));
  } else {
    for (const Primitive& primitive : info.primitives) all.extend(bounds_as_given(frame, primitive));
  }
  if (info.mesh && !info.mesh->mesh->triangles.empty()) {
    all.extend(placed_bounds(frame, info.mesh->tree.bounds(), info.mesh->radius_m));
  }
  return all;
}

Aabb seen_from(const Frame& frame, const Aabb& world, double reach_m) {
  // Halves first: the sum of two finite corners may overflow.
  const Vec3 center = 0.5 * world.low + 0.5 * world.high;
  const Vec3 half = (world.high - center).cwiseMax(center - world.low);
  const Vec3 away = center - frame.position;
  const Mat3 back = frame.rotation.transpose();
  const Vec3 local = back * away;
  const double slack_m = placement_slack(frame, away.lpNorm<1>() + center.lpNorm<1>() + half.lpNorm<1>(), reach_m);
  const Vec3 local_half = back.cwiseAbs() * half + Vec3::Constant(slack_m);
  Aabb seen{.low = local - local_half, .high = local + local_half};
  // The placing overflowed: where the box lies is unknown, so everything is a candidate.
  if (!seen.low.allFinite() || !seen.high.allFinite()) {
    seen.low.setConstant(-std::numeric_limits<double>::infinity());
    seen.high.setConstant(std::numeric_limits<double>::infinity());
  }
  return seen;
}

void search_object(const Primitive& a, const GivenPart& given, const Placed& b, ContactSearch& touch, WalkCost& cost) {
  // Bounds cost more than many tests, so they are computed only if an index needs them.
  const Aabb near = b.info->rare->parts ? bounds_near(a, b.bounds) : Aabb{};
  visit_primitives_near(*b.info, b.frame, near, cost, [&](const Primitive& primitive) {
    const GivenPart given_b = b.given(primitive);
    search_parts(a, kNoTriangle, place(b.frame, primitive), kNoTriangle, touch, {given, given_b});
    return !touch.done();
  });
  if (!touch.done() && b.info->mesh) search_mesh(a, given, b, touch, cost);
}

bool search_boxes(const Box& a, const Box& b, double off_m, ContactSearch& touch) {
  // If placing rounds nothing, the general test is exact for the boxes as given.
  if (!(off_m > 0)) return false;
  const Decision quick =
      touch.wanted ? quick_contact(a, b, off_m, touch.contact) : kernel::quickly_overlaps(a, b, off_m);
  if (quick == Decision::undecided) return false;
  ++touch.exact_tests;
  touch.yes = quick == Decision::yes;
  return true;
}

namespace {

/// The object's shape, if it is a single one of this kind.
template <class Shape>
const Shape* only(const ObjectInfo& info) {
  return info.mesh || info.primitives.size() != 1 ? nullptr : std::get_if<Shape>(&info.primitives.front());
}

/// How far off the placing of an object of one bounded primitive may be.
double only_placing_error_m(const Placed& object) {
  return object.pose == nullptr ? 0 : placing_error_m(object.frame, object.info->primitives.front());
}

/// Searches two boxes that are not placed yet.
bool search_boxes(const Placed& a, const Placed& b, ContactSearch& touch) {
  const Box* own_a = only<Box>(*a.info);
  const Box* own_b = only<Box>(*b.info);
  if (own_a == nullptr || own_b == nullptr || touch.yes || touch.met != nullptr) return false;
  const double off_m = (only_placing_error_m(a) + only_placing_error_m(b)) * (1 + kBoundSlack);
  return off_m > 0 && search_boxes(place(a.frame, *own_a), place(b.frame, *own_b), off_m, touch);
}

/// Does what search_parts() does for two objects of one sphere each, without variants, if placing them rounds nothing.
/// False: it rounds, and nothing was changed.
bool search_balls(const Placed& a, const Placed& b, ContactSearch& touch) {
  const Sphere* own_a = only<Sphere>(*a.info);
  const Sphere* own_b = only<Sphere>(*b.info);
  if (own_a == nullptr || own_b == nullptr || touch.yes || touch.met != nullptr) return false;
  if (only_placing_error_m(a) > 0 || only_placing_error_m(b) > 0) return false;
  const Sphere ball_a = place(a.frame, *own_a);
  const Sphere ball_b = place(b.frame, *own_b);
  const ExactResult verdict = overlaps(ball_a, ball_b);
  ++touch.exact_tests;
  touch.level = std::max(touch.level, verdict.level);
  touch.undecided = touch.undecided || verdict.decision == Decision::undecided;
  touch.yes = verdict.yes();
  if (touch.yes && touch.wanted) touch.contact = contact(ball_a, ball_b);
  return true;
}

void search_in_place(const Placed& a, const Placed& b, ContactSearch& touch, WalkCost& cost) {
  if (search_boxes(a, b, touch) || search_balls(a, b, touch)) return;
  const Aabb near = a.info->rare->parts ? bounds_near(b, a.bounds) : Aabb{};
  visit_primitives_near(*a.info, a.frame, near, cost, [&](const Primitive& primitive) {
    search_object(place(a.frame, primitive), a.given(primitive), b, touch, cost);
    return !touch.done();
  });
  if (touch.done() || !a.info->mesh) return;
  search_mesh_primitives(a, b, touch, cost);
  if (!touch.done() && b.info->mesh) search_meshes(a, b, touch, cost);
}

}  // namespace

SeenPlaced::SeenPlaced(const Vec3& origin, const Placed& object) : placed_(object) {
  placed_.frame = seen_from(origin, object.frame);
  placed_.bounds = seen_from(origin, object.bounds);
  if (object.pose == nullptr) return;
  pose_ = seen_from(origin, *object.pose);
  placed_.pose = &pose_;
}

void search_objects(const Placed& a, const Placed& b, ContactSearch& touch, WalkCost& cost) {
  const Vec3 origin = common_origin(b.frame.position, {a.frame.position});
  // Pairs of overlapping triangles are wanted as placed in the world.
  if (origin.isZero(0) || touch.met != nullptr) return search_in_place(a, b, touch, cost);
  search_in_place(SeenPlaced(origin, a).placed(), SeenPlaced(origin, b).placed(), touch, cost);
  touch.move_back_from(origin);
}

}  // namespace collided::engine
