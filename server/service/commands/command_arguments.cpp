#include "server/service/commands/command_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "idl/outside_text.hpp"
#include "idl/question_rules.hpp"
#include "server/service/questions/nearest_word.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {

using wire_contract::command::ArgumentSpec;
using wire_contract::command::ArgumentType;
using wire_contract::command::CommandForm;
using wire_contract::command::CommandSpec;

namespace {

constexpr const char* kDurable = "durable";

static_assert(wire_contract::kMostCoordinate == 1e290, "the texts below name it");

bool is_coordinate(const nlohmann::json& value) {
  return value.is_number() && wire_contract::is_coordinate(value.get<double>());
}

}  // namespace

Arguments::Arguments(const std::string& text) {
  if (wire_contract::nests_too_deep(text))
    throw BadCommand(fmt::format("a command's text nests deeper than {} levels", wire_contract::kMostJsonDepth));
  arguments_ = nlohmann::json::parse(text, nullptr, false);
  if (!arguments_.is_object()) throw BadCommand("a command's text is not a JSON object");
  const auto command = arguments_.find("command");
  if (command == arguments_.end() || !command->is_string()) throw BadCommand("a command without its name");
  command_ = command->get<std::string>();
  is_durable_ = truth(kDurable);
  spec_ = wire_contract::command::find_command(command_);
  take_form();
}

Arguments::Arguments(const std::string& text, const CommandSpec& spec) : Arguments(text) {
  spec_ = &spec;
  take_form();
}

/// Chooses the form of the command by its first argument that is present and selects a form.
void Arguments::take_form() {
  if (spec_ == nullptr) return;
  const auto is_given = [this](const CommandForm& form) {
    const nlohmann::json* const value = find(form.given);
    return value != nullptr && *value != false;
  };
  const auto form = std::ranges::find_if(spec_->forms, is_given);
  known_ = form != spec_->forms.end() ? form->arguments : spec_->arguments;
}

const nlohmann::json* Arguments::find(const char* name) const {
  const auto found = arguments_.find(name);
  return found == arguments_.end() || found->is_null() ? nullptr : &*found;
}

/// null: this form of the command has no such argument, so it is absent.
const ArgumentSpec* Arguments::specified(const char* name) const {
  const auto known =
      std::ranges::find(known_, std::string_view(name), [](const ArgumentSpec& spec) { return spec.name; });
  return known != known_.end() ? &*known : nullptr;
}

const nlohmann::json* Arguments::find(const char* name, [[maybe_unused]] ArgumentType type) const {
  assert((specified(name) == nullptr || specified(name)->type == type) && "read as another type than it has");
  return find(name);
}

void Arguments::refuse(const char* name, const std::string& allowed) const {
  throw BadCommand(fmt::format(
      "{}: '{}' is {}; allowed: {}", command_, name,
      wire_contract::shown(arguments_[name].dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)), allowed));
}

bool Arguments::is_solid_by_winding() const {
  const std::string by = text("solid_by");
  if (by.empty() || by == "winding") return by == "winding";
  throw BadCommand(fmt::format("{}: solid_by is {}; allowed: 'winding', or nothing", command_, printable(by)));
}

void Arguments::refuse_unknown() const {
  std::vector<std::string> allowed;
  for (const ArgumentSpec& argument : known_) allowed.emplace_back(argument.name);
  if (spec_ != nullptr && spec_->changes_world()) allowed.emplace_back(kDurable);
  for (const auto& [key, value] : arguments_.items()) {
    if (key == "command" || std::find(allowed.begin(), allowed.end(), key) != allowed.end()) continue;
    throw BadCommand(fmt::format("{}: unknown argument {}{}", command_, printable(key), did_you_mean(key, allowed)));
  }
}

bool Arguments::has(const char* name) const { return find(name) != nullptr; }

std::string Arguments::text(const char* name, const std::string& otherwise) const {
  const nlohmann::json* value = find(name, ArgumentType::text);
  if (!value) return otherwise;
  if (!value->is_string()) refuse(name, "text");
  return value->get<std::string>();
}

bool Arguments::truth(const char* name) const {
  const ArgumentSpec* const spec = specified(name);
  return truth_if_given(name).value_or(spec != nullptr && spec->otherwise != 0);
}

std::optional<bool> Arguments::truth_if_given(const char* name) const {
  const nlohmann::json* value = find(name, ArgumentType::truth);
  if (!value) return std::nullopt;
  if (!value->is_boolean()) refuse(name, "true or false");
  return value->get<bool>();
}

double Arguments::number(const char* name) const {
  const nlohmann::json* value = find(name, ArgumentType::number);
  const ArgumentSpec* const spec = specified(name);
  if (!value) return spec != nullptr ? spec->otherwise : 0;
  if (!is_coordinate(*value)) refuse(name, "a number up to 1e290");
  return value->get<double>();
}

std::uint64_t Arguments::whole(const char* name, std::uint64_t most) const {
  const nlohmann::json* value = find(name, ArgumentType::whole);
  const ArgumentSpec* const spec = specified(name);
  if (spec != nullptr) most = std::min(most, spec->most);
  if (!value) return spec != nullptr ? std::min(static_cast<std::uint64_t>(spec->otherwise), most) : 0;
  const bool good = value->is_number_unsigned() || (value->is_number_integer() && value->get<std::int64_t>() >= 0);
  if (!good || value->get<std::uint64_t>() > most) refuse(name, fmt::format("a whole number from 0 to {}", most));
  return value->get<std::uint64_t>();
}

std::vector<std::string> Arguments::texts(const char* name) const {
  constexpr std::size_t kMost = 1'000;
  const nlohmann::json* value = find(name, ArgumentType::texts);
  if (!value) return {};
  const bool good = value->is_array() && value->size() <= kMost &&
                    std::all_of(value->begin(), value->end(), [](const auto& item) { return item.is_string(); });
  if (!good) refuse(name, fmt::format("a list of at most {} texts", kMost));
  return value->get<std::vector<std::string>>();
}

std::optional<Vec3> Arguments::vector(const char* name) const {
  const nlohmann::json* value = find(name, ArgumentType::vector);
  if (!value) return std::nullopt;
  const bool good = value->is_array() && value->size() == 3 && std::all_of(value->begin(), value->end(), is_coordinate);
  if (!good) refuse(name, "three numbers up to 1e290");
  return Vec3((*value)[0].get<double>(), (*value)[1].get<double>(), (*value)[2].get<double>());
}

std::vector<double> Arguments::numbers(const char* name) const {
  const nlohmann::json* value = find(name, ArgumentType::numbers);
  if (!value) return {};
  const bool good = value->is_array() && std::all_of(value->begin(), value->end(), is_coordinate);
  if (!good) refuse(name, "a list of numbers up to 1e290");
  return value->get<std::vector<double>>();
}

std::optional<Pose> Arguments::pose(const char* name) const {
  const nlohmann::json* value = find(name, ArgumentType::pose);
  if (!value) return std::nullopt;
  std::vector<double> numbers;
  if (value->is_array()) {
    for (const nlohmann::json& item : *value) numbers.push_back(item.is_number() ? item.get<double>() : std::nan(""));
  }
  const std::variant<Pose, Refusal> pose = checked_pose(numbers);
  if (const auto* refusal = std::get_if<Refusal>(&pose)) {
    throw BadCommand(fmt::format("{}: '{}': {}", command_, name, refusal->reason),
                     "a pose is [x, y, z, qw, qx, qy, qz]");
  }
  return std::get<Pose>(pose);
}

std::vector<Aabb> Arguments::boxes(const char* name) const {
  constexpr std::size_t kMost = 10'000;
  const nlohmann::json* value = find(name, ArgumentType::boxes);
  if (!value) return {};
  const auto number = [](const nlohmann::json& item) {
    if (item.is_number()) return item.get<double>();
    const bool is_endless = item.is_string() && (item == "inf" || item == "-inf");
    return !is_endless ? std::nan("") : item == "inf" ? HUGE_VAL : -HUGE_VAL;
  };
  const auto wrong = [&] {
    refuse(name, fmt::format("at most {} boxes of six numbers, the lower corner first", kMost));
  };
  if (!value->is_array() || value->size() > kMost) wrong();
  std::vector<Aabb> boxes;
  for (const nlohmann::json& item : *value) {
    if (!item.is_array() || item.size() != 6) wrong();
    const Aabb box{.low = {number(item[0]), number(item[1]), number(item[2])},
                   .high = {number(item[3]), number(item[4]), number(item[5])}};
    if (box.empty()) wrong();
    boxes.push_back(box);
  }
  return boxes;
}

}  // namespace collided::engine::service
