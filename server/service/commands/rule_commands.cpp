#include <fmt/format.h>

#include <algorithm>

#include "idl/answers/commands.hpp"
#include "idl/described_json.hpp"
#include "idl/glob.hpp"
#include "server/service/commands/command_family.hpp"
#include "server/service/questions/validation.hpp"

// Pairs of objects that are allowed to touch.
namespace collided::engine::service {

using nlohmann::json;
namespace names = wire_contract::command;

namespace {

/// The two globs of a command; throws BadCommand.
PairRule rule_of(const Arguments& arguments) {
  const PairRule rule{.a = arguments.text("a"), .b = arguments.text("b"), .because = arguments.text("because")};
  for (const std::string* glob : {&rule.a, &rule.b}) {
    if (!is_good_name(*glob))
      throw BadCommand(fmt::format("{}: the name pattern {} is empty, longer than 255 bytes or not text",
                                   arguments.command(), printable(*glob)));
  }
  return rule;
}

void erase_same(std::vector<PairRule>& rules, const PairRule& rule) {
  std::erase_if(rules, [&](const PairRule& other) {
    return (other.a == rule.a && other.b == rule.b) || (other.a == rule.b && other.b == rule.a);
  });
}

std::size_t count_matching(const World& world, const std::string& glob) {
  return static_cast<std::size_t>(std::ranges::count_if(
      world.objects(), [&](const auto& info) { return info && wire_contract::glob_matches(glob, info->name); }));
}

class RuleCommands : public CommandFamily {
 public:
  using CommandFamily::CommandFamily;
  std::vector<BoundCommand> commands() override;

 private:
  json allow(const Arguments& arguments);
  json deny(const Arguments& arguments);
  json allowed() const;  // on the asking thread
  json change_rules(const PairRule& changed, std::vector<PairRule> rules);
};

}  // namespace

std::unique_ptr<CommandFamily> rule_commands(CommandContext& context) {
  return std::make_unique<RuleCommands>(context);
}

std::vector<BoundCommand> RuleCommands::commands() {
  return {on_world_thread(names::kAllow, this, &RuleCommands::allow),
          on_world_thread(names::kDeny, this, &RuleCommands::deny),
          on_asking_thread(names::kAllowed, this, &RuleCommands::allowed)};
}

/// Puts the rules into the world and into the inventory.
json RuleCommands::change_rules(const PairRule& changed, std::vector<PairRule> rules) {
  World& world = with_.loop.world();
  if (rules.size() > PairRules::kMost)
    throw BadCommand(fmt::format("{} rules are there already, the limit", PairRules::kMost),
                     "deny takes one back; a glob covers many objects");
  const auto key = [](std::size_t place) { return KeptKey{KeptKind::rule, fmt::format("{:02}", place)}; };
  for (std::size_t i = rules.size(); i < world.pair_rules().size(); ++i) with_.inventory.erase(key(i));
  for (std::size_t i = 0; i < rules.size(); ++i) {
    const char* command = rules[i].allows ? names::kAllow : names::kDeny;
    json text{{"command", command}, {"a", rules[i].a}, {"b", rules[i].b}};
    if (!rules[i].because.empty()) text["because"] = rules[i].because;
    keep(key(i), {0, 0, text.dump(), {}});
  }
  const std::size_t count = rules.size();
  world.set_pair_rules(std::move(rules));
  return json_of(RuleChanged{.rules = count,
                             .a_count = count_matching(world, changed.a),
                             .b_count = count_matching(world, changed.b),
                             .version = step()});
}

json RuleCommands::allow(const Arguments& arguments) {
  const PairRule rule = rule_of(arguments);
  std::vector<PairRule> rules = with_.loop.world().pair_rules();
  erase_same(rules, rule);
  rules.push_back(rule);
  json answer = change_rules(rule, std::move(rules));
  answer["ended"] = ended_count();
  return answer;
}

json RuleCommands::deny(const Arguments& arguments) {
  PairRule rule = rule_of(arguments);
  std::vector<PairRule> rules = with_.loop.world().pair_rules();
  erase_same(rules, rule);
  rule.allows = false;
  // If nothing else is allowed there is nothing to revoke.
  if (std::ranges::any_of(rules, &PairRule::allows)) rules.push_back(rule);
  json answer = change_rules(rule, std::move(rules));
  const auto& events = with_.loop.world().events();
  answer["began"] = std::ranges::count(events, EventKind::began, &Event::kind);
  return answer;
}

json RuleCommands::allowed() const {
  const SnapshotRing::Lease state = with_.loop.world().newest();
  std::vector<ListedRule> rules;
  if (state->pair_rules) {
    for (const PairRule& rule : state->pair_rules->rules())
      rules.push_back({.a = rule.a, .b = rule.b, .because = rule.because, .allows = rule.allows});
  }
  return {{"rules", json_of(rules)}, {"version", state->version}};
}

}  // namespace collided::engine::service
