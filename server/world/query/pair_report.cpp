#include "server/world/query/pair_report.hpp"

#include <algorithm>
#include <tuple>

#include "server/exact_phase/distance/triangle_depth.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/world/objects/object_placing.hpp"
#include "server/world/query/pair_object.hpp"

namespace collided::engine {
namespace {

Decision decision_of(const ContactSearch& touch) {
  if (touch.yes) return Decision::yes;
  return touch.undecided ? Decision::undecided : Decision::no;
}

/// Visits the overlapping pairs of triangles as parts, like visit_part_pairs(); visit returns false to end.
void visit_met(const Placed& a, const Placed& b, const TrianglePairs& met, const PartPairVisit& visit) {
  PlacedTriangles all_of_a(*a.info->mesh->mesh, a.frame);
  PlacedTriangles all_of_b(*b.info->mesh->mesh, b.frame);
  for (const auto& [of_a, of_b] : met) {
    if (!visit({all_of_a.at(of_a), of_a}, {all_of_b.at(of_b), of_b})) return;
  }
}

/// All pairs of triangles that share a point, if they are too many to be kept or one of the two has other parts too.
TrianglePairs met_triangles(const Placed& a, const Placed& b, WalkCost& cost, Deadline& deadline) {
  TrianglePairs pairs;
  const auto visit = [&](const PlacedPart& of_a, const PlacedPart& of_b) {
    const bool two_triangles = of_a.triangle != kNoTriangle && of_b.triangle != kNoTriangle;
    if (two_triangles && overlaps(of_a.part, of_b.part).yes()) pairs.emplace_back(of_a.triangle, of_b.triangle);
    return !deadline.is_over();
  };
  visit_part_pairs(a, b, 0, visit, cost);
  return pairs;
}

/// Reports what pairs of triangles share; counts all, keeps the first in order.
void tell_crossings(const Placed& a, const Placed& b, TrianglePairs pairs, std::uint32_t most, PairReport& report,
                    Deadline& deadline) {
  std::sort(pairs.begin(), pairs.end());
  // A split that clips triangles may produce a pair twice.
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  report.crossing_count = pairs.size();
  pairs.resize(std::min<std::size_t>(pairs.size(), most));
  report.crossings.reserve(pairs.size());
  visit_met(a, b, pairs, [&](const PlacedPart& of_a, const PlacedPart& of_b) {
    report.crossings.push_back(
        {of_a.triangle, of_b.triangle, crossing(std::get<Triangle>(of_a.part), std::get<Triangle>(of_b.part))});
    return !deadline.is_over();
  });
}

PairReport late() {
  PairReport report;
  report.touches = Decision::undecided;
  report.is_late = true;
  report.no_proof = "the deadline was over";
  return report;
}

PairReport report_in_order(const PairObject& first, const PairObject& second, const PairAsk& ask, Deadline& deadline) {
  const Placed& a = first.placed;
  const Placed& b = second.placed;
  PairReport report;
  report.is_stale = first.is_stale || second.is_stale;
  WalkCost cost;
  const bool are_meshes = is_bare_mesh(*a.info) && is_bare_mesh(*b.info);
  TrianglePairs met;
  ContactSearch touch;
  touch.deadline = &deadline;
  if (are_meshes) touch.met = &met;
  search_objects(a, b, touch, cost);
  if (deadline.was_over()) return late();
  report.touches = decision_of(touch);
  if (report.is_stale && report.touches == Decision::no && overlaps(first.reach, second.reach))
    report.touches = Decision::undecided;
  if (touch.yes) {
    report.contact = touch.contact;
    report.contact.depth_error_m += placing_error_m(a, touch.a_triangle, b, touch.b_triangle);
    report.a_triangle = touch.a_triangle;
    report.b_triangle = touch.b_triangle;
    report.manifold = manifold_of(a, b, touch.contact, touch.met, cost, deadline);
    if (ask.triangles && a.info->mesh && b.info->mesh) {
      if (touch.met == nullptr) met = met_triangles(a, b, cost, deadline);
      tell_crossings(a, b, std::move(met), ask.most_crossings, report, deadline);
    }
  } else if (report.touches == Decision::no) {
    report.separation = distance_between(a, b, cost, deadline);
    const double placing_m = placing_error_m(a, kNoTriangle, b, kNoTriangle);
    report.separation.error_m += placing_m;
    report.separation.point_error_m += placing_m;
    report.contained = containment(a, b, deadline);
    if (!deadline.was_over()) report.within = contact_of_contained(a, b, report.contained);
  }
  if (deadline.was_over()) return late();
  if (!ask.certificate) return report;
  if (report.touches == Decision::undecided) report.no_proof = "the answer is undecided";
  else report.proof = proof_of(a, b, touch.yes, report.no_proof, cost);
  return report;
}

/// The same report with the two objects exchanged.
void turn_round(PairReport& report) {
  report.contact.normal = -report.contact.normal;
  std::swap(report.a_triangle, report.b_triangle);
  for (ManifoldPoint& point : report.manifold) std::swap(point.a_triangle, point.b_triangle);
  std::swap(report.separation.on_a, report.separation.on_b);
  report.separation.normal = -report.separation.normal;
  report.contained = turned_round(report.contained);
  if (report.within) report.within->normal = -report.within->normal;
  for (TriangleCrossing& crossing : report.crossings) std::swap(crossing.a, crossing.b);
  std::sort(report.crossings.begin(), report.crossings.end(), [](const TriangleCrossing& x, const TriangleCrossing& y) {
    return std::tie(x.a, x.b) < std::tie(y.a, y.b);
  });
}

}  // namespace

/// Decides in the order of the objects' names, so that the answer depends neither on the order of the request nor on
/// the order in which a server received the objects. Only the proof keeps the request's order.
PairReport report_pair(const Snapshot& snapshot, ObjectId a, ObjectId b, const PairAsk& ask) {
  const OwnFloatEnvironment own_floats;
  const auto order = [&](ObjectId id) { return std::tie(snapshot.objects[slot_of(id)]->name, id); };
  const bool turned = order(b) < order(a);
  Deadline deadline(ask.deadline_ns, ask.called_off);
  const PairObject first(snapshot, turned ? b : a, deadline);
  const PairObject second(snapshot, turned ? a : b, deadline);
  if (deadline.is_over()) return late();
  PairAsk without_proof = ask;
  without_proof.certificate = ask.certificate && !turned;
  PairReport report = report_in_order(first, second, without_proof, deadline);
  if (!turned || report.is_late) return report;
  turn_round(report);
  if (ask.certificate && report.touches != Decision::undecided) {
    WalkCost cost;
    report.proof = proof_of(second.placed, first.placed, report.touches == Decision::yes, report.no_proof, cost);
  }
  return report;
}

namespace {

/// Parts whose normals differ by more than 26 degrees are corners and edges of surfaces in contact elsewhere.
constexpr double kSameWay = 0.9;

/// True if that is known without the contact of the two, as for most triangles of two bodies deep in each other.
bool surely_points_elsewhere(const ConvexPart& a, const ConvexPart& b, const Vec3& normal) {
  const auto* triangle_a = std::get_if<Triangle>(&a);
  const auto* triangle_b = std::get_if<Triangle>(&b);
  if (triangle_a == nullptr || triangle_b == nullptr) return false;
  const std::optional<Vec3> quick = kernel::sure_normal(*triangle_a, *triangle_b);
  return quick && quick->dot(normal) < kSameWay - 4 * kernel::kSureNormal;
}

}  // namespace

std::vector<ManifoldPoint> manifold_of(const Placed& a, const Placed& b, const Contact& contact,
                                       const TrianglePairs* met, WalkCost& cost, Deadline& deadline) {
  std::vector<ManifoldPoint> points;
  const auto add = [&](const PlacedPart& of_a, const PlacedPart& of_b) {
    if (deadline.is_over()) return false;
    if (surely_points_elsewhere(of_a.part, of_b.part, contact.normal)) return true;
    const Contact here = engine::contact(of_a.part, of_b.part);
    if (here.normal.dot(contact.normal) < kSameWay) return true;
    const std::size_t before = points.size();
    append_manifold(of_a.part, of_b.part, here, contact.normal, points);
    for (std::size_t i = before; i < points.size(); ++i) {
      points[i].a_triangle = of_a.triangle;
      points[i].b_triangle = of_b.triangle;
    }
    return true;
  };
  const auto add_met = [&](const PlacedPart& of_a, const PlacedPart& of_b) {
    return overlaps(of_a.part, of_b.part).yes() ? add(of_a, of_b) : !deadline.is_over();
  };
  if (met != nullptr) visit_met(a, b, *met, add);
  else visit_part_pairs(a, b, 0, add_met, cost);
  keep_extremes(contact.normal, points);
  return points;
}

}  // namespace collided::engine
