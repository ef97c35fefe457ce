#include "server/geometry/box_union.hpp"

#include <algorithm>
#include <cstddef>

namespace collided::engine {
namespace {

/// Cuts off the content of each of the other boxes in turn; what remains after the last is outside.
class Cutting {
 public:
  Cutting(std::span<const Aabb> others, const Vec3& from) : others_(others), from_(from) {}

  void look(Aabb part, std::size_t next, int depth) {
    if (nearest_ && distance2(part) >= nearest2_) return;
    for (; next < others_.size() && looks_ > 0 && depth < kDeepest; ++next) {
      --looks_;
      const Aabb& other = others_[next];
      if (!shares_more_than_its_border(part, other)) continue;
      for (int axis = 0; axis < 3; ++axis) {
        cut(part, axis, other.low[axis], true, next + 1, depth);
        cut(part, axis, other.high[axis], false, next + 1, depth);
      }
      return;  // the rest of the part is in the other box
    }
    note(part);
  }
  std::optional<Aabb> take() const { return nearest_; }

 private:
  static constexpr int kDeepest = 1'000;

  /// A closed part that only touches the other box loses nothing to it, because its interior is elsewhere. A flat part
  /// has no interior along its flat axis.
  static bool shares_more_than_its_border(const Aabb& part, const Aabb& other) {
    for (int axis = 0; axis < 3; ++axis) {
      const double low = std::max(part.low[axis], other.low[axis]);
      const double high = std::min(part.high[axis], other.high[axis]);
      if (!(low < high || (low == high && part.low[axis] == part.high[axis]))) return false;
    }
    return true;
  }
  /// Cuts off the part beyond the bound, and searches it separately.
  void cut(Aabb& part, int axis, double bound, bool below, std::size_t next, int depth) {
    if (below ? part.low[axis] >= bound : part.high[axis] <= bound) return;
    Aabb beyond = part;
    (below ? beyond.high : beyond.low)[axis] = bound;
    (below ? part.low : part.high)[axis] = bound;
    look(beyond, next, depth + 1);
  }
  double distance2(const Aabb& part) const { return (nearest_in(part, from_) - from_).squaredNorm(); }
  void note(const Aabb& part) {
    const double distance = distance2(part);
    if (nearest_ && distance >= nearest2_) return;
    nearest_ = part;
    nearest2_ = distance;
  }

  std::span<const Aabb> others_;
  Vec3 from_;
  int looks_ = 100'000;
  std::optional<Aabb> nearest_;
  double nearest2_ = 0;
};

}  // namespace

std::optional<Aabb> nearest_part_outside(const Aabb& box, std::span<const Aabb> others, const Vec3& from) {
  Cutting cutting(others, from);
  cutting.look(box, 0, 0);
  return cutting.take();
}

}  // namespace collided::engine
