#include "server/service/self_test.hpp"

#include <cmath>
#include <random>

#include "server/world/audit.hpp"
#include "server/world/parts.hpp"

namespace collided::service {
namespace {

using wire_contract::QueryKind;

/// Asks questions about a place a little larger than the world.
class Examiner {
 public:
  Examiner(const Snapshot& snapshot, std::uint64_t seed) : snapshot_(snapshot), random_(seed) {
    Aabb world;
    visit_parts(snapshot, [&](ObjectId, std::uint32_t, const auto& shape) { world.extend(bounds(shape)); });
    if (world.empty()) world.extend(Vec3::Zero());
    const Vec3 margin = Vec3::Constant(0.1 * (world.high - world.low).norm() + 1e-3);
    low_ = world.low - margin;
    high_ = world.high + margin;
  }
  void ask_ray();
  void ask_sphere();
  void ask_box();
  void ask_near();
  SelfTestResult result;

 private:
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  Vec3 place() { return low_ + Vec3(unit(), unit(), unit()).cwiseProduct(high_ - low_); }
  double size() { return (high_ - low_).norm() * 0.05 * unit(); }
  void ask(QueryKind kind, const std::vector<double>& numbers);

  const Snapshot& snapshot_;
  std::mt19937_64 random_;
  Vec3 low_;
  Vec3 high_;
  Answers answers_;
  QueryScratch scratch_;
};

void Examiner::ask(QueryKind kind, const std::vector<double>& numbers) {
  constexpr std::size_t kMostTold = 5;
  const Questions question{.kind = kind, .max_hits = kind == QueryKind::near ? 3U : 0xffffffffU, .numbers = numbers};
  answer(snapshot_, question, answers_, scratch_);
  const std::string difference = audit(snapshot_, question, answers_);
  ++result.asked;
  if (difference.empty()) ++result.equal;
  else if (result.differences.size() < kMostTold) result.differences.push_back(difference);
}

void Examiner::ask_ray() {
  const Vec3 origin = place();
  const Vec3 direction = place() - origin;
  if (direction.isZero()) return;
  ask(QueryKind::ray, {origin.x(), origin.y(), origin.z(), direction.x(), direction.y(), direction.z(), INFINITY});
}

void Examiner::ask_sphere() {
  const Vec3 center = place();
  ask(QueryKind::sphere, {center.x(), center.y(), center.z(), size()});
}

void Examiner::ask_box() {
  const Vec3 center = place();
  ask(QueryKind::box, {center.x(), center.y(), center.z(), size(), size(), size(), 1, 0, 0, 0});
}

void Examiner::ask_near() {
  const Vec3 point = place();
  ask(QueryKind::near, {point.x(), point.y(), point.z(), INFINITY});
}

}  // namespace

SelfTestResult self_test(const Snapshot& snapshot, std::uint32_t question_count, std::uint64_t seed) {
  Examiner examiner(snapshot, seed);
  for (std::uint32_t i = 0; i < question_count; ++i) {
    examiner.ask_ray();
    examiner.ask_sphere();
    examiner.ask_box();
    examiner.ask_near();
  }
  return examiner.result;
}

}  // namespace collided::service
