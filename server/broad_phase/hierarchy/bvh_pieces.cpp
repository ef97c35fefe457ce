#include "server/broad_phase/hierarchy/bvh_pieces.hpp"

#include <array>
#include <cmath>

#include "server/broad_phase/hierarchy/bvh_threads.hpp"

namespace collided::engine::bvh {
namespace {

/// Margin of a box around the part that it covers, in local units. The points of a cut are off by at most 2^-50 each,
/// over at most 64 cuts; floats near zero resolve such differences.
/// At zero, BvhPieces.CoverAnEdgeBesideTheCut fails.
constexpr double kPieceSlack = 0x1p-43;

/// A larger share of extra references than this is not worth the memory.
constexpr double kMostExtraReferences = 0.25;
/// The splits must remove at least this share of the empty area in the triangles' boxes. A mesh of equal triangles
/// reaches 0.13 with the references allowed above; a few large slanted ones among many approach 1.
constexpr double kLeastGain = 0.35;

/// Triangles per batch of a thread.
constexpr std::size_t kPiecesARun = 65536;

struct Polygon {
  std::array<Vec3, 3 + kMaxPieces> corners;
  int count = 0;

  void add(const Vec3& corner) { corners[static_cast<std::size_t>(count++)] = corner; }
  const Vec3& operator[](int i) const { return corners[static_cast<std::size_t>(i)]; }
};

/// Splits the polygon into its parts on both sides of a plane; points on it belong to both.
/// source  Sutherland, Hodgman, "Reentrant Polygon Clipping", 1974
void cut(const Polygon& whole, int axis, double plane, Polygon& below, Polygon& above) {
  for (int i = 0; i < whole.count; ++i) {
    const Vec3& from = whole[i];
    const Vec3& to = whole[(i + 1) % whole.count];
    if (from[axis] <= plane) below.add(from);
    if (from[axis] >= plane) above.add(from);
    if ((from[axis] < plane && to[axis] > plane) || (from[axis] > plane && to[axis] < plane)) {
      Vec3 point = from + (to - from) * ((plane - from[axis]) / (to[axis] - from[axis]));
      point[axis] = plane;
      below.add(point);
      above.add(point);
    }
  }
}

/// A box around the polygon, within the box of the whole triangle.
Primitive box_of(const Polygon& polygon, const Primitive& within) {
  Primitive box = within;
  for (int axis = 0; axis < 3; ++axis) {
    double low = polygon[0][axis];
    double high = low;
    for (int i = 1; i < polygon.count; ++i) {
      low = std::min(low, polygon[i][axis]);
      high = std::max(high, polygon[i][axis]);
    }
    box.low[axis] = std::max(within.low[axis], round_down(low - kPieceSlack));
    box.high[axis] = std::min(within.high[axis], round_up(high + kPieceSlack));
  }
  return box;
}

/// The number in the middle half of [low, high] with the fewest binary digits, so that neighbours are cut at the same
/// planes.
double round_middle(double low, double high) {
  const double middle = low / 2 + high / 2;
  const double step = std::ldexp(1.0, std::ilogb(high - low) - 1);
  const double rounded = std::nearbyint(middle / step) * step;
  return rounded > low && rounded < high ? rounded : middle;
}

/// Covers a part of the triangle; writes at most count boxes and returns how many.
std::uint32_t cover_part(const Polygon& polygon, const Primitive& box, const Primitive& whole, std::uint32_t count,
                         std::span<Primitive> pieces) {
  int axis = 0;
  const Float4 size = box.high - box.low;
  for (int other = 1; other < 3; ++other) axis = size[other] > size[axis] ? other : axis;
  if (count == 1 || !(size[axis] > 0x1p-20f)) {
    pieces[0] = box;
    return 1;
  }
  const double plane = round_middle(static_cast<double>(box.low[axis]), static_cast<double>(box.high[axis]));
  Polygon below;
  Polygon above;
  cut(polygon, axis, plane, below, above);
  if (below.count == 0 || above.count == 0) {
    pieces[0] = box;
    return 1;
  }
  const Primitive below_box = box_of(below, whole);
  const Primitive above_box = box_of(above, whole);
  const float below_size = (below_box.high - below_box.low).head<3>().maxCoeff();
  const float above_size = (above_box.high - above_box.low).head<3>().maxCoeff();
  const auto share =
      static_cast<std::uint32_t>(std::lround(static_cast<float>(count) * below_size / (below_size + above_size)));
  const std::uint32_t below_count = std::clamp(share, 1u, count - 1);
  const std::uint32_t written = cover_part(below, below_box, whole, below_count, pieces);
  return written + cover_part(above, above_box, whole, count - below_count, pieces.subspan(written));
}

/// Half the surface of the box beyond that needed by the triangle and its twin across the box's diagonal: splitting
/// gains nothing for half a rectangle, which shares its box with the other half.
float empty_area(const TriangleMesh& mesh, const LocalFrame& frame, const Primitive& whole) {
  const Triangle world = mesh.triangle(whole.triangle());
  const Vec3 a = frame.to_local(world.a);
  const Vec3 normal = (frame.to_local(world.b) - a).cross(frame.to_local(world.c) - a);
  const FloatBox box{whole.low, whole.high};
  return std::max(0.0f, box.half_area() - static_cast<float>(normal.lpNorm<1>()));
}

/// Pieces of a triangle, from 1 to kMaxPieces, in proportion to its priority.
std::uint32_t piece_count(float priority, float scale) {
  return 1 + static_cast<std::uint32_t>(std::min(priority * scale, static_cast<float>(kMaxPieces - 1)));
}

std::uint64_t extra_references(std::span<const float> priorities, std::size_t step, float scale) {
  std::uint64_t extra = 0;
  for (std::size_t i = 0; i < priorities.size(); i += step) extra += piece_count(priorities[i], scale) - 1;
  return extra;
}

/// Approximately the largest scale at which the pieces are within the allowed number: found on a sample, then lowered
/// until all fit.
float fitted_scale(std::span<const float> priorities) {
  const float largest = *std::max_element(priorities.begin(), priorities.end());
  if (!(largest > 0)) return 0;
  const std::size_t step = 1 + priorities.size() / kPiecesARun;
  const double allowed = kMostExtraReferences * static_cast<double>(priorities.size());
  float least = 0;
  float most = static_cast<float>(kMaxPieces) / largest * 64;
  for (int halving = 0; halving < 24; ++halving) {
    const float scale = least + (most - least) / 2;
    const bool fits = static_cast<double>(extra_references(priorities, step, scale) * step) <= allowed;
    (fits ? least : most) = scale;
  }
  while (static_cast<double>(extra_references(priorities, 1, least)) > allowed) least *= 0.97f;
  return least;
}

}  // namespace

std::uint32_t cover(const TriangleMesh& mesh, const LocalFrame& frame, std::uint32_t number, std::uint32_t count,
                    std::span<Primitive> pieces) {
  const Primitive whole = local_primitive(mesh, frame, number);
  const Triangle world = mesh.triangle(number);
  Polygon polygon;
  for (const Vec3* corner : {&world.a, &world.b, &world.c}) polygon.add(frame.to_local(*corner));
  return cover_part(polygon, whole, whole, count, pieces);
}

std::vector<Split> worth_splitting(const TriangleMesh& mesh, const LocalFrame& frame, std::span<const Primitive> whole,
                                   unsigned threads) {
  std::vector<float> priorities(whole.size());
  in_runs(threads, whole.size(), kPiecesARun, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) priorities[i] = std::cbrt(empty_area(mesh, frame, whole[i]));
  });
  const float scale = fitted_scale(priorities);
  std::vector<Split> splits;
  double empty_sum = 0;
  double removed = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const auto root = static_cast<double>(priorities[i]);
    const double empty = root * root * root;
    empty_sum += empty;
    const std::uint32_t count = piece_count(priorities[i], scale);
    if (count < 2) continue;
    removed += empty * (1 - 1.0 / count);
    splits.push_back({whole[i].triangle(), count});
  }
  if (removed < kLeastGain * empty_sum) splits.clear();
  return splits;
}

}  // namespace collided::engine::bvh
