#include "client/keys/rights.hpp"

#include <algorithm>
#include <array>

namespace collided::keys {
namespace {

using namespace wire_contract;

constexpr std::array kRoles{KeyRole::server, KeyRole::standby, KeyRole::publisher,
                            KeyRole::asker,  KeyRole::watcher, KeyRole::admin};
constexpr std::array kNames{"server", "standby", "publisher", "asker", "watcher", "admin"};

void add(std::set<std::string>& topics, std::initializer_list<const TopicQos*> rows) {
  for (const TopicQos* row : rows) topics.insert(row->suffix);
}

void add_server(TopicRights& rights) {
  add(rights.read, {&kQueryTopic, &kObjectTopic, &kPoseTopic, &kStatusTopic, &kMemberTopic});
  add(rights.write,
      {&kMemberTopic, &kChangeTopic, &kReplyTopic, &kStatusTopic, &kStepTopic, &kEventTopic, &kContactTopic,
       &kPersistedTopic, &kWatermarkTopic, &kProbeTopic, &kStandingEventTopic, &kStandingStateTopic});
}

void add_client(TopicRights& rights) {
  rights.queries.insert(QueryRight::greet);
  add(rights.read, {&kReplyTopic, &kStatusTopic, &kMemberTopic});
}

void add_watching(TopicRights& rights) {
  add(rights.read, {&kStepTopic, &kEventTopic, &kContactTopic, &kPersistedTopic, &kWatermarkTopic, &kProbeTopic,
                    &kStandingEventTopic, &kStandingStateTopic});
}

/// Including the content of a recording.
void add_everything(TopicRights& rights) {
  add_client(rights);
  add_watching(rights);
  rights.queries.insert(kQueryRights.begin(), kQueryRights.end());
  add(rights.write, {&kObjectTopic, &kPoseTopic});
  add(rights.read, {&kQueryTopic, &kObjectTopic, &kPoseTopic});
}

void add_role(TopicRights& rights, KeyRole role) {
  switch (role) {
    case KeyRole::server: return add_server(rights);
    case KeyRole::standby:
      add_server(rights);
      add(rights.read, {&kChangeTopic});
      return add_watching(rights);
    case KeyRole::publisher: add_client(rights); return add(rights.write, {&kObjectTopic, &kPoseTopic});
    case KeyRole::asker:
      add_client(rights);
      rights.queries.insert(QueryRight::ask);
      return;
    case KeyRole::watcher: add_client(rights); return add_watching(rights);
    case KeyRole::admin: return add_everything(rights);
  }
}

}  // namespace

std::string_view name_of(KeyRole role) { return kNames[static_cast<std::size_t>(role)]; }

std::optional<KeyRole> role_of(std::string_view name) {
  const auto found = std::ranges::find(kNames, name);
  if (found == kNames.end()) return std::nullopt;
  return kRoles[static_cast<std::size_t>(found - kNames.begin())];
}

std::span<const KeyRole> all_roles() { return kRoles; }

TopicRights rights_of(std::span<const KeyRole> roles) {
  TopicRights rights;
  for (const KeyRole role : roles) add_role(rights, role);
  return rights;
}

}  // namespace collided::keys
