#include "client/library/shards/shard_holdings.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "idl/commands.hpp"

namespace collided::client {
namespace {

using nlohmann::json;

std::optional<json> list_of(Client& shard, const std::string& glob, std::uint64_t most) {
  const Result<std::string> answer =
      shard.command(wire_contract::command::kList, json{{"name", glob}, {"limit", most}}.dump());
  if (!answer) return std::nullopt;
  json said = json::parse(*answer, nullptr, false);
  if (!said.is_object()) return std::nullopt;
  return said;
}

}  // namespace

std::optional<bool> has_object(Client& shard, const std::string& name) {
  constexpr std::uint64_t kMostAlike = 100'000;
  // What means something in a glob stands for any letter, and then the names are compared.
  std::string glob = name;
  std::ranges::replace_if(
      glob, [](char letter) { return letter == '*' || letter == '['; }, '?');
  const std::optional<json> said = list_of(shard, glob, kMostAlike);
  if (!said) return std::nullopt;
  return std::ranges::any_of(said->value("objects", json::array()),
                             [&](const json& object) { return object.value("name", std::string()) == name; });
}

std::optional<std::uint64_t> count_of_group(Client& shard, const std::string& group) {
  const std::optional<json> named = list_of(shard, group, 0);
  const std::optional<json> of_scene = list_of(shard, group + "/*", 0);
  if (!named || !of_scene) return std::nullopt;
  return named->value("count", std::uint64_t{0}) + of_scene->value("count", std::uint64_t{0});
}

}  // namespace collided::client
