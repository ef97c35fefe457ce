// The depth of two overlapping convex sets, by growing a polytope inside their difference set.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/exact_phase/arithmetic/value.hpp"
#include "server/exact_phase/distance/simplex_search.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {
namespace {

constexpr int kMostCorners = 128;
constexpr int kMostFaces = 2 * kMostCorners;

struct Face {
  int corner[3];
  Vec3 normal;      // unit, outward
  double offset_m;  // distance of its plane from the origin
};

/// A polytope of difference points that is star-shaped about an inner point, so a support point beyond a face lies
/// outside.
class Polytope {
 public:
  Polytope(const Convex& a, const Convex& b) : a_(a), b_(b), size_m_(a.reach_m + b.reach_m) {}

  /// Builds a tetrahedron that is not flat, from the proposal's corners and further supports; false: the difference set
  /// is flat along flat_normal().
  bool begin(const Proposal& start);
  const Vec3& flat_normal() const { return flat_normal_; }

  int nearest_face() const;
  const Face& face(int i) const { return faces_[static_cast<std::size_t>(i)]; }
  /// Moves the border out to the support along a face's normal; false if the face is on the set's border already, or
  /// there is no room.
  bool grow(int face, double tolerance_m);
  /// The radius of a ball about the origin inside the hull of the corners, whatever rounding did to the faces: a closed
  /// surface that does not meet the ball winds around all of it or none of it.
  double least_offset() const;
  bool encloses_origin() const;
  // The points of a and b whose difference is the face's point nearest to the origin.
  void witnesses(int face, Vec3& on_a, Vec3& on_b) const;

 private:
  const DifferencePoint& at(int corner) const { return corners_[static_cast<std::size_t>(corner)]; }
  void add_corner(const DifferencePoint& p) { corners_[static_cast<std::size_t>(corner_count_++)] = p; }
  void add_face(int i, int j, int k);
  bool add_beyond(const Vec3& n);
  Vec3 across_edge() const;

  const Convex& a_;
  const Convex& b_;
  double size_m_;
  std::array<DifferencePoint, kMostCorners> corners_;
  std::array<Face, kMostFaces> faces_;
  int corner_count_ = 0;
  int face_count_ = 0;
  Vec3 flat_normal_ = Vec3::UnitX();
};

void Polytope::add_face(int i, int j, int k) {
  Face face{{i, j, k}, Vec3::Zero(), std::numeric_limits<double>::infinity()};
  const Vec3 u = at(j).w - at(i).w;
  const Vec3 v = at(k).w - at(i).w;
  const Vec3 normal = u.cross(v);
  const double length = normal.norm();
  // A face without area has no normal: it is never the nearest and never visible.
  if (length > 0) {
    face.normal = normal / length;
    face.offset_m = face.normal.dot(at(i).w);
  }
  faces_[static_cast<std::size_t>(face_count_++)] = face;
}

Vec3 Polytope::across_edge() const {
  const Vec3 edge = at(1).w - at(0).w;
  int least = 0;
  edge.cwiseAbs().minCoeff(&least);
  return edge.cross(Vec3::Unit(least)).normalized();
}

/// Adds the support along n or against it, whichever leaves the span of the present corners by more than rounding.
bool Polytope::add_beyond(const Vec3& n) {
  for (const double side : {1.0, -1.0}) {
    const DifferencePoint p = difference_support(side * n, a_, b_);
    if (std::abs(n.dot(p.w - at(0).w)) <= kSeenFrom * size_m_) continue;
    add_corner(p);
    return true;
  }
  return false;
}

bool Polytope::begin(const Proposal& start) {
  const double apart_m = kSeenFrom * size_m_;
  const auto off_point = [&](const DifferencePoint& p) { return (p.w - at(0).w).norm() > apart_m; };
  const auto off_line = [&](const DifferencePoint& p) {
    const Vec3 edge = at(1).w - at(0).w;
    return edge.cross(p.w - at(0).w).norm() > apart_m * edge.norm();
  };
  // Takes the proposal's corners as long as each leaves the span of those before it.
  add_corner(start.corner[0]);
  for (int i = 1; i < start.count; ++i) {
    if (corner_count_ == 1 ? off_point(start.corner[i]) : corner_count_ == 2 && off_line(start.corner[i])) {
      add_corner(start.corner[i]);
    }
  }
  for (int axis = 0; corner_count_ < 2 && axis < 3; ++axis) {
    flat_normal_ = Vec3::Unit(axis);
    add_beyond(flat_normal_);
  }
  if (corner_count_ < 2) return false;
  if (corner_count_ == 2) {
    const Vec3 edge = (at(1).w - at(0).w).normalized();
    const Vec3 across = across_edge();
    for (const Vec3& n : {across, Vec3(edge.cross(across))}) {
      flat_normal_ = n;
      if (corner_count_ == 2) add_beyond(n);
    }
  }
  if (corner_count_ < 3) return false;
  flat_normal_ = (at(1).w - at(0).w).cross(at(2).w - at(0).w).normalized();
  if (start.count == 4 && start.encloses) add_corner(start.corner[3]);
  else if (!add_beyond(flat_normal_)) return false;
  const Vec3 base = (at(1).w - at(0).w).cross(at(2).w - at(0).w);
  const double side = base.dot(at(3).w - at(0).w);
  if (!(std::abs(side) > 0)) return false;
  if (side > 0) std::swap(corners_[1], corners_[2]);
  add_face(0, 1, 2);
  add_face(0, 3, 1);
  add_face(1, 3, 2);
  add_face(2, 3, 0);
  return true;
}

int Polytope::nearest_face() const {
  int nearest = -1;
  for (int i = 0; i < face_count_; ++i) {
    if (nearest < 0 || face(i).offset_m < face(nearest).offset_m) nearest = i;
  }
  return nearest;
}

bool Polytope::grow(int nearest, double tolerance_m) {
  if (corner_count_ == kMostCorners) return false;
  const Vec3 normal = face(nearest).normal;
  const DifferencePoint p = difference_support(normal, a_, b_);
  if (!(normal.dot(p.w) - face(nearest).offset_m > std::max(tolerance_m, kSeenFrom * size_m_))) return false;
  // A flat side of several faces must be visible as a whole or not at all, so distances below rounding do not count.
  const double least_seen_m = kSeenFrom * size_m_;
  const auto sees = [&](const Face& f) { return f.normal.dot(p.w - at(f.corner[0]).w) > least_seen_m; };
  std::array<std::pair<int, int>, 3 * kMostFaces> rim;
  std::size_t rim_count = 0;
  int seen = 0;
  for (int i = 0; i < face_count_; ++i) {
    if (!sees(face(i))) continue;
    ++seen;
    for (int e = 0; e < 3; ++e) {
      const std::pair<int, int> edge{face(i).corner[e], face(i).corner[(e + 1) % 3]};
      // An edge between two visible faces comes once in each direction.
      const auto end = rim.begin() + static_cast<std::ptrdiff_t>(rim_count);
      const auto twin = std::find(rim.begin(), end, std::pair(edge.second, edge.first));
      if (twin != end) *twin = rim[--rim_count];
      else rim[rim_count++] = edge;
    }
  }
  if (rim_count == 0 || face_count_ - seen + static_cast<int>(rim_count) > kMostFaces) return false;
  const auto last = std::remove_if(faces_.begin(), faces_.begin() + face_count_, sees);
  face_count_ = static_cast<int>(last - faces_.begin());
  add_corner(p);
  for (std::size_t e = 0; e < rim_count; ++e) add_face(rim[e].first, rim[e].second, corner_count_ - 1);
  return true;
}

/// A lower bound on the triangle's distance from the origin: by its plane, or for a sliver, whose plane is uncertain,
/// by its longest edge and its height over that.
double face_distance(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vector<Bounded> corner(a);
  const Vector<Bounded> n = cross(Vector<Bounded>(b) - corner, Vector<Bounded>(c) - corner);
  const Bounded offset = abs(dot(n, corner)) / sqrt(square(n));
  const double by_plane = std::isfinite(offset.error) ? offset.low() : 0.0;
  const Vec3 corners[3] = {a, b, c};
  double longest = 0;
  int first = 0;
  for (int i = 0; i < 3; ++i) {
    const double length = (corners[(i + 1) % 3] - corners[i]).norm();
    if (length > longest) first = i;
    longest = std::max(longest, length);
  }
  const Vec3& from = corners[first];
  const Vec3 edge = corners[(first + 1) % 3] - from;
  const double size = from.norm() + longest;
  if (!(longest > 0)) return std::max(by_plane, from.norm() - 64 * kRoundoff * size);
  const double at = std::clamp(-from.dot(edge) / (longest * longest), 0.0, 1.0);
  const double height = edge.cross(corners[(first + 2) % 3] - from).norm() / longest;
  return std::max(by_plane, (from + at * edge).norm() - height - 64 * kRoundoff * size);
}

/// Twice the sign of d . (p x q), or 1 if it is uncertain.
int side_of(const Vec3& d, const Vec3& p, const Vec3& q) {
  const Bounded volume = dot(Vector<Bounded>(d), cross(Vector<Bounded>(p), Vector<Bounded>(q)));
  const Sign s = sign(volume);
  return s == Sign::unsure || s == Sign::zero ? 1 : 2 * static_cast<int>(s);
}

/// Decides by how often a ray from the origin crosses the faces, even or odd; skips directions for which a face is
/// uncertain.
bool Polytope::encloses_origin() const {
  for (const Vec3& d :
       {Vec3(0.53, 0.61, 0.59), Vec3(-0.71, 0.37, 0.6), Vec3(0.23, -0.81, 0.54), Vec3(-0.3, -0.44, -0.85)}) {
    int crossed = 0;
    bool sure = true;
    for (int i = 0; i < face_count_ && sure; ++i) {
      const Vec3& p = at(face(i).corner[0]).w;
      const Vec3& q = at(face(i).corner[1]).w;
      const Vec3& r = at(face(i).corner[2]).w;
      const int side[3] = {side_of(d, p, q), side_of(d, q, r), side_of(d, r, p)};
      const auto [least, most] = std::minmax({side[0], side[1], side[2]});
      if (least == -2 && most == 2) continue;
      const int ahead = side_of(p, q, r);
      sure = least == most && least != 1 && ahead != 1;
      if (ahead == least) ++crossed;
    }
    if (sure) return crossed % 2 == 1;
  }
  return false;
}

double Polytope::least_offset() const {
  if (!encloses_origin()) return 0;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < face_count_; ++i) {
    const Face& f = face(i);
    least = std::min(least, face_distance(at(f.corner[0]).w, at(f.corner[1]).w, at(f.corner[2]).w));
  }
  return least;
}

void Polytope::witnesses(int number, Vec3& on_a, Vec3& on_b) const {
  const Face& f = face(number);
  const Vec3 foot = f.offset_m * f.normal;
  const DifferencePoint& p = at(f.corner[0]);
  const DifferencePoint& q = at(f.corner[1]);
  const DifferencePoint& r = at(f.corner[2]);
  const Vec3 u = q.w - p.w;
  const Vec3 v = r.w - p.w;
  const Vec3 n = u.cross(v);
  const double nn = n.squaredNorm();
  double of_q = n.dot((foot - p.w).cross(v)) / nn;
  double of_r = n.dot(u.cross(foot - p.w)) / nn;
  of_q = std::clamp(of_q, 0.0, 1.0);
  of_r = std::clamp(of_r, 0.0, 1 - of_q);
  on_a = p.on_a + of_q * (q.on_a - p.on_a) + of_r * (r.on_a - p.on_a);
  on_b = p.on_b + of_q * (q.on_b - p.on_b) + of_r * (r.on_b - p.on_b);
}

}  // namespace

DepthProposal depth_proposal(const Convex& a, const Convex& b, const Proposal& start, double tolerance_m) {
  DepthProposal result;
  result.on_a = start.on_a();
  result.on_b = start.on_b();
  Polytope polytope(a, b);
  if (!polytope.begin(start)) {
    result.normal = polytope.flat_normal();
    return result;
  }
  int nearest = polytope.nearest_face();
  for (int step = 0; nearest >= 0 && step < kMostCorners && polytope.grow(nearest, tolerance_m); ++step) {
    nearest = polytope.nearest_face();
  }
  if (nearest < 0 || !std::isfinite(polytope.face(nearest).offset_m)) return result;
  result.normal = polytope.face(nearest).normal;
  result.least_m = std::max(polytope.least_offset(), 0.0);
  polytope.witnesses(nearest, result.on_a, result.on_b);
  return result;
}

}  // namespace collided::engine::kernel
