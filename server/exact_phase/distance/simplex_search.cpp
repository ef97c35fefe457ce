#include "server/exact_phase/distance/simplex_search.hpp"

#include "server/geometry/tolerance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace collided::engine::kernel {
namespace {

constexpr int kMostSteps = 128;

/// The nearest point so far: the corners that carry it, and their weights.
struct NearestOfSimplex {
  Vec3 point = Vec3::Zero();
  double distance2 = std::numeric_limits<double>::infinity();
  int corner[4] = {0, 0, 0, 0};
  double weight[4] = {0, 0, 0, 0};
  int count = 0;
};

void consider(NearestOfSimplex& best, const Vec3& point, std::initializer_list<std::pair<int, double>> parts) {
  const double distance2 = point.squaredNorm();
  if (!(distance2 < best.distance2)) return;
  best.point = point;
  best.distance2 = distance2;
  best.count = 0;
  for (const auto& [corner, weight] : parts) {
    best.corner[best.count] = corner;
    best.weight[best.count++] = weight;
  }
}

void consider_edge(NearestOfSimplex& best, const DifferencePoint* w, int i, int j) {
  const Vec3 edge = w[j].w - w[i].w;
  const double length2 = edge.squaredNorm();
  const double t = length2 > 0 ? -w[i].w.dot(edge) / length2 : 0;
  if (t > 0 && t < 1) consider(best, w[i].w + t * edge, {{i, 1 - t}, {j, t}});
}

void consider_face(NearestOfSimplex& best, const DifferencePoint* w, int i, int j, int k) {
  const Vec3& a = w[i].w;
  const Vec3 ab = w[j].w - a;
  const Vec3 ac = w[k].w - a;
  const Vec3 n = ab.cross(ac);
  const double nn = n.squaredNorm();
  if (!(nn > 0)) return;
  const double of_b = n.dot(ac.cross(a)) / nn;
  const double of_c = n.dot(a.cross(ab)) / nn;
  if (!(of_b > 0 && of_c > 0 && of_b + of_c < 1)) return;
  // A combination of the corners whatever the weights are; for a sliver the foot on the plane may be off it.
  consider(best, a + of_b * ab + of_c * ac, {{i, 1 - of_b - of_c}, {j, of_b}, {k, of_c}});
}

/// Every step comes nearer, so the newest corner, the last, is always part of the result.
NearestOfSimplex nearest_of(const DifferencePoint* w, int count) {
  NearestOfSimplex best;
  const int newest = count - 1;
  consider(best, w[newest].w, {{newest, 1.0}});
  for (int i = 0; i < newest; ++i) consider_edge(best, w, i, newest);
  for (int i = 0; i < newest; ++i) {
    for (int j = i + 1; j < newest; ++j) consider_face(best, w, i, j, newest);
  }
  return best;
}

/// The origin's weights in a tetrahedron; false if it is outside or on the border, or the tetrahedron is flat.
bool enclosed(const DifferencePoint* w, double* weight) {
  const Vec3 e[3] = {w[1].w - w[0].w, w[2].w - w[0].w, w[3].w - w[0].w};
  const double volume = e[0].dot(e[1].cross(e[2]));
  if (volume == 0) return false;
  const Vec3 to = -w[0].w;
  weight[1] = to.dot(e[1].cross(e[2])) / volume;
  weight[2] = e[0].dot(to.cross(e[2])) / volume;
  weight[3] = e[0].dot(e[1].cross(to)) / volume;
  weight[0] = 1 - weight[1] - weight[2] - weight[3];
  return std::all_of(weight, weight + 4, [](double part) { return part > 0; });
}

/// Drops the corners that do not carry the nearest point.
void keep(Proposal& proposal, const NearestOfSimplex& nearest) {
  DifferencePoint kept[4];
  for (int i = 0; i < nearest.count; ++i) {
    kept[i] = proposal.corner[nearest.corner[i]];
    proposal.weight[i] = nearest.weight[i];
  }
  std::copy(kept, kept + nearest.count, proposal.corner);
  proposal.count = nearest.count;
  proposal.nearest = nearest.point;
}

/// If a support point lies farther from the origin than this, the plane through it has the whole difference set behind
/// it, including balls and rounding.
double clearance_m(const Convex& a, const Convex& b) {
  const double size = a.reach_m + b.reach_m + (a.carrier[0] - b.carrier[0]).norm() +
                      a.carrier[0].cwiseAbs().maxCoeff() + b.carrier[0].cwiseAbs().maxCoeff();
  return (a.ball_m + b.ball_m + kSupportValueError * size + kDiscSeenFlat * (a.disc_m + b.disc_m)) *
         (1 + 16 * kRoundoff);
}

/// A point of the difference set nearer to the origin than this is covered by the balls, with more to spare than any
/// rounding.
double near_m(const Convex& a, const Convex& b) {
  const double size = a.reach_m + b.reach_m + (a.carrier[0] - b.carrier[0]).cwiseAbs().sum();
  return std::max(0.0, (a.ball_m + b.ball_m) * (1 - 32 * kRoundoff) - 2 * kSupportError * size);
}

}  // namespace

DifferencePoint difference_support(const Vec3& n, const Convex& a, const Convex& b) {
  DifferencePoint p;
  p.on_a = a.support(n);
  p.on_b = b.support(-n);
  p.w = (a.carrier[0] - b.carrier[0]) + (p.on_a - p.on_b);
  return p;
}

Vec3 Proposal::on_a() const {
  Vec3 point = Vec3::Zero();
  for (int i = 0; i < count; ++i) point += weight[i] * corner[i].on_a;
  return point;
}

Vec3 Proposal::on_b() const {
  Vec3 point = Vec3::Zero();
  for (int i = 0; i < count; ++i) point += weight[i] * corner[i].on_b;
  return point;
}

Proposal nearest_proposal(const Convex& a, const Convex& b, Seek seek) {
  Proposal proposal;
  Vec3 displacement = (a.carrier[0] - b.carrier[0]) + (a.middle() - b.middle());
  if (displacement.isZero(0)) displacement = Vec3::UnitX();
  proposal.corner[0] = difference_support(-displacement, a, b);
  proposal.count = 1;
  proposal.nearest = proposal.corner[0].w;
  const double clear2 = clearance_m(a, b) * clearance_m(a, b);
  const double near2 = near_m(a, b) * near_m(a, b);
  for (int step = 0; step < kMostSteps; ++step) {
    const double distance2 = proposal.nearest.squaredNorm();
    if (distance2 == 0 || (seek == Seek::plane && distance2 < near2)) return proposal;
    const DifferencePoint next = difference_support(-proposal.nearest, a, b);
    const double along = proposal.nearest.dot(next.w);
    if (seek == Seek::plane && along > 0 && along * along * (1 - 16 * kRoundoff) > clear2 * distance2) {
      proposal.parted = true;
      return proposal;
    }
    // The support bounds how much nearer any point of the set can be: stops when that is only rounding.
    if (distance2 - along <= 4 * kRoundoff * distance2) return proposal;
    const bool known = std::any_of(proposal.corner, proposal.corner + proposal.count,
                                   [&](const DifferencePoint& p) { return p.w == next.w; });
    if (known) return proposal;
    proposal.corner[proposal.count++] = next;
    double weight[4];
    if (proposal.count == 4 && enclosed(proposal.corner, weight)) {
      std::copy(weight, weight + 4, proposal.weight);
      proposal.encloses = true;
      proposal.nearest = Vec3::Zero();
      return proposal;
    }
    const NearestOfSimplex nearest = nearest_of(proposal.corner, proposal.count);
    if (!(nearest.distance2 < distance2)) {
      --proposal.count;
      return proposal;
    }
    keep(proposal, nearest);
  }
  return proposal;
}

}  // namespace collided::engine::kernel
