#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace collided::engine {

/// Whether pairs of objects may touch: pairs with one name that matches the first glob and one that matches the second.
struct PairRule {
  std::string a;
  std::string b;
  std::string because;  // reason, for people
  bool allows = true;   // false: earlier rules that allow such a pair no longer apply to it
};

/// Which rules a name matches, as the first of a pair and as the second; one bit per rule.
struct RuleFit {
  std::uint64_t as_a = 0;
  std::uint64_t as_b = 0;
};

/// Rules for pairs that are allowed to touch, in addition to masks and groups: the last one that matches a pair
/// decides. Immutable.
class PairRules {
 public:
  static constexpr std::size_t kMost = 64;

  PairRules() = default;
  /// rules  at most kMost
  explicit PairRules(std::vector<PairRule> rules);

  const std::vector<PairRule>& rules() const { return rules_; }
  bool empty() const { return rules_.empty(); }
  RuleFit fit_of(std::string_view name) const;
  bool allows(const RuleFit& a, const RuleFit& b) const {
    const std::uint64_t fitting = (a.as_a & b.as_b) | (a.as_b & b.as_a);
    return (std::bit_floor(fitting) & allowing_) != 0;
  }

 private:
  std::vector<PairRule> rules_;
  std::uint64_t allowing_ = 0;
};

}  // namespace collided::engine
