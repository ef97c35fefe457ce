#include "client/fleet/shards/shard_holdings.hpp"

#include <algorithm>

namespace collided::client {

std::optional<bool> has_object(Client& shard, const std::string& name) {
  constexpr std::uint64_t kMostAlike = 100'000;
  // What means something in a glob stands for any letter, and then the names are compared.
  std::string glob = name;
  std::ranges::replace_if(
      glob, [](char letter) { return letter == '*' || letter == '['; }, '?');
  const Result<ObjectList> list = shard.list({.name = glob, .limit = kMostAlike});
  if (!list) return std::nullopt;
  return std::ranges::any_of(list->objects, [&](const ListedObject& object) { return object.name == name; });
}

std::optional<std::uint64_t> count_of_group(Client& shard, const std::string& group) {
  const Result<ObjectList> named = shard.list({.name = group, .limit = 0});
  const Result<ObjectList> of_scene = shard.list({.name = group + "/*", .limit = 0});
  if (!named || !of_scene) return std::nullopt;
  return named->count + of_scene->count;
}

}  // namespace collided::client
