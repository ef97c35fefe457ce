#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_collapse.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

using bvh::Range;

/// Boxes of many sizes, numbered.
std::vector<bvh::Primitive> boxes(std::size_t count, std::mt19937_64& random) {
  std::uniform_real_distribution<float> place(-1, 1);
  std::vector<bvh::Primitive> all(count);
  for (std::size_t i = 0; i < count; ++i) {
    const bvh::Float4 at(place(random), place(random), place(random), 0);
    const float size = 0.3f * std::pow(0.01f, std::abs(place(random)));
    all[i] = {at - size, at + size};
    all[i].low[3] = std::bit_cast<float>(static_cast<std::uint32_t>(i));
  }
  return all;
}

Range over(const std::vector<bvh::Primitive>& primitives) {
  Range range{0, static_cast<std::uint32_t>(primitives.size()), {}, {}};
  for (const bvh::Primitive& primitive : primitives) range.add(primitive);
  return range;
}

/// The least sum of node surfaces, by trying every set of at most eight descendants as a node's children.
class EveryWay {
 public:
  explicit EveryWay(std::vector<bvh::Primitive> primitives) : primitives_(std::move(primitives)) {}

  double least(const Range& range) {
    if (range.size() <= bvh::kWidth) return 0;
    double best = 1e300;
    divide({range}, 0, 0, best);
    return static_cast<double>(range.bounds.half_area()) + best;
  }

 private:
  /// children[next...] may still be cut; what stays as it is was weighed.
  void divide(std::vector<Range> children, std::size_t next, double weighed, double& best) {
    if (weighed >= best) return;
    if (next == children.size()) {
      best = weighed;
      return;
    }
    const Range here = children[next];
    // A node with itself as its only child would never end.
    if (children.size() > 1) divide(children, next + 1, weighed + least(here), best);
    if (children.size() == bvh::kWidth || here.size() <= bvh::kWidth) return;
    bvh::split(primitives_, here, false, children[next], children.emplace_back());
    divide(children, next, weighed, best);
  }

  std::vector<bvh::Primitive> primitives_;
};

double weight(const bvh::Collapse& collapse, int part) {
  if (collapse.is_leaf(part)) return 0;
  int children[bvh::kWidth];
  bvh::Cut cuts[bvh::kWidth];
  double sum = static_cast<double>(collapse.range(part).bounds.half_area());
  for (int i = collapse.children(part, children, cuts); i-- > 0;) sum += weight(collapse, children[i]);
  return sum;
}

TEST(BvhCollapse, NoOtherWayToGatherTheCutsWeighsLess) {
  std::mt19937_64 random = oracle::seeded(3);
  int gained = 0;
  for (int round = 0; round < 20; ++round) {
    std::vector<bvh::Primitive> primitives = boxes(60 + random() % 25, random);
    const Range all = over(primitives);
    const double least = EveryWay(primitives).least(all);
    bvh::Collapse collapse;
    collapse.cut(primitives, all);
    const double found = weight(collapse, bvh::Collapse::kRoot);
    EXPECT_NEAR(found, least, 1e-5 * least);
    gained += least > static_cast<double>(all.bounds.half_area()) ? 1 : 0;
  }
  EXPECT_GT(gained, 10) << "trees of one node have only one way";
}

/// A room full of small boxes.
TriangleMesh furnished(std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(0, 1);
  TriangleMesh mesh = scenes::box({2.5, 2.5, 1.5}, Vec3::Zero());
  for (int i = 0; i < 400; ++i) {
    const double x = 4 * part(random) - 2;
    const double y = 4 * part(random) - 2;
    scenes::append(mesh, scenes::box({0.05, 0.05, 0.05}, {x, y, 2 * part(random) - 1}));
  }
  return mesh;
}

// Every ray from inside meets a wall at the latest, and walls are soon asked.
TEST(BvhOcclusionOrder, AnyHitInARoomAsksTheWallsBeforeTheFurniture) {
  std::mt19937_64 random = oracle::seeded(4);
  std::normal_distribution<double> normal;
  const TriangleMesh mesh = furnished(random);
  const Bvh tree = Bvh::build(mesh, {.threads = 1, .progress = {}, .cancelled = {}});
  WalkCost any;
  WalkCost every;
  constexpr int kRays = 1'000;
  for (int i = 0; i < kRays; ++i) {
    Ray ray;
    ray.origin = Vec3(2 * std::sin(i), 2 * std::cos(3 * i), 1.2 * std::sin(5 * i));
    ray.direction = Vec3(normal(random), normal(random), normal(random));
    ray.length_m = 1e3;
    const auto take = [](std::uint32_t, const Triangle&, double limit) { return limit; };
    Triangle corners;
    EXPECT_NE(tree.meet_ray(ray, std::numeric_limits<double>::infinity(), mesh, take, any, corners), Bvh::kNoTriangle);
    tree.walk_ray(ray, std::numeric_limits<double>::infinity(), 0, mesh, take, every);
  }
  std::printf("steps a ray: any hit %.2f, every hit %.2f\n", any.nodes / double{kRays}, every.nodes / double{kRays});
  EXPECT_LT(any.nodes, 0.5 * every.nodes);
}

}  // namespace
}  // namespace collided::engine
