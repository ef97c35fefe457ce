#pragma once

#include <algorithm>
#include <string>

#include <nlohmann/json.hpp>

#include "idl/command_table.hpp"

namespace collided::test {

inline bool is_of_type(const nlohmann::json& value, wire_contract::command::ArgumentType type) {
  using enum wire_contract::command::ArgumentType;
  const auto are_all = [&](auto is) { return value.is_array() && std::ranges::all_of(value, is); };
  const auto is_number = [](const nlohmann::json& one) { return one.is_number(); };
  switch (type) {
    case text: return value.is_string();
    case texts: return are_all([](const nlohmann::json& one) { return one.is_string(); });
    case truth: return value.is_boolean();
    case whole: return value.is_number_unsigned() || (value.is_number_integer() && value >= 0);
    case number: return value.is_number();
    case numbers: return are_all(is_number);
    case vector: return are_all(is_number) && value.size() == 3;
    case pose: return are_all(is_number) && value.size() == 7;
    case boxes: return value.is_array();
  }
  return false;
}

/// The first argument that a server refuses since the command's table has none of that name and type; empty: there is none.
inline std::string unknown_argument(const std::string& command, const nlohmann::json& arguments) {
  const wire_contract::command::CommandSpec* const spec = wire_contract::command::find_command(command);
  if (spec == nullptr) return {};
  const auto form = std::ranges::find_if(
      spec->forms, [&](const auto& one) { return arguments.contains(one.given) && arguments[one.given] != false; });
  const auto known = form != spec->forms.end() ? form->arguments : spec->arguments;
  for (const auto& [name, value] : arguments.items()) {
    if (name == "command" || (name == "durable" && spec->changes_world()) || value.is_null()) continue;
    const auto found = std::ranges::find(known, name, [](const auto& argument) { return std::string(argument.name); });
    if (found == known.end() || !is_of_type(value, found->type)) return command + ": " + name + " " + value.dump();
  }
  return {};
}

}  // namespace collided::test
