#include "server/exact_phase/round_solids/axial_exact.hpp"

#include <algorithm>

#include "server/exact_phase/distance/polytope_kernel.hpp"
#include "server/exact_phase/kernels/segment_kernel.hpp"
#include "server/exact_phase/round_solids/axial_kernel.hpp"
#include "server/exact_phase/round_solids/flat_features.hpp"

namespace collided::engine::kernel {
namespace {

bool at_most(const Dyadic& a, const Dyadic& b) { return (a - b).sign() <= 0; }

/// Whether a <= b sqrt(c), for c >= 0.
bool at_most_root(const Dyadic& a, const Dyadic& b, const Dyadic& c) {
  if (a.sign() <= 0 && b.sign() >= 0) return true;
  if (a.sign() > 0 && b.sign() <= 0) return false;
  const Dyadic rest = a * a - b * b * c;
  return a.sign() > 0 ? rest.sign() <= 0 : rest.sign() >= 0;
}

/// A ball relative to an axis: its centre is `along` / l from the beginning and sqrt(across2) / l from the line.
struct SeenBall {
  AxialSolid<Dyadic> solid;
  Vector<Dyadic> to;
  Dyadic along;
  Dyadic across2;
  Dyadic ball;

  SeenBall(const ExactSolid& axial, const Vector<Dyadic>& center, const Dyadic& radius)
      : solid(axial),
        to(center - axial.points[0]),
        along(dot(to, solid.axis)),
        across2(square(cross(to, solid.axis))),
        ball(radius) {}

  /// Whether the ball reaches the rim of the disc that lies `beyond` / l away along the axis: (distance across - R)^2 +
  /// (beyond / l)^2 <= r^2.
  bool reaches_rim(const Dyadic& beyond) const {
    const Dyadic& R = solid.radius;
    const Dyadic& l2 = solid.length2;
    const Dyadic rest = across2 + beyond * beyond + (R * R - ball * ball) * l2;
    return at_most_root(rest, R + R, across2 * l2);
  }
  /// Whether the ball reaches the disc's flat side.
  bool reaches_disc(const Dyadic& beyond) const {
    return at_most(across2, solid.radius * solid.radius * solid.length2) &&
           at_most(beyond * beyond, ball * ball * solid.length2);
  }
  bool reaches_cylinder() const {
    const Dyadic behind = along - solid.length2;
    if (along.sign() < 0) return reaches_disc(along) || reaches_rim(along);
    if (behind.sign() > 0) return reaches_disc(behind) || reaches_rim(behind);
    const Dyadic reach = solid.radius + ball;
    return at_most(across2, reach * reach * solid.length2);
  }
  /// Whether the ball reaches the side from outside. In the plane of axis and centre the side runs from (0, 0) to (l,
  /// R); the centre is at (along / l, s / l^2), s being the root of across2 l^2. It must be outside of the side's line
  /// and its foot on the side: below the base of a flat cone some points have their foot on the side, but from within.
  bool reaches_slant() const {
    const Dyadic& R = solid.radius;
    const Dyadic& l2 = solid.length2;
    const Dyadic s2 = across2 * l2;
    const Dyadic whole2 = l2 + R * R;
    if (!at_most_root(-(along * l2), R, s2) || !at_most_root((along - whole2) * l2, -R, s2)) return false;
    const Dyadic p = R * along;
    if (p.sign() >= 0 && at_most(s2, p * p)) return false;
    // s - R along <= r l sqrt(l^2 + R^2).
    const Dyadic room = ball * ball * l2 * whole2;
    if (p.sign() >= 0) return at_most_root(s2 - p * p - room, p + p, room);
    return at_most_root(-(room - p * p - s2), p + p, s2);
  }
  bool reaches_cone() const {
    const Dyadic behind = along - solid.length2;
    const bool is_before_base = along.sign() >= 0 && behind.sign() <= 0;
    const Dyadic wide = solid.radius * along;
    if (is_before_base && at_most(across2 * solid.length2, wide * wide)) return true;
    if (at_most(square(to), ball * ball) || reaches_rim(behind) || reaches_slant()) return true;
    return behind.sign() > 0 && reaches_disc(behind);
  }
};

/// A segment with a round side of constant radius.
struct LateralSurface {
  Segment<Dyadic> axis;
  Dyadic radius;
  explicit LateralSurface(const ExactSolid& set) : axis(set.points[0], set.points[1]), radius(set.radius) {}
};

bool has_side(const ExactSolid& set) {
  return set.kind == ExactSolid::Kind::capsule || (set.kind == ExactSolid::Kind::axial && !set.tapers());
}

/// Tests feature by feature, each with the ladder from double upward, until one is yes.
class AxialAgainstFeatures {
 public:
  AxialAgainstFeatures(const Convex& axial, const Convex& flat, const FlatFeatures& features)
      : axial_(axial), flat_(flat), features_(features) {}

  ExactResult meet() {
    if (ask_standing(nullptr) || !features_.border().is_solid) return all_;
    add({polytopes_meet(Convex(Sphere{axial_.carrier[0], 0}), flat_), Level::rational});
    return all_;
  }

  /// Tests the features of a moving flat set at both ends and what its corners and edges sweep; those that lie inside
  /// do no harm.
  ExactResult meet_on(const StraightMotion& motion) {
    if (ask_standing(nullptr) || ask_standing(&motion)) return all_;
    for (std::uint32_t i = 0; i < features_.corner_count(); ++i) {
      if (ask_edge({At{i, nullptr}, At{i, &motion}})) return all_;
    }
    for (const FlatFeatures::Edge& edge : features_.border().edges) {
      if (ask_face({At{edge[0], nullptr}, At{edge[1], nullptr}, At{edge[1], &motion}, At{edge[0], &motion}}, 4))
        return all_;
    }
    const StraightMotion turned = motion.turned();
    add({polytopes_meet_on_motion(Convex(Sphere{axial_.carrier[0], 0}), flat_, turned), Level::rational});
    return all_;
  }

 private:
  /// A corner at the beginning or the end of the motion.
  struct At {
    std::uint32_t corner = 0;
    const StraightMotion* motion = nullptr;
  };

  template <class N>
  Vector<N> place_of(const At& at) const {
    const Vector<N> begin = features_.corner<N>(at.corner, axial_.carrier[0]);
    return at.motion == nullptr ? begin : begin + at.motion->displacement<N>();
  }
  bool add(const ExactResult& one) {
    all_ = {either(all_.decision, one.decision), std::max(all_.level, one.level)};
    return all_.yes();
  }
  bool ask_edge(const std::array<At, 2>& end) {
    return add(
        climb([&]<class N>() { return meets_edge(AxialSolid<N>(axial_), place_of<N>(end[0]), place_of<N>(end[1])); }));
  }
  bool ask_face(const std::array<At, 4>& corner, std::size_t count) {
    return add(climb([&]<class N>() {
      std::array<Vector<N>, 4> place;
      for (std::size_t i = 0; i < count; ++i) place[i] = place_of<N>(corner[i]);
      return cuts_face<N>(AxialSolid<N>(axial_), {place.data(), count});
    }));
  }
  bool ask_standing(const StraightMotion* motion) {
    for (const FlatFeatures::Edge& edge : features_.border().edges) {
      if (ask_edge({At{edge[0], motion}, At{edge[1], motion}})) return true;
    }
    for (const FlatFeatures::Face& face : features_.border().faces) {
      std::array<At, 4> corner;
      for (std::size_t i = 0; i < face.count; ++i) corner[i] = {face.corner[i], motion};
      if (ask_face(corner, face.count)) return true;
    }
    return false;
  }

  const Convex& axial_;
  const Convex& flat_;
  const FlatFeatures& features_;
  ExactResult all_{Decision::no, Level::filter};
};

bool is_within(const Dyadic& x, const Dyadic& end) { return x.sign() >= 0 && at_most(x, end); }

}  // namespace

ExactResult axial_meets_flat(const Convex& axial, const Convex& flat, const StraightMotion* motion) {
  const std::optional<FlatFeatures> features = FlatFeatures::of(flat);
  if (!features) return {Decision::undecided, Level::rational};
  return motion == nullptr ? AxialAgainstFeatures{axial, flat, *features}.meet()
                           : AxialAgainstFeatures{axial, flat, *features}.meet_on(motion->turned());
}

Decision axial_meets_border(const ExactSolid& axial, const ExactSolid& flat) {
  const AxialSolid<Dyadic> solid(axial);
  std::vector<Vector<Dyadic>> seen;
  for (const Vector<Dyadic>& corner : flat.points) seen.push_back(corner - axial.points[0]);
  AnyOf any;
  for (const FlatBorder::Edge& edge : flat.border->edges) {
    if (any.add(meets_edge(solid, seen[edge[0]], seen[edge[1]]))) return Decision::yes;
  }
  for (const FlatBorder::Face& face : flat.border->faces) {
    std::array<Vector<Dyadic>, 4> corner;
    for (std::size_t i = 0; i < face.count; ++i) corner[i] = seen[face.corner[i]];
    if (any.add(cuts_face<Dyadic>(solid, {corner.data(), face.count}))) return Decision::yes;
  }
  if (flat.border->is_solid) any.add(hull_meets_ball(seen, Dyadic()));
  return any.result();
}

Decision axial_meets_ball(const ExactSolid& axial, const Vector<Dyadic>& center, const Dyadic& radius) {
  const SeenBall seen(axial, center, radius);
  if (!seen.across2.finite() || !seen.ball.finite() || !seen.solid.radius.finite()) return Decision::undecided;
  return (seen.solid.tapers ? seen.reaches_cone() : seen.reaches_cylinder()) ? Decision::yes : Decision::no;
}

/// Between the feet of the shortest connection of the two lines there is a point of both sets, if each foot is within
/// its segment and the connection is no longer than the radii. For parallel axes: any place at which both segments
/// overlap.
Decision sides_meet(const ExactSolid& a, const ExactSolid& b) {
  if (!has_side(a) || !has_side(b)) return Decision::undecided;
  const LateralSurface of_a(a);
  const LateralSurface of_b(b);
  const Vector<Dyadic>& d = of_a.axis.d;
  const Vector<Dyadic>& e = of_b.axis.d;
  const Vector<Dyadic> w = of_a.axis.a - of_b.axis.a;
  const Vector<Dyadic> n = cross(d, e);
  const Dyadic nn = square(n);
  const Dyadic reach = of_a.radius + of_b.radius;
  if (!nn.finite() || !reach.finite() || !square(w).finite()) return Decision::undecided;
  const bool are_parallel = nn.sign() == 0;
  const Dyadic length2 = square(d);
  const Vector<Dyadic> displacement = are_parallel ? dot(w, d) * d - length2 * w : n;
  const auto part = [&](const Vector<Dyadic>& across) { return parted_along(across, a, b) == Decision::yes; };
  if (part(displacement) || part(-displacement)) return Decision::no;
  if (are_parallel) {
    const Dyadic begin = -dot(w, d);
    const Dyadic end = begin + dot(e, d);
    const bool pass = at_most(min(begin, end), length2) && max(begin, end).sign() >= 0;
    return pass && at_most(square(cross(w, d)), reach * reach * length2) ? Decision::yes : Decision::undecided;
  }
  const Dyadic height = dot(w, n);
  const bool pass = is_within(-dot(w, cross(e, n)), nn) && is_within(-dot(w, cross(d, n)), nn);
  return pass && at_most(height * height, reach * reach * nn) ? Decision::yes : Decision::undecided;
}

/// Sections perpendicular to the axes are discs whose radii change linearly along the axes: the sets meet anywhere only
/// if they do at one end of their common range.
Decision parallel_axials_meet(const ExactSolid& a, const ExactSolid& b) {
  const AxialSolid<Dyadic> of_a(a);
  const AxialSolid<Dyadic> of_b(b);
  const Vector<Dyadic> turn = cross(of_a.axis, of_b.axis);
  const Vector<Dyadic> w = b.points[0] - a.points[0];
  if (!square(turn).finite() || !square(w).finite()) return Decision::undecided;
  if (square(turn).sign() != 0) return Decision::undecided;
  const Dyadic& length2 = of_a.length2;
  const Dyadic begin = dot(w, of_a.axis);
  const Dyadic rise = dot(of_b.axis, of_a.axis);
  const Dyadic low = max(Dyadic(), min(begin, begin + rise));
  const Dyadic high = min(length2, max(begin, begin + rise));
  if ((high - low).sign() < 0) return Decision::no;
  const Dyadic apart2 = square(cross(w, of_a.axis));
  // Radii times length2 and rise, which is negative if the axes are opposite.
  const auto meet_at = [&](const Dyadic& height) {
    const Dyadic radius_a = of_a.radius * (of_a.tapers ? height : length2);
    const Dyadic radius_b = of_b.radius * (of_b.tapers ? height - begin : rise);
    const Dyadic reach = radius_a * abs(rise) + abs(radius_b) * length2;
    return at_most(apart2 * length2 * rise * rise, reach * reach);
  };
  return meet_at(low) || meet_at(high) ? Decision::yes : Decision::no;
}

}  // namespace collided::engine::kernel
