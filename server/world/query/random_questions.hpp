#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine {

/// Random questions about a place a tenth larger than a world. The same seed asks the same.
class RandomQuestions {
 public:
  RandomQuestions(const Snapshot& snapshot, std::uint64_t seed);

  /// False: the world is empty, and questions are about the origin.
  bool has_world() const { return size_m_ >= 0; }
  /// The diagonal of the world's bounds.
  double size_m() const { return std::max(size_m_, 0.0); }
  /// The numbers of one question; endless rays and reaches, sizes up to a fiftieth of the diagonal.
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
