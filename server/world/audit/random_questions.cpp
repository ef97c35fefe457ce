#include "server/world/audit/random_questions.hpp"

#include <limits>
#include <type_traits>

#include "server/world/objects/parts.hpp"

namespace collided::engine {

RandomQuestions::RandomQuestions(const Snapshot& snapshot, std::uint64_t seed) : random_(seed) {
  Aabb world;
  visit_parts(snapshot, [&](ObjectId, std::uint32_t, const auto& shape, const GivenPart&) {
    // A half-space is unbounded, but questions need a bounded region.
    if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, HalfSpace>)
      world.extend(bounds(Sphere{shape.point, 0}));
    else world.extend(bounds(shape));
  });
  if (world.empty()) return;
  size_m_ = (world.high - world.low).norm();
  // At least a millimetre, so that a world of one point has a neighbourhood.
  const Vec3 margin = Vec3::Constant(0.1 * size_m_ + 1e-3);
  low_ = world.low - margin;
  high_ = world.high + margin;
}

Vec3 RandomQuestions::place() {
  const double x = unit();
  const double y = unit();
  return low_ + Vec3(x, y, unit()).cwiseProduct(high_ - low_);
}

std::vector<double> RandomQuestions::question(QuestionKind kind) {
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  const Vec3 p = place();
  switch (kind) {
    case QuestionKind::ray: {
      Vec3 d = place() - p;
      if (d.isZero(0)) d = Vec3::UnitX();
      return {p.x(), p.y(), p.z(), d.x(), d.y(), d.z(), kEndless};
    }
    case QuestionKind::sphere: return {p.x(), p.y(), p.z(), size()};
    case QuestionKind::box: {
      const double x = size();
      const double y = size();
      return {p.x(), p.y(), p.z(), x, y, size(), 1, 0, 0, 0};
    }
    default: return {p.x(), p.y(), p.z(), kEndless};
  }
}

}  // namespace collided::engine
