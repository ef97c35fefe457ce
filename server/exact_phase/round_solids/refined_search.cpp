#include "server/exact_phase/round_solids/refined_search.hpp"

#include "server/exact_phase/arithmetic/long_float.hpp"
#include "server/exact_phase/distance/simplex_faces.hpp"
#include "server/exact_phase/round_solids/round_pair.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {
namespace {

using Kind = ExactSolid::Kind;
using Point = Vector<Dyadic>;
using LongPoint = Vector<LongFloat>;

LongPoint cut(const Point& p) { return {LongFloat(p.x), LongFloat(p.y), LongFloat(p.z)}; }
Point exact(const LongPoint& p) { return {p.x.exact(), p.y.exact(), p.z.exact()}; }
bool is_zero(const LongFloat& x) { return x.sign() == 0; }

/// A set in 256 bits, relative to a place nearby.
class Supported {
 public:
  Supported(const ExactSolid& set, const Point& from) : set_(set), radius_(set.radius) {
    for (const Point& point : set.points) points_.push_back(cut(point - from));
    for (std::size_t i = 0; i < 3; ++i) half_[i] = cut(set.half[i]);
    if (set.kind == Kind::axial) axis_ = cut(set.axis());
  }

  /// Approximate farthest point along n, which must not be zero.
  LongPoint farthest(const LongPoint& n) const {
    switch (set_.kind) {
      case Kind::axial: return of_axial(n);
      case Kind::ellipsoid: return of_ellipsoid(n);
      default: break;
    }
    const LongPoint& corner = farthest_point(n);
    return is_zero(radius_) ? corner : corner + radius_ / sqrt(square(n)) * n;
  }

  /// A point inside, unless the set is flat: the mean of its points, for a cone nearer to the base.
  LongPoint middle() const {
    LongPoint sum = set_.tapers() ? points_[1] : LongPoint(Vec3(Vec3::Zero()));
    for (const LongPoint& point : points_) sum = sum + point;
    return LongFloat(1.0) / LongFloat(static_cast<double>(points_.size() + (set_.tapers() ? 1 : 0))) * sum;
  }

 private:
  const LongPoint& farthest_point(const LongPoint& n) const {
    const LongPoint* best = &points_[0];
    for (const LongPoint& point : points_) {
      if (dot(n, point - *best).sign() > 0) best = &point;
    }
    return *best;
  }
  LongPoint of_axial(const LongPoint& n) const {
    const LongPoint across = square(axis_) * n - dot(axis_, n) * axis_;
    const LongFloat across2 = square(across);
    // Along the axis, up to the 256 bits of the difference, the whole disc is equally far.
    const LongFloat whole2 = square(axis_) * square(axis_) * square(n);
    const bool is_along = (across2 - LongFloat(kDiscSeenFlatInLong) * whole2).sign() <= 0;
    const LongPoint to_rim = is_along ? LongPoint(Vec3(Vec3::Zero())) : radius_ / sqrt(across2) * across;
    if (!set_.tapers()) return farthest_point(n) + to_rim;
    const LongPoint rim = points_[1] + to_rim;
    return dot(n, rim - points_[0]).sign() > 0 ? rim : points_[0];
  }
  LongPoint of_ellipsoid(const LongPoint& n) const {
    LongFloat reach2;
    LongPoint sum{Vec3(Vec3::Zero())};
    for (const LongPoint& half : half_) {
      const LongFloat along = dot(half, n);
      reach2 = reach2 + along * along;
      sum = sum + along * half;
    }
    return is_zero(reach2) ? points_[0] : points_[0] + LongFloat(1.0) / sqrt(reach2) * sum;
  }

  const ExactSolid& set_;
  LongFloat radius_;
  std::vector<LongPoint> points_;
  std::array<LongPoint, 3> half_;
  LongPoint axis_;
};

/// The search of Gilbert, Johnson, Keerthi 1988, which comes nearer to the origin of the difference set with each step.
class RefinedSearch {
 public:
  RefinedSearch(const ExactSolid& a, const ExactSolid& b)
      : a_(a), b_(b), from_(a.points[0]), near_a_(a, from_), near_b_(b, from_) {}

  Decision run() {
    const Decision found = from_all_sides();
    if (found != Decision::undecided) return found;
    return touch_upright(a_, b_) || touch_upright(b_, a_) ? Decision::yes : Decision::undecided;
  }

 private:
  static constexpr int kMostSteps = 400;

  /// One search may find a point on the borders of both sets; the middle of several such points is within.
  Decision from_all_sides() {
    LongPoint sum{Vec3(Vec3::Zero())};
    for (int i = 0; i < 6; ++i) {
      std::optional<LongPoint> common;
      const Decision one = from_side(LongPoint(Vec3((i < 3 ? 1 : -1) * Vec3::Unit(i % 3))), common);
      if (one != Decision::undecided || !common) return one;
      sum = sum + *common;
      if (i > 0 && holds_near(LongFloat(1.0) / LongFloat(i + 1.0) * sum)) return Decision::yes;
    }
    return Decision::undecided;
  }
  /// Objects that stand, lie or are stacked touch directly above, below or beside an end of an axis: then one of these
  /// points of a set, or one of an ellipsoid's poles, is in the other. A search approaches such a touch only to the
  /// root of its precision.
  static bool touch_upright(const ExactSolid& set, const ExactSolid& other) {
    for (const Point& end : set.points) {
      for (int i = 0; i < 6; ++i) {
        const Dyadic side(i < 3 ? 1.0 : -1.0);
        const Point along = set.kind == Kind::ellipsoid ? set.half[static_cast<std::size_t>(i % 3)]
                                                        : set.radius * Point(Vec3(Vec3::Unit(i % 3)));
        const Point at = end + side * along;
        if (holds_point(set, at) == Decision::yes && holds_point(other, at) == Decision::yes) return true;
      }
    }
    return false;
  }

  void add(const LongPoint& n) {
    of_a_.push_back(near_a_.farthest(n));
    const LongPoint of_b = near_b_.farthest(-n);
    simplex_.push_back({of_a_.back() - of_b, of_a_.size() - 1, of_a_.size() - 1});
  }
  /// common  if no point is certainly in both sets: one that is, up to rounding
  Decision from_side(const LongPoint& n, std::optional<LongPoint>& common) {
    simplex_.clear();
    add(n);
    const LongFloat size2 = square(simplex_[0].w) + LongFloat(a_.radius) * LongFloat(a_.radius);
    const LongFloat finest2 = LongFloat(kFinestGap) * LongFloat(kFinestGap) * size2;
    Foot<LongFloat> foot;
    for (int step = 0; step < kMostSteps && nearest_of(simplex_, foot); ++step) {
      const LongFloat level = square(foot.sum);
      if (foot.corners.size() == 4 || (level - finest2 * foot.total * foot.total).sign() <= 0) {
        common = common_point(foot);
        return holds_near(*common) ? Decision::yes : Decision::undecided;
      }
      simplex_ = foot.corners;
      add(-foot.sum);
      if (dot(foot.sum, simplex_.back().w).sign() > 0)
        return parted_along(exact(-foot.sum), a_, b_) == Decision::yes ? Decision::no : Decision::undecided;
    }
    return Decision::undecided;
  }
  /// The point of a that the foot represents, which is near one of b.
  LongPoint common_point(const Foot<LongFloat>& foot) const {
    LongPoint sum{Vec3(Vec3::Zero())};
    for (std::size_t i = 0; i < foot.corners.size(); ++i) sum = sum + foot.weights[i] * of_a_[foot.corners[i].of_a];
    return LongFloat(1.0) / foot.total * sum;
  }
  /// True if both sets contain the point, as it is or slightly nearer to the middle of one, the other or both: on a
  /// border, the last of 256 bits puts it outside.
  bool holds_near(const LongPoint& point) const {
    const LongFloat hair(kInward);
    const LongPoint to_a = hair * (near_a_.middle() - point);
    const LongPoint to_b = hair * (near_b_.middle() - point);
    for (const LongPoint& tried : {point, point + to_a, point + to_b, point + to_a + to_b}) {
      const Point at = from_ + exact(tried);
      if (holds_point(a_, at) == Decision::yes && holds_point(b_, at) == Decision::yes) return true;
    }
    return false;
  }

  const ExactSolid& a_;
  const ExactSolid& b_;
  const Point from_;
  Supported near_a_;
  Supported near_b_;
  std::vector<LongPoint> of_a_;
  std::vector<MinkowskiVertex<LongFloat>> simplex_;
};

}  // namespace

Decision refined_meet(const ExactSolid& a, const ExactSolid& b) {
  for (const ExactSolid* set : {&a, &b}) {
    if (!set->radius.finite()) return Decision::undecided;
    for (const Point& point : set->points) {
      if (!square(point).finite()) return Decision::undecided;
    }
  }
  return RefinedSearch(a, b).run();
}

}  // namespace collided::engine::kernel
