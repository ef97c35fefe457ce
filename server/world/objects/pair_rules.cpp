#include "server/world/objects/pair_rules.hpp"

#include <cassert>

#include "idl/glob.hpp"

namespace collided::engine {

PairRules::PairRules(std::vector<PairRule> rules) : rules_(std::move(rules)) {
  assert(rules_.size() <= kMost && "a rule has a bit of 64");
  for (std::size_t i = 0; i < rules_.size(); ++i) allowing_ |= std::uint64_t{rules_[i].allows} << i;
}

RuleFit PairRules::fit_of(std::string_view name) const {
  RuleFit fit;
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    fit.as_a |= std::uint64_t{wire_contract::glob_matches(rules_[i].a, name)} << i;
    fit.as_b |= std::uint64_t{wire_contract::glob_matches(rules_[i].b, name)} << i;
  }
  return fit;
}

}  // namespace collided::engine
