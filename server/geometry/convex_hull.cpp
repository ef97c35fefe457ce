#include "server/geometry/convex_hull.hpp"

#include <algorithm>
#include <array>

#include "server/geometry/expansion.hpp"
#include "server/geometry/orientation.hpp"

namespace collided::engine {
namespace {

/// The incremental construction; lost_: a sign could not be decided.
class HullBuilder {
 public:
  explicit HullBuilder(std::span<const Vec3> points) : points_(points) {}

  std::optional<TriangleMesh> build();

 private:
  using Face = TriangleCorners;

  int in_front(const Face& face, std::uint32_t point);
  bool begin(std::array<std::uint32_t, 4>& corner);
  void add(std::uint32_t point);
  TriangleMesh packed() const;

  std::span<const Vec3> points_;
  std::vector<Face> faces_;
  std::vector<std::array<std::uint32_t, 2>> rim_;
  bool lost_ = false;
};

int HullBuilder::in_front(const Face& face, std::uint32_t point) {
  const Vec3& a = points_[face[0]];
  const Vec3& b = points_[face[1]];
  const Vec3& c = points_[face[2]];
  const std::optional<int> side = orientation(a, b, c, points_[point]);
  lost_ = lost_ || !side;
  return side.value_or(0);
}

/// Finds four corners that are not in one plane: two that differ, one off their line, one off their plane.
bool HullBuilder::begin(std::array<std::uint32_t, 4>& corner) {
  const auto count = static_cast<std::uint32_t>(points_.size());
  corner[0] = 0;
  std::uint32_t next = 1;
  while (next < count && points_[next] == points_[0]) ++next;
  corner[1] = next;
  // A point is off the line of the first two if they form a triangle with area in some coordinate plane.
  const auto off_line = [&](std::uint32_t point) {
    for (int axis = 0; axis < 3; ++axis) {
      const int i = (axis + 1) % 3;
      const int j = (axis + 2) % 3;
      const auto side = [&](const Vec3& to, int k) { return Expansion(to[k]) - Expansion(points_[0][k]); };
      const Expansion turn =
          side(points_[corner[1]], i) * side(points_[point], j) - side(points_[corner[1]], j) * side(points_[point], i);
      lost_ = lost_ || turn.lost();
      if (!turn.lost() && turn.leading() != 0) return true;
    }
    return false;
  };
  while (next < count && !off_line(next)) ++next;
  if (next >= count) return false;
  corner[2] = next;
  const Face base{corner[0], corner[1], corner[2]};
  while (next < count && in_front(base, next) == 0) ++next;
  if (next >= count) return false;
  corner[3] = next;
  return true;
}

void HullBuilder::add(std::uint32_t point) {
  rim_.clear();
  const auto seen =
      std::partition(faces_.begin(), faces_.end(), [&](const Face& face) { return in_front(face, point) <= 0; });
  for (auto face = seen; face != faces_.end(); ++face) {
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t from = (*face)[e];
      const std::uint32_t to = (*face)[(e + 1) % 3];
      // An edge between two visible faces comes once in each direction.
      const auto twin = std::find(rim_.begin(), rim_.end(), std::array{to, from});
      if (twin == rim_.end()) {
        rim_.push_back({from, to});
      } else {
        *twin = rim_.back();
        rim_.pop_back();
      }
    }
  }
  faces_.erase(seen, faces_.end());
  for (const auto& [from, to] : rim_) faces_.push_back({from, to, point});
}

TriangleMesh HullBuilder::packed() const {
  constexpr std::uint32_t kUnused = 0xffffffff;
  std::vector<std::uint32_t> number(points_.size(), kUnused);
  for (const Face& face : faces_) {
    for (const std::uint32_t corner : face) number[corner] = 0;
  }
  TriangleMesh mesh;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (number[i] == kUnused) continue;
    number[i] = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(points_[i]);
  }
  for (const Face& face : faces_) mesh.triangles.push_back({number[face[0]], number[face[1]], number[face[2]]});
  return mesh;
}

std::optional<TriangleMesh> HullBuilder::build() {
  std::array<std::uint32_t, 4> corner{};
  if (points_.size() < 4 || !begin(corner)) return std::nullopt;
  const auto [a, b, c, d] = corner;
  const bool behind = in_front({a, b, c}, d) < 0;
  faces_ = behind ? std::vector<Face>{{a, b, c}, {a, d, b}, {b, d, c}, {c, d, a}}
                  : std::vector<Face>{{a, c, b}, {a, b, d}, {b, c, d}, {c, a, d}};
  for (std::uint32_t point = 0; point < points_.size() && !lost_; ++point) {
    if (std::find(corner.begin(), corner.end(), point) == corner.end()) add(point);
  }
  if (lost_) return std::nullopt;
  return packed();
}

}  // namespace

std::optional<TriangleMesh> convex_hull(std::span<const Vec3> points) { return HullBuilder(points).build(); }

}  // namespace collided::engine
