#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine {

/// Random questions about a region a tenth larger than the world. The same seed gives the same questions.
class RandomQuestions {
 public:
  RandomQuestions(const Snapshot& snapshot, std::uint64_t seed);

  /// False if the world is empty; then all questions are about the origin.
  bool has_world() const { return size_m_ >= 0; }
  /// The diagonal of the world's bounds, metres; 0 for an empty world.
  double size_m() const { return std::max(size_m_, 0.0); }
  /// The numbers of one question: unlimited rays and reaches, sizes up to a fiftieth of the diagonal.
  std::vector<double> question(QuestionKind kind);

 private:
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  Vec3 place();
  double size() { return 0.02 * size_m() * unit(); }

  std::mt19937_64 random_;
  double size_m_ = -1;
  Vec3 low_ = Vec3::Zero();
  Vec3 high_ = Vec3::Zero();
};

}  // namespace collided::engine
