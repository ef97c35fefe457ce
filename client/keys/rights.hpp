#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "idl/topics.hpp"

namespace collided::keys {

/// The roles in a world. They add up.
enum class KeyRole { server, standby, publisher, asker, watcher, admin };
std::string_view name_of(KeyRole role);
/// None if no role has the name.
std::optional<KeyRole> role_of(std::string_view name);
std::span<const KeyRole> all_roles();

/// A set of topics by their place in the namespace, and the rights on the topic of queries.
struct TopicRights {
  std::set<std::string> write;
  std::set<std::string> read;
  std::set<wire_contract::QueryRight> queries;
};
/// What the roles may write and read: the table in deploy/docs/roles.md.
TopicRights rights_of(std::span<const KeyRole> roles);

}  // namespace collided::keys
