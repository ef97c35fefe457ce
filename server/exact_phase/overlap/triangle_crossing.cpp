#include "server/exact_phase/overlap/triangle_crossing.hpp"

#include <array>

#include "server/exact_phase/arithmetic/value.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/kernels/triangle_kernel.hpp"

namespace collided::engine {
namespace {

using namespace kernel;

/// An end of the crossing, and the sum of its coordinates' bounds.
struct End {
  Vec3 point = Vec3::Zero();
  double error_m = 0;
};

/// At most nine points may be ends for triangles in different planes, 6 + 9 in one plane.
struct Ends {
  std::array<End, 18> end;
  int count = 0;

  void add(const End& one) {
    if (count < static_cast<int>(end.size())) end[static_cast<std::size_t>(count++)] = one;
  }
};

/// The point p + (q - p) * part / whole.
template <class N>
End end_between(const Vec3& p, const Vec3& q, const N& part, const N& whole) {
  const Bounded t = plain(scaled(part) / scaled(whole));
  End end;
  for (int k = 0; k < 3; ++k) {
    const Bounded x = Bounded(p[k]) + t * (Bounded(q[k]) - Bounded(p[k]));
    end.point[k] = x.value;
    end.error_m += x.bound();
  }
  return end;
}

/// One component of (b - a) x (c - a).
template <class N>
N turn_value(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int i = (axis + 1) % 3;
  const int j = (axis + 2) % 3;
  return (N(b[i]) - N(a[i])) * (N(c[j]) - N(a[j])) - (N(b[j]) - N(a[j])) * (N(c[i]) - N(a[i]));
}

/// Finds the ends of the crossing at one triangle's corners and edges and the other's face; false: a sign is uncertain.
template <class N>
class FaceSearch {
 public:
  FaceSearch(const Triangle& edges, const Triangle& face, Ends& ends)
      : corner_{edges.a, edges.b, edges.c}, face_{face.a, face.b, face.c}, facet_(face), ends_(ends) {}

  bool run() {
    axis_ = dropped_axis(facet_.normal);
    if (axis_ < 0) return false;
    if (axis_ == 3) return true;  // no face, only edges: the search in the other direction finds them
    for (std::size_t i = 0; i < 3; ++i) {
      height_[i] = dot(facet_.normal, Vector<N>(corner_[i]) - facet_.corner[0]);
      sign_[i] = sign(height_[i]);
      if (sign_[i] == Sign::unsure) return false;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      if (sign_[i] == Sign::zero && !corner(i)) return false;
      if (!edge(i, (i + 1) % 3)) return false;
    }
    return true;
  }

 private:
  /// -1, 0 or +1 if all signs other than zero agree, else 2; 3: uncertain.
  static int common(const std::array<Sign, 3>& signs) {
    int all = 0;
    for (const Sign s : signs) {
      if (s == Sign::unsure) return 3;
      if (s == Sign::zero) continue;
      if (all == -static_cast<int>(s)) return 2;
      all = static_cast<int>(s);
    }
    return all;
  }

  bool corner(std::size_t i) {
    std::array<Sign, 3> turns;
    for (std::size_t k = 0; k < 3; ++k) turns[k] = sign(turn_value<N>(face_[k], face_[(k + 1) % 3], corner_[i], axis_));
    const int side = common(turns);
    if (side == 3) return false;
    if (side != 2) ends_.add({corner_[i], 0});
    return true;
  }

  bool edge(std::size_t i, std::size_t j) {
    if (sign_[i] == Sign::zero && sign_[j] == Sign::zero) return edge_in_plane(corner_[i], corner_[j]);
    if (static_cast<int>(sign_[i]) * static_cast<int>(sign_[j]) >= 0) return true;
    const Vector<N> p(corner_[i]);
    const Vector<N> d = Vector<N>(corner_[j]) - p;
    std::array<Sign, 3> turns;
    for (std::size_t k = 0; k < 3; ++k) {
      turns[k] = sign(dot(d, cross(Vector<N>(face_[k]) - p, Vector<N>(face_[(k + 1) % 3]) - p)));
    }
    const int side = common(turns);
    if (side == 3) return false;
    if (side != 2) ends_.add(end_between(corner_[i], corner_[j], height_[i], height_[i] - height_[j]));
    return true;
  }

  /// Crosses an edge in the face's plane with the face's three edges.
  bool edge_in_plane(const Vec3& p, const Vec3& q) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& c = face_[k];
      const Vec3& d = face_[(k + 1) % 3];
      const N at_p = turn_value<N>(c, d, p, axis_);
      const N at_q = turn_value<N>(c, d, q, axis_);
      const std::array<Sign, 4> signs{sign(at_p), sign(at_q), sign(turn_value<N>(p, q, c, axis_)),
                                      sign(turn_value<N>(p, q, d, axis_))};
      for (const Sign s : signs) {
        if (s == Sign::unsure) return false;
      }
      const auto straddles = [](Sign one, Sign other) { return static_cast<int>(one) * static_cast<int>(other) <= 0; };
      const bool is_parallel = signs[0] == signs[1] && signs[0] == Sign::zero;
      if (is_parallel || !straddles(signs[0], signs[1]) || !straddles(signs[2], signs[3])) continue;
      ends_.add(end_between(p, q, at_p, at_p - at_q));
    }
    return true;
  }

  std::array<Vec3, 3> corner_;
  std::array<Vec3, 3> face_;
  Facet<N> facet_;
  Ends& ends_;
  int axis_ = 0;
  std::array<N, 3> height_;
  std::array<Sign, 3> sign_{};
};

double extent_of(const Triangle& t) {
  return std::max({t.a.cwiseAbs().maxCoeff(), t.b.cwiseAbs().maxCoeff(), t.c.cwiseAbs().maxCoeff()});
}

double size_of(const Triangle& t) { return std::max({(t.b - t.a).norm(), (t.c - t.b).norm(), (t.a - t.c).norm()}); }

/// The two ends that are farthest apart.
Crossing farthest_of(const Ends& ends) {
  Crossing best;
  double most_m2 = -1;
  for (int i = 0; i < ends.count; ++i) {
    for (int j = i; j < ends.count; ++j) {
      const End& from = ends.end[static_cast<std::size_t>(i)];
      const End& to = ends.end[static_cast<std::size_t>(j)];
      const double apart_m2 = (to.point - from.point).squaredNorm();
      if (apart_m2 > most_m2) best = {from.point, to.point, std::max(from.error_m, to.error_m)};
      most_m2 = std::max(most_m2, apart_m2);
    }
  }
  return best;
}

template <class N>
bool found(const Triangle& a, const Triangle& b, Ends& ends) {
  ends.count = 0;
  return FaceSearch<N>(a, b, ends).run() && FaceSearch<N>(b, a, ends).run();
}

}  // namespace

Crossing crossing(const Triangle& a, const Triangle& b) {
  Ends ends;
  const double blunt_m = kRefineDistance * std::max(extent_of(a), extent_of(b));
  Crossing result;
  const auto is_sharp = [&] {
    result = farthest_of(ends);
    return ends.count > 0 && result.error_m <= blunt_m;
  };
  if (found<Bounded>(a, b, ends) && is_sharp()) return result;
  if (found<Dyadic>(a, b, ends) && ends.count > 0) return farthest_of(ends);
  const Vec3 point = contact(a, b).point;
  return {point, point, std::max(size_of(a), size_of(b))};
}

}  // namespace collided::engine
