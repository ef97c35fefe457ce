#include "server/world/objects/part_index.hpp"

#include <algorithm>
#include <variant>

#include "server/geometry/aabb.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

// Up to this many, testing each is cheaper than an index.
constexpr std::size_t kFewParts = 16;

/// True if placing the shape errs by no more than the slack of the walks.
bool is_steady(const Primitive& part) {
  return std::holds_alternative<Sphere>(part) || std::holds_alternative<Capsule>(part) ||
         std::holds_alternative<Box>(part);
}

}  // namespace

std::shared_ptr<const IndexedParts> index_parts(std::span<const Primitive> parts) {
  if (parts.size() <= kFewParts || !std::all_of(parts.begin(), parts.end(), is_steady)) return nullptr;
  // The tree needs only bounds of triangles as long as it splits none, so the diagonal of each box represents its
  // primitive.
  TriangleMesh diagonals;
  diagonals.vertices.reserve(2 * parts.size());
  diagonals.triangles.reserve(parts.size());
  auto indexed = std::make_shared<IndexedParts>();
  for (const Primitive& part : parts) {
    const Aabb box = bounds(part);
    const auto first = static_cast<std::uint32_t>(diagonals.vertices.size());
    diagonals.vertices.push_back(box.low);
    diagonals.vertices.push_back(box.high);
    diagonals.triangles.push_back({first, first + 1, first});
    indexed->radius_m = std::max(indexed->radius_m, box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs()).stableNorm());
  }
  indexed->radius_m *= 1 + kChainSlack;
  indexed->tree = Bvh::build(diagonals, {.threads = 1, .progress = {}, .cancelled = {}, .form = BvhForm::fast});
  return indexed;
}

}  // namespace collided::engine
