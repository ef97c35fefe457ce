#include "server/world/objects/surface_cover.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/geometry/edge_table.hpp"
#include "server/geometry/surface_tolerance.hpp"
#include "server/intake/weld.hpp"

namespace collided::engine {
namespace {

using Flat = Eigen::Vector2d;

/// Pieces that need more triangles are given up.
constexpr std::size_t kMostTriangles = 2048;

double cross(const Flat& a, const Flat& b) { return a[0] * b[1] - a[1] * b[0]; }

}  // namespace

TriangleNeighbours::TriangleNeighbours(const TriangleMesh& mesh, std::span<const std::uint32_t> part_of)
    : across_(3 * mesh.triangles.size(), kNone) {
  const EdgeTable table = edge_table(mesh, first_equal_vertices(mesh.vertices));
  const auto part = [&](HalfEdge half) { return part_of[triangle_of(half)]; };
  std::vector<HalfEdge> uses;
  for (std::size_t edge = 0; edge < table.size(); ++edge) {
    uses.assign(table.uses_of(edge).begin(), table.uses_of(edge).end());
    std::stable_sort(uses.begin(), uses.end(), [&](HalfEdge a, HalfEdge b) { return part(a) < part(b); });
    for (std::size_t first = 0, end = 0; first < uses.size(); first = end) {
      while (end < uses.size() && part(uses[end]) == part(uses[first])) ++end;
      if (end - first != 2) continue;
      across_[uses[first]] = triangle_of(uses[first + 1]);
      across_[uses[first + 1]] = triangle_of(uses[first]);
    }
  }
}

SheetOverTable::SheetOverTable(const TriangleMesh& sheet, const TriangleNeighbours& neighbours)
    : sheet_(sheet), neighbours_(neighbours), taken_at_(sheet.triangles.size(), 0) {}

bool SheetOverTable::set_table(const Triangle& table) {
  origin_ = table.a;
  const Vec3 along = table.b - table.a;
  const Vec3 normal = along.cross(table.c - table.a);
  const double length = along.norm();
  const double area = normal.norm();
  if (!(length > 0 && area > 0 && std::isfinite(length) && std::isfinite(area))) return false;
  axes_.row(0) = along / length;
  axes_.row(2) = normal / area;
  axes_.row(1) = Vec3(axes_.row(2)).cross(Vec3(axes_.row(0)));
  reach_ = 0;
  outline_ = {raised(table.a).at, raised(table.b).at, raised(table.c).at};
  middle_ = (outline_[0] + outline_[1] + outline_[2]) / 3;
  size_ = std::max({outline_[1].norm(), outline_[2].norm(), (outline_[2] - outline_[1]).norm()});
  for (std::size_t i = 0; i < 3; ++i) inside_[i] = middle_ + (1 - kRim) * (outline_[i] - middle_);
  return true;
}

SheetOverTable::Raised SheetOverTable::raised(const Vec3& point) const {
  const Vec3 turned = axes_ * (point - origin_);
  return {{turned[0], turned[1]}, turned[2]};
}

/// False only if the segment certainly stays outside of the shrunk table: some line separates the two.
bool SheetOverTable::may_run_over(const Raised& a, const Raised& b) const {
  const double slack = kFlatSlack * (size_ + reach_) * (size_ + reach_);
  for (std::size_t i = 0; i < 3; ++i) {
    const Flat edge = inside_[(i + 1) % 3] - inside_[i];
    if (cross(edge, a.at - inside_[i]) < -slack && cross(edge, b.at - inside_[i]) < -slack) return false;
  }
  // No edge of the table separates them; the segment's own line may.
  const Flat along = b.at - a.at;
  bool left = false;
  bool right = false;
  for (const Flat& corner : inside_) {
    const double side = cross(along, corner - a.at);
    left = left || !(side < -slack);
    right = right || !(side > slack);
  }
  return left && right;
}

void SheetOverTable::take(std::uint32_t triangle) {
  taken_at_[triangle] = table_number_;
  piece_.push_back(triangle);
  const Triangle t = sheet_.triangle(triangle);
  corners_.push_back({raised(t.a), raised(t.b), raised(t.c)});
  for (const Raised& corner : corners_.back())
    reach_ = std::max({reach_, corner.at.cwiseAbs().maxCoeff(), std::abs(corner.height)});
}

/// False: the piece meets a border of the sheet over the table, or grows too large.
bool SheetOverTable::grow(std::uint32_t seed) {
  ++table_number_;
  piece_.clear();
  corners_.clear();
  take(seed);
  for (std::size_t i = 0; i < piece_.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t next = neighbours_.across(piece_[i], k);
      if (next != TriangleNeighbours::kNone && taken_at_[next] == table_number_) continue;
      if (!may_run_over(corners_[i][k], corners_[i][(k + 1) % 3])) continue;
      if (next == TriangleNeighbours::kNone || piece_.size() == kMostTriangles) return false;
      take(next);
    }
  }
  // The slack grew with the reach, so an edge judged early is judged again with the final slack.
  for (std::size_t i = 0; i < piece_.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t next = neighbours_.across(piece_[i], k);
      const bool is_border = next == TriangleNeighbours::kNone || taken_at_[next] != table_number_;
      if (is_border && may_run_over(corners_[i][k], corners_[i][(k + 1) % 3])) return false;
    }
  }
  return true;
}

/// 1: the triangle covers the table's middle; 0: it does not; -1: undecided because of rounding.
int SheetOverTable::covers_middle(const std::array<Raised, 3>& corners) const {
  const double slack = kFlatSlack * (size_ + reach_) * (size_ + reach_);
  int left = 0;
  int right = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double side = cross(corners[(k + 1) % 3].at - corners[k].at, middle_ - corners[k].at);
    left += side > slack ? 1 : 0;
    right += side < -slack ? 1 : 0;
  }
  if (left > 0 && right > 0) return 0;
  return left == 3 || right == 3 ? 1 : -1;
}

/// The greatest height of the triangle's part over the table, or somewhat more.
double SheetOverTable::height_over_table(const std::array<Raised, 3>& corners) {
  polygon_.assign(corners.begin(), corners.end());
  // Clips against the table grown by the roundings, so that nothing over the table is cut away.
  const double margin = kFlatSlack * (size_ + reach_);
  for (std::size_t i = 0; i < 3 && !polygon_.empty(); ++i) {
    const Flat edge = (outline_[(i + 1) % 3] - outline_[i]).normalized();
    const auto inward = [&](const Raised& p) { return cross(edge, p.at - outline_[i]) + margin; };
    clipped_.clear();
    for (std::size_t k = 0; k < polygon_.size(); ++k) {
      const Raised& from = polygon_[k];
      const Raised& to = polygon_[(k + 1) % polygon_.size()];
      const double of_from = inward(from);
      const double of_to = inward(to);
      if (of_from >= 0) clipped_.push_back(from);
      if ((of_from < 0) == (of_to < 0)) continue;
      const double share = of_from / (of_from - of_to);
      clipped_.push_back({from.at + share * (to.at - from.at), from.height + share * (to.height - from.height)});
    }
    polygon_.swap(clipped_);
  }
  double height = 0;
  for (const Raised& p : polygon_) height = std::max(height, std::abs(p.height));
  return height;
}

double SheetOverTable::height_at_most(const Triangle& table, std::uint32_t seed) {
  constexpr double kNoBound = std::numeric_limits<double>::infinity();
  if (!set_table(table) || !grow(seed)) return kNoBound;
  int cover_count = 0;
  double height = 0;
  for (const std::array<Raised, 3>& corners : corners_) {
    const int covers = covers_middle(corners);
    if (covers < 0) return kNoBound;
    cover_count += covers;
    height = std::max(height, height_over_table(corners));
  }
  if (cover_count % 2 == 0) return kNoBound;
  // The rim was not tested; it lies within kRim * size of a tested point.
  return height + kRim * size_ + kFlatSlack * (size_ + reach_);
}

}  // namespace collided::engine
