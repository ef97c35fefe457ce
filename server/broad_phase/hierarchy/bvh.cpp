#include "server/broad_phase/hierarchy/bvh.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "server/broad_phase/hierarchy/bvh_build.hpp"
#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/broad_phase/hierarchy/bvh_near_pairs.hpp"
#include "server/broad_phase/hierarchy/bvh_pairs.hpp"
#include "server/broad_phase/hierarchy/bvh_saved.hpp"
#include "server/broad_phase/hierarchy/bvh_threads.hpp"
#include "server/broad_phase/hierarchy/bvh_walk.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {

struct Bvh::Storage {
  bvh::Layout layout;
  BvhReport report;
  Aabb bounds;
};

Bvh::Bvh() : storage_(std::make_unique<Storage>()) {}
Bvh::~Bvh() = default;
Bvh::Bvh(Bvh&&) noexcept = default;
Bvh& Bvh::operator=(Bvh&&) noexcept = default;

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

Aabb vertex_bounds(const TriangleMesh& mesh) {
  Aabb bounds;
  for (const Vec3& vertex : mesh.vertices) bounds.extend(vertex);
  return bounds;
}

}  // namespace

Bvh Bvh::build(const TriangleMesh& mesh, const BvhOptions& options) {
  const auto start = Clock::now();
  Bvh tree;
  Storage& storage = *tree.storage_;
  storage.layout = bvh::build_layout(mesh, options, storage.report);
  if (storage.layout.root != bvh::kNothing) storage.bounds = vertex_bounds(mesh);
  storage.report.build_s = seconds_since(start);
  return tree;
}

std::vector<std::byte> Bvh::saved(const TriangleMesh& mesh) const {
  return storage_->layout.root == bvh::kNothing ? std::vector<std::byte>{} : bvh::save(storage_->layout, mesh);
}

std::variant<Bvh, BvhRefusal> Bvh::load(const TriangleMesh& mesh, std::span<const std::byte> bytes,
                                        std::shared_ptr<const void> keeper, unsigned threads) {
  const auto start = Clock::now();
  Bvh tree;
  Storage& storage = *tree.storage_;
  std::string flaw =
      bvh::load(mesh, bytes, std::move(keeper), bvh::thread_count(threads), storage.layout, storage.report);
  if (!flaw.empty()) return BvhRefusal{std::move(flaw)};
  storage.bounds = vertex_bounds(mesh);
  storage.report.is_loaded = true;
  storage.report.build_s = seconds_since(start);
  return tree;
}

const BvhReport& Bvh::report() const { return storage_->report; }
const Aabb& Bvh::bounds() const { return storage_->bounds; }

void Bvh::walk_ray(const Ray& ray, double limit, double slack_m, RayCandidate candidate, WalkCost& cost) const {
  const bvh::Layout& layout = storage_->layout;
  if (layout.root == bvh::kNothing || !(limit >= 0)) return;
  bvh::walk_ray(layout, ray, limit, slack_m, candidate, cost);
}

void Bvh::walk_ray(const Ray& ray, double limit, double slack_m, const TriangleMesh& mesh, RayTriangle candidate,
                   WalkCost& cost) const {
  const bvh::Layout& layout = storage_->layout;
  if (layout.root == bvh::kNothing || !(limit >= 0)) return;
  bvh::walk_ray(layout, ray, limit, slack_m, mesh, candidate, cost);
}

void Bvh::walk_ray_nearest(const Ray& ray, double limit, const TriangleMesh& mesh, RayTriangle candidate,
                           WalkCost& cost) const {
  const bvh::Layout& layout = storage_->layout;
  if (layout.root == bvh::kNothing || !(limit >= 0)) return;
  bvh::walk_ray_nearest(layout, ray, limit, mesh, candidate, cost);
}

std::uint32_t Bvh::meet_ray(const Ray& ray, double limit, const TriangleMesh& mesh, RayTriangle candidate,
                            WalkCost& cost, Triangle& corners) const {
  const bvh::Layout& layout = storage_->layout;
  if (layout.root == bvh::kNothing || !(limit >= 0)) return kNoTriangle;
  return bvh::meet_ray(layout, ray, limit, mesh, candidate, cost, corners);
}

void Bvh::walk_rays(std::span<RayTask> tasks, const TriangleMesh& mesh, RayGoal goal) const {
  const bvh::Layout& layout = storage_->layout;
  if (layout.root != bvh::kNothing) bvh::walk_rays(layout, tasks, mesh, goal);
}

void Bvh::walk_box(const Aabb& asked, BoxCandidate candidate, WalkCost& cost) const {
  const bvh::Layout& layout = storage_->layout;
  if (layout.root == bvh::kNothing || asked.empty()) return;
  bvh::walk_box(layout, bvh::local_box(layout.frame, asked), candidate, cost);
}

void Bvh::walk_near(const Vec3& point, double limit_m2, double slack_m, NearCandidate candidate, WalkCost& cost) const {
  const bvh::Layout& layout = storage_->layout;
  if (layout.root == bvh::kNothing || !(limit_m2 >= 0)) return;
  bvh::walk_near(layout, bvh::local_point(layout.frame, point, slack_m), limit_m2, candidate, cost);
}

void Bvh::walk_pairs(const Bvh& other, const Mat3& rotation, const Vec3& position, double slack_m,
                     PairCandidate candidate, WalkCost& cost) const {
  const auto never = [] { return false; };
  walk_pairs(other, rotation, position, slack_m, candidate, never, cost);
}

void Bvh::walk_pairs(const Bvh& other, const Mat3& rotation, const Vec3& position, double slack_m,
                     PairCandidate candidate, Interrupt is_over, WalkCost& cost) const {
  const bvh::Layout& own = storage_->layout;
  const bvh::Layout& others = other.storage_->layout;
  if (own.root == bvh::kNothing || others.root == bvh::kNothing) return;
  // Scales are inverse to sizes: the smaller tree is placed in the larger.
  const bool swapped = own.frame.scale_exponent > others.frame.scale_exponent;
  bvh::PairFrame frame;
  bvh::PairCase found;
  if (swapped) {
    // Covers the rounding of the inverse placement, and the slack along the other axes.
    const double turned_slack_m = 2 * slack_m + 0x1p-48 * position.lpNorm<1>();
    const Mat3 back = rotation.transpose();
    found = bvh::prepare_pairs(others, own, back, -(back * position), turned_slack_m, frame);
  } else {
    found = bvh::prepare_pairs(own, others, rotation, position, slack_m, frame);
  }
  if (found == bvh::PairCase::odd) return pair_all(other, rotation, position, slack_m, candidate, cost);
  if (found == bvh::PairCase::apart) return;
  if (swapped) {
    bvh::walk_pairs(others, own, frame, true, candidate, is_over, cost);
  } else {
    bvh::walk_pairs(own, others, frame, false, candidate, is_over, cost);
  }
}

void Bvh::walk_near_pairs(const Bvh& other, const Mat3& rotation, const Vec3& position, double slack_m, double limit_m,
                          NearPairCandidate candidate, Interrupt is_over, WalkCost& cost) const {
  const bvh::Layout& own = storage_->layout;
  const bvh::Layout& others = other.storage_->layout;
  if (own.root == bvh::kNothing || others.root == bvh::kNothing || !(limit_m >= 0)) return;
  bvh::NearPairFrame frame;
  if (bvh::prepare_near_pairs(own, others, rotation, position, slack_m, frame)) {
    bvh::walk_near_pairs(own, others, frame, limit_m, candidate, is_over, cost);
    return;
  }
  const auto any = [&](std::uint32_t triangle, std::uint32_t other_triangle) {
    if (is_over()) return false;
    limit_m = candidate(triangle, other_triangle, limit_m);
    return limit_m >= 0;
  };
  pair_all(other, rotation, position, std::numeric_limits<double>::infinity(), any, cost);
}

/// The fallback: pairs every triangle near the other's bounds with all of the other's.
void Bvh::pair_all(const Bvh& other, const Mat3& rotation, const Vec3& position, double slack_m,
                   PairCandidate candidate, WalkCost& cost) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Aabb everything{.low = Vec3::Constant(-kInfinity), .high = Vec3::Constant(kInfinity)};
  const Aabb& placed = other.bounds();
  const Vec3 middle = placed.low / 2 + placed.high / 2;
  const Vec3 half = (placed.high - middle).cwiseMax(middle - placed.low);
  const Vec3 center = rotation * middle + position;
  const double rounding = 0x1p-48 * (2 * (middle.lpNorm<1>() + half.lpNorm<1>()) + position.lpNorm<1>()) +
                          std::numeric_limits<double>::min();
  const Vec3 reach = rotation.cwiseAbs() * half + Vec3::Constant(slack_m + rounding);
  Aabb near{.low = center - reach, .high = center + reach};
  if (!near.low.allFinite() || !near.high.allFinite()) near = everything;
  const auto outer = [&](std::uint32_t triangle) {
    bool go_on = true;
    const auto inner = [&](std::uint32_t other_triangle) { return go_on = candidate(triangle, other_triangle); };
    other.walk_box(everything, inner, cost);
    return go_on;
  };
  walk_box(near, outer, cost);
}

}  // namespace collided::engine
