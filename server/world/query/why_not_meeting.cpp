#include "server/world/query/why_not_meeting.hpp"

#include <fmt/format.h>

#include <bit>

namespace collided::engine {
namespace {

void add_filter(const ObjectInfo& a, const ObjectInfo& b, std::vector<std::string>& why) {
  if ((a.filter.layers & b.filter.mask) == 0)
    why.push_back(fmt::format("layers {:#x} of '{}' are not in mask {:#x} of '{}'", a.filter.layers, a.name,
                              b.filter.mask, b.name));
  if ((b.filter.layers & a.filter.mask) == 0)
    why.push_back(fmt::format("layers {:#x} of '{}' are not in mask {:#x} of '{}'", b.filter.layers, b.name,
                              a.filter.mask, a.name));
  if (a.filter.group != 0 && a.filter.group == b.filter.group)
    why.push_back(fmt::format("both are of group {}", a.filter.group));
}

void add_allowed_pair(const ObjectInfo& a, const ObjectInfo& b, std::vector<std::string>& why) {
  if (!a.rare->allowed.contain(b.rare->allowed)) return;
  why.push_back(
      a.rare->allowed.pairs->is_every_pair()
          ? fmt::format("both are links of '{}', loaded without an SRDF file: such links never meet", a.rare->scene)
          : fmt::format("scene '{}' allows them to touch, by its SRDF file", a.rare->scene));
}

/// The last matching rule decides.
void add_rule(const PairRules& rules, const ObjectInfo& a, const ObjectInfo& b, std::vector<std::string>& why) {
  const RuleFit fit_a = rules.fit_of(a.name);
  const RuleFit fit_b = rules.fit_of(b.name);
  if (!rules.allows(fit_a, fit_b)) return;
  const std::uint64_t fitting = (fit_a.as_a & fit_b.as_b) | (fit_a.as_b & fit_b.as_a);
  const PairRule& rule = rules.rules()[static_cast<std::size_t>(std::bit_width(fitting)) - 1];
  why.push_back(fmt::format("rule '{}' '{}' allows them to touch{}", rule.a, rule.b,
                            rule.because.empty() ? "" : ": " + rule.because));
}

}  // namespace

std::vector<std::string> why_not_meeting(const Snapshot& snapshot, ObjectId a, ObjectId b) {
  const ObjectInfo& first = *snapshot.objects[slot_of(a)];
  const ObjectInfo& second = *snapshot.objects[slot_of(b)];
  std::vector<std::string> why;
  if (!first.moving && !second.moving) why.emplace_back("neither of them moves");
  add_filter(first, second, why);
  add_allowed_pair(first, second, why);
  if (snapshot.pair_rules) add_rule(*snapshot.pair_rules, first, second, why);
  return why;
}

}  // namespace collided::engine
