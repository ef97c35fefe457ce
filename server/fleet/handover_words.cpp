#include "server/fleet/handover_words.hpp"

#include <nlohmann/json.hpp>

#include "idl/commands.hpp"

namespace collided::engine::service {

using nlohmann::json;

std::string handover_text(const HandoverWords& words) {
  json applied = json::array();
  for (const auto& [publisher, sequence] : words.progress) applied.push_back({publisher, sequence});
  return json{{"command", wire_contract::command::kTakeOver}, {"to", words.to}, {"applied", applied}}.dump();
}

std::optional<HandoverWords> read_handover(std::string_view text) {
  const json read = json::parse(text, nullptr, false);
  if (!read.is_object() || read.value("command", "") != wire_contract::command::kTakeOver) return std::nullopt;
  HandoverWords words;
  const auto to = read.find("to");
  if (to != read.end() && to->is_number_unsigned()) words.to = to->get<std::uint64_t>();
  const auto applied = read.find("applied");
  if (applied == read.end() || !applied->is_array()) return words;
  for (const json& entry : *applied) {
    const bool is_pair =
        entry.is_array() && entry.size() == 2 && entry[0].is_number_unsigned() && entry[1].is_number_unsigned();
    if (is_pair) words.progress.emplace_back(entry[0].get<std::uint64_t>(), entry[1].get<std::uint64_t>());
  }
  return words;
}

}  // namespace collided::engine::service
