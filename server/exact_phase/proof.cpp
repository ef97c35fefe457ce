#include "server/exact_phase/proof.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <span>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/polytope_kernel.hpp"
#include "server/exact_phase/distance/simplex_search.hpp"
#include "server/exact_phase/part_convex.hpp"
#include "server/geometry/guess_tolerance.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

using kernel::CommonPoint;
using kernel::Convex;
using kernel::Vector;
using Mix = CommonPoint::Mix;

/// Appends the number as a sum of doubles, largest first. False if its digits leave the range of double: then nothing
/// is proved.
bool append_sum(Dyadic x, ExactSum& sum) {
  while (x.sign() != 0) {
    const auto [fraction, power] = x.split();
    // Products of the terms must stay in range too.
    if (!x.finite() || std::abs(power) > 900) return false;
    const double term = std::ldexp(fraction, static_cast<int>(power));
    sum.push_back(term);
    x = x - Dyadic(term);
  }
  if (sum.empty()) sum.push_back(0);
  return true;
}

/// A power of two that brings the number, and everything scaled with it, near 2^200. The checker squares products of
/// such numbers, and double has room for their low digits only if the numbers are large.
Dyadic scale_for(const Dyadic& x) {
  constexpr long kPower = 200;
  const long shift = kPower - x.split().second;
  return Dyadic(std::ldexp(1.0, static_cast<int>(std::clamp(shift, -900L, 900L))));
}

bool append_mix(const Mix& mix, ExactMix& sums) {
  Dyadic total;
  for (const auto& [corner, weight] : mix) total = total + weight;
  const Dyadic scale = scale_for(total);
  for (const auto& [corner, weight] : mix) {
    sums.emplace_back(corner, ExactSum());
    if (!append_sum(scale * weight, sums.back().second)) return false;
  }
  return true;
}

/// A candidate for a common point: point / divisor, with divisor > 0.
struct PointCandidate {
  Vector<Dyadic> point;
  Dyadic divisor{1.0};
};

Vector<Dyadic> at(const Vec3& p) { return Vector<Dyadic>(p); }

bool is_flat_hull(const ConvexPart& part, const Convex& set) {
  return set.hull != nullptr || std::holds_alternative<Triangle>(part);
}

/// The mix of the part's points on which the candidate's remainder (ball, disc, box or ellipsoid) is placed; nothing if
/// none is known.
std::optional<Mix> mix_beside(const ConvexPart& part, const Convex& set, const PointCandidate& c) {
  const Mix whole{{0, Dyadic(1.0)}};
  if (set.disc_m > 0 || (std::holds_alternative<Primitive>(part) && set.plus == Convex::Plus::nothing &&
                         set.count() == 2 && set.ball_m == 0)) {
    // The exact foot on the axis: its weights are numerators over one common denominator.
    const Vector<Dyadic> d = at(set.carrier[1]) - at(set.carrier[0]);
    const Dyadic along = dot(c.point - c.divisor * at(set.carrier[0]), d);
    const Dyadic rest = c.divisor * square(d) - along;
    if (along.sign() < 0 || rest.sign() < 0) return std::nullopt;
    return Mix{{0, rest}, {1, along}};
  }
  if (set.plus != Convex::Plus::nothing || set.count() == 1) return whole;
  const auto plain_of = [&](const Dyadic& x) {
    const auto [top, top_power] = x.split();
    const auto [bottom, bottom_power] = c.divisor.split();
    return top == 0 ? 0.0
                    : std::ldexp(top / bottom, static_cast<int>(std::clamp(top_power - bottom_power, -2000L, 2000L)));
  };
  const Vec3 rounded(plain_of(c.point.x), plain_of(c.point.y), plain_of(c.point.z));
  if (!is_flat_hull(part, set)) {
    // A capsule: its ball covers the rounding of the foot.
    const Vec3 d = set.carrier[1] - set.carrier[0];
    const double t =
        std::clamp((rounded - set.carrier[0]).dot(d) / std::max(d.squaredNorm(), kVanishingSquare), 0.0, 1.0);
    return Mix{{0, Dyadic(1.0) - Dyadic(t)}, {1, Dyadic(t)}};
  }
  // Hulls are searched only for points that are doubles themselves.
  const std::optional<CommonPoint> held = common_point(set, Convex(Sphere{rounded, 0}));
  if (!held) return std::nullopt;
  return held->mix_a;
}

/// Uses the formulas of certificate.hpp's checker with another number type.
bool holds(const ConvexPart& part, const Convex& set, const PointCandidate& c, const Mix& mix) {
  if (const HalfSpace* ground = half_space_of(part)) {
    return dot(at(ground->normal), c.point - c.divisor * at(ground->point)).sign() <= 0;
  }
  Dyadic total;
  Dyadic of_discs;
  Vector<Dyadic> summand = at(Vec3::Zero());
  for (const auto& [corner, weight] : mix) {
    if (weight.sign() < 0) return false;
    total = total + weight;
    if (static_cast<int>(corner) >= set.first_disc) of_discs = of_discs + weight;
    summand = summand - weight * at(set.point(static_cast<int>(corner)));
  }
  if (total.sign() <= 0) return false;
  summand = c.divisor * summand + total * c.point;
  const Dyadic scale = total * c.divisor;
  const auto at_most_square = [](const Dyadic& square_of, const Dyadic& root) {
    return (square_of - root * root).sign() <= 0;
  };
  if (set.plus != Convex::Plus::nothing) {
    const Vector<Dyadic> axis[3] = {at(set.axes.col(0)), at(set.axes.col(1)), at(set.axes.col(2))};
    const Dyadic volume = dot(axis[0], cross(axis[1], axis[2]));
    if (volume.sign() == 0) return false;
    Dyadic squares;
    for (int k = 0; k < 3; ++k) {
      const Dyadic along = dot(summand, cross(axis[(k + 1) % 3], axis[(k + 2) % 3]));
      if (set.plus == Convex::Plus::box && !at_most_square(along * along, Dyadic(set.half_m[k]) * volume * scale))
        return false;
      const Dyadic part_of = along * Dyadic(set.half_m[(k + 1) % 3]) * Dyadic(set.half_m[(k + 2) % 3]);
      squares = squares + part_of * part_of;
    }
    const Dyadic halves = Dyadic(set.half_m[0]) * Dyadic(set.half_m[1]) * Dyadic(set.half_m[2]);
    return set.plus == Convex::Plus::box || at_most_square(squares, halves * volume * scale);
  }
  if (set.disc_m > 0) {
    const bool is_across = dot(summand, at(set.carrier[1]) - at(set.carrier[0])).sign() == 0;
    return is_across && at_most_square(square(summand), Dyadic(set.disc_m) * of_discs * c.divisor);
  }
  return at_most_square(square(summand), Dyadic(set.ball_m) * scale);
}

/// The exponent of the lowest set bit among the numbers.
long lowest_bit(std::span<const double> numbers) {
  long lowest = 2000;
  for (const double x : numbers) {
    int power = 0;
    auto digits = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &power), 53));
    if (digits == 0) continue;
    lowest = std::min(lowest, static_cast<long>(power) - 53 + std::countr_zero(static_cast<std::uint64_t>(digits)));
  }
  return lowest;
}

template <class Matrix>
long lowest_bit_of(const Matrix& numbers) {
  return lowest_bit({numbers.data(), static_cast<std::size_t>(numbers.size())});
}

/// True if a checker stays within the range of double while it tests that the part holds the point: tests the lowest
/// bits of the products in `holds` above, one factor of which is the difference of the point and its mix.
bool can_be_read(const Convex& set, const Proof& proof, const ExactMix& mix) {
  constexpr long kLowest = -950;
  long of_mix = 2000;
  for (const auto& [corner, weight] : mix) of_mix = std::min(of_mix, lowest_bit(weight));
  long of_points = 2000;
  for (int i = 0; i < set.count(); ++i) of_points = std::min(of_points, lowest_bit_of(set.point(i)));
  long of_x = 2000;
  for (const ExactSum& x : proof.point) of_x = std::min(of_x, lowest_bit(x));
  const long of_divisor = lowest_bit(proof.divisor);
  const long displacement = of_mix + std::min(of_x, of_divisor + of_points);
  const double sizes[] = {set.ball_m, set.disc_m};
  const long radius = of_mix + of_divisor + lowest_bit(sizes);
  if (set.plus == Convex::Plus::nothing)
    return (set.ball_m > 0 || set.disc_m > 0 ? 2 * std::min(displacement, radius) : displacement) > kLowest;
  const long axes = lowest_bit_of(set.axes);
  const long halves = lowest_bit_of(set.half_m);
  const bool is_box = set.plus == Convex::Plus::box;
  const long along = displacement + 2 * axes + (is_box ? 0 : 2 * halves);
  const long volume = of_mix + of_divisor + 3 * axes + (is_box ? 1 : 3) * halves;
  return 2 * std::min(along, volume) > kLowest;
}

bool fill(const ConvexPart& a, const ConvexPart& b, const PointCandidate& c, const Mix& mix_a, const Mix& mix_b,
          Proof& proof) {
  if (!holds(a, convex_of(a), c, mix_a) || !holds(b, convex_of(b), c, mix_b)) return false;
  proof.touches = true;
  const Dyadic scale = scale_for(c.divisor);
  const Dyadic* coordinates[3] = {&c.point.x, &c.point.y, &c.point.z};
  for (int k = 0; k < 3; ++k) {
    proof.point[k].clear();
    if (!append_sum(scale * *coordinates[k], proof.point[k])) return false;
  }
  proof.divisor.clear();
  proof.mix_a.clear();
  proof.mix_b.clear();
  return append_sum(scale * c.divisor, proof.divisor) && append_mix(mix_a, proof.mix_a) &&
         append_mix(mix_b, proof.mix_b) && can_be_read(convex_of(a), proof, proof.mix_a) &&
         can_be_read(convex_of(b), proof, proof.mix_b);
}

/// A box is given by its centre, not its corners, so a mix of corners is written as the centre alone.
Mix of_points(const Convex& set, Mix mix) {
  return set.plus == Convex::Plus::box ? Mix{{0, Dyadic(1.0)}} : std::move(mix);
}

/// Tries a point of the triangle near the hint, with weights that are doubles.
bool on_triangle(const ConvexPart& a, const ConvexPart& b, const Triangle& triangle, const Vec3& hint, bool is_a,
                 Proof& proof) {
  const Vec3 foot = closest(hint, triangle).point;
  const Vec3 u = triangle.b - triangle.a;
  const Vec3 v = triangle.c - triangle.a;
  const Vec3 n = u.cross(v);
  const double nn = std::max(n.squaredNorm(), kVanishingSquare);
  const double of_b = std::clamp(n.dot((foot - triangle.a).cross(v)) / nn, 0.0, 1.0);
  const double of_c = std::clamp(n.dot(u.cross(foot - triangle.a)) / nn, 0.0, 1.0 - of_b);
  const Mix mix{{0, Dyadic(std::max(0.0, 1 - of_b - of_c))}, {1, Dyadic(of_b)}, {2, Dyadic(of_c)}};
  PointCandidate c{at(Vec3::Zero()), Dyadic()};
  const Vec3 corner[3] = {triangle.a, triangle.b, triangle.c};
  for (const auto& [i, weight] : mix) {
    c.point = c.point + weight * at(corner[i]);
    c.divisor = c.divisor + weight;
  }
  if (c.divisor.sign() <= 0) return false;
  const ConvexPart& other = is_a ? b : a;
  const std::optional<Mix> summand = mix_beside(other, convex_of(other), c);
  if (!summand) return false;
  return is_a ? fill(a, b, c, mix, *summand, proof) : fill(a, b, c, *summand, mix, proof);
}

/// Tries one candidate point.
bool at_point(const ConvexPart& a, const ConvexPart& b, const PointCandidate& c, Proof& proof) {
  const std::optional<Mix> mix_a = mix_beside(a, convex_of(a), c);
  if (!mix_a) return false;
  const std::optional<Mix> mix_b = mix_beside(b, convex_of(b), c);
  return mix_b && fill(a, b, c, *mix_a, *mix_b, proof);
}

/// Tries points of a solid that lie deepest behind a plane: corners, then points of its ball.
bool deepest_in(const HalfSpace& ground, const ConvexPart& a, const ConvexPart& b, const ConvexPart& solid,
                Proof& proof) {
  const Convex set = convex_of(solid);
  std::vector<PointCandidate> candidates;
  for (int i = 0; i < set.count(); ++i) candidates.push_back({at(set.point(i))});
  if (set.plus != Convex::Plus::nothing) candidates.push_back({at(set.carrier[0] + set.support(-ground.normal))});
  if (set.plus == Convex::Plus::box) {
    PointCandidate corner{at(set.carrier[0])};
    for (int k = 0; k < 3; ++k) {
      const Vec3 axis = set.axes.col(k);
      const Dyadic reach(ground.normal.dot(axis) > 0 ? -set.half_m[k] : set.half_m[k]);
      corner.point = corner.point + reach * at(axis);
    }
    candidates.push_back(corner);
  }
  if (set.ball_m > 0) {
    for (int i = 0; i < set.carrier_count; ++i) {
      const Vec3 out = ground.normal.normalized();
      candidates.push_back({at(set.point(i) - set.ball_m * (1 - kFewSlack) * out)});
      candidates.push_back({at(set.point(i) - set.ball_m * out)});
    }
  }
  return std::any_of(candidates.begin(), candidates.end(),
                     [&](const PointCandidate& c) { return at_point(a, b, c, proof); });
}

/// A part shrunk towards a point inside it.
class DrawnIn {
 public:
  DrawnIn(const Convex& whole, double share) : set_(whole) {
    if (whole.hull != nullptr) {
      draw_hull(*whole.hull, share);
      return;
    }
    Vec3 middle = Vec3::Zero();
    for (int i = 0; i < set_.carrier_count; ++i) middle += set_.carrier[i] / set_.carrier_count;
    for (int i = 0; i < set_.carrier_count; ++i) set_.carrier[i] += share * (middle - set_.carrier[i]);
    set_.half_m *= 1 - share;
    set_.ball_m *= 1 - share;
    set_.disc_m *= 1 - share;
  }
  const Convex& set() const { return set_; }

 private:
  void draw_hull(const Hull& whole, double share) {
    auto mesh = std::make_shared<TriangleMesh>(*whole.mesh);
    Vec3 middle = Vec3::Zero();
    for (const Vec3& vertex : mesh->vertices) middle += vertex / static_cast<double>(mesh->vertices.size());
    for (Vec3& vertex : mesh->vertices) vertex += share * (middle - vertex);
    hull_ = std::make_unique<Hull>(Hull{std::move(mesh), whole.rotation, whole.position});
    set_ = Convex(*hull_);
  }

  std::unique_ptr<Hull> hull_;
  Convex set_;
};

void append_nearest(const Convex& a, const Convex& b, std::vector<Vec3>& points) {
  const kernel::Proposal proposal = kernel::nearest_proposal(a, b, kernel::Seek::distance);
  const Vec3 near_a = a.carrier[0] + proposal.on_a();
  const Vec3 near_b = b.carrier[0] + proposal.on_b();
  // Between the nearest points of the two without their balls: the middle of what both balls cover.
  const double apart_m = (near_b - near_a).stableNorm();
  const Vec3 displacement = apart_m > 0 ? Vec3((near_b - near_a) / apart_m) : Vec3(Vec3::Zero());
  points.insert(points.end(), {near_a, near_b, near_a / 2 + near_b / 2,
                               near_a + (a.ball_m + (apart_m - b.ball_m)) / 2 * displacement});
}

/// Points that both sets may hold: the nearest points of the two, and of both shrunk, which lie off the surfaces if the
/// sets share more than a point.
std::vector<Vec3> likely_points(const Convex& a, const Convex& b) {
  std::vector<Vec3> points;
  constexpr double kDrawnIn[] = {0x1p-5, 0x1p-10, 0x1p-20, 0x1p-40, 0.0};
  for (const double share : kDrawnIn) { append_nearest(DrawnIn(a, share).set(), DrawnIn(b, share).set(), points); }
  return points;
}

}  // namespace

Vec3 support_of(const ConvexPart& part, const Vec3& n) {
  const Convex set = convex_of(part);
  return set.carrier[0] + set.support(n) + set.ball_m * n.stableNormalized();
}

PartNumbers numbers_of(const ConvexPart& part) {
  using Summand = PartNumbers::Summand;
  const Convex set = convex_of(part);
  PartNumbers numbers;
  numbers.radius_m = set.disc_m > 0 ? set.disc_m : set.ball_m;
  numbers.tapers = set.first_disc > 0;
  numbers.axes = set.axes;
  numbers.half_m = set.half_m;
  for (int i = 0; i < set.count(); ++i) numbers.points.push_back(set.point(i));
  if (const HalfSpace* ground = half_space_of(part)) {
    numbers.summand = Summand::half_space;
    numbers.axes.col(0) = ground->normal;
  } else if (set.plus != Convex::Plus::nothing) {
    numbers.summand = set.plus == Convex::Plus::box ? Summand::box : Summand::ellipsoid;
  } else if (set.disc_m > 0) {
    numbers.summand = Summand::disc;
  } else if (set.ball_m > 0) {
    numbers.summand = Summand::ball;
  }
  return numbers;
}

bool prove_touching(const ConvexPart& a, const ConvexPart& b, const Vec3& hint, Proof& proof) {
  if (at_point(a, b, {at(hint)}, proof)) return true;
  const HalfSpace* ground_a = half_space_of(a);
  const HalfSpace* ground_b = half_space_of(b);
  if (ground_a != nullptr && ground_b != nullptr) return false;
  if (ground_a != nullptr) return deepest_in(*ground_a, a, b, b, proof);
  if (ground_b != nullptr) return deepest_in(*ground_b, a, b, a, proof);
  const Convex set_a = convex_of(a);
  const Convex set_b = convex_of(b);
  const std::vector<Vec3> likely = likely_points(set_a, set_b);
  const auto is_common = [&](const Vec3& point) { return at_point(a, b, {at(point)}, proof); };
  if (std::any_of(likely.begin(), likely.end(), is_common)) return true;
  // A triangle has no interior: the point must lie exactly on it.
  const auto is_on_it = [&](const Vec3& point) {
    if (const auto* triangle = std::get_if<Triangle>(&a)) return on_triangle(a, b, *triangle, point, true, proof);
    if (const auto* triangle = std::get_if<Triangle>(&b)) return on_triangle(a, b, *triangle, point, false, proof);
    return false;
  };
  if (is_on_it(hint) || std::any_of(likely.begin(), likely.end(), is_on_it)) return true;
  // Last, because its numbers are long.
  if (!set_a.is_polytope() || !set_b.is_polytope()) return false;
  std::optional<CommonPoint> common = common_point(set_a, set_b);
  if (!common) return false;
  return fill(a, b, {common->point, common->divisor}, of_points(set_a, std::move(common->mix_a)),
              of_points(set_b, std::move(common->mix_b)), proof);
}

bool is_beyond(const ConvexPart& part, const Vec3& normal, const Vec3& point, int side, bool strictly) {
  if (const HalfSpace* ground = half_space_of(part)) {
    const Vector<Dyadic> turn = cross(at(normal), at(ground->normal));
    const bool is_parallel = turn.x.sign() == 0 && turn.y.sign() == 0 && turn.z.sign() == 0;
    if (!is_parallel || side * normal.dot(ground->normal) <= 0) return false;
    const int reach = side * dot(at(normal), at(ground->point) - at(point)).sign();
    return strictly ? reach < 0 : reach <= 0;
  }
  const Convex set = convex_of(part);
  if (kernel::reach_value(set, normal, side, point).high() < 0) return true;
  const kernel::ReachAlong<Dyadic> reach = kernel::reach_along<Dyadic>(set, normal, side, point);
  for (int i = 0; i < reach.count; ++i) {
    const kernel::ReachPart<Dyadic>& r = reach.part[i];
    const int room = (r.rational * r.rational * r.denominator - r.numerator).sign();
    const bool ok = strictly ? r.rational.sign() < 0 && room > 0 : r.rational.sign() <= 0 && room >= 0;
    if (!ok) return false;
  }
  return true;
}

}  // namespace collided::engine
