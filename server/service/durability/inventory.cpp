#include "server/service/durability/inventory.hpp"

#include <array>
#include <nlohmann/json.hpp>

#include "idl/commands.hpp"

namespace collided::engine::service {
namespace {

/// By kind. The journal's keys begin with these.
constexpr std::array<std::string_view, 12> kKeyStems{"cleared/",      "scene/",    "gone/",       "object/",
                                                     "member_moved/", "moved/",    "probe/",      "fence/",
                                                     "rule/",         "attached/", "succession/", "published/"};

bool is_of_member(KeptKind kind) { return kind == KeptKind::gone || kind == KeptKind::member_moved; }

}  // namespace

std::optional<KeptKey> KeptKey::parse(std::string_view text) {
  for (std::size_t i = 0; i < kKeyStems.size(); ++i) {
    if (text.starts_with(kKeyStems[i]))
      return KeptKey{static_cast<KeptKind>(i), std::string(text.substr(kKeyStems[i].size()))};
  }
  return std::nullopt;
}

std::string KeptKey::text() const { return std::string(kKeyStems[static_cast<std::size_t>(kind)]) + name; }

std::string KeptKey::scene() const { return is_of_member(kind) ? name.substr(0, name.find('\n')) : std::string(); }

std::size_t KeptCommand::bytes() const {
  constexpr std::size_t kOverhead = 150;  // of the maps
  return 2 * key.name.size() + text.size() + blob.size() + kOverhead;
}

void KeptCommands::put(KeptCommand command) {
  const auto [known, is_new] = numbers_.try_emplace(command.key, put_);
  put_ += is_new ? 1 : 0;
  KeptCommand& place = commands_[{command.key.kind, known->second}];
  bytes_ -= is_new ? 0 : place.bytes();
  place = std::move(command);
  bytes_ += place.bytes();
}

bool KeptCommands::erase(const KeptKey& key) {
  const auto known = numbers_.find(key);
  if (known == numbers_.end()) return false;
  const auto place = commands_.find({key.kind, known->second});
  bytes_ -= place->second.bytes();
  commands_.erase(place);
  numbers_.erase(known);
  return true;
}

std::vector<KeptKey> KeptCommands::members_of(const std::string& scene) const {
  std::vector<KeptKey> members;
  for (const KeptKind kind : {KeptKind::gone, KeptKind::member_moved}) {
    const KeptKey first = KeptKey::of_member(kind, scene, "");
    for (auto at = numbers_.lower_bound(first); at != numbers_.end(); ++at) {
      if (at->first.kind != kind || !at->first.name.starts_with(first.name)) break;
      members.push_back(at->first);
    }
  }
  return members;
}

void Inventory::put(const KeptCommand& command, Turn turn) {
  if (turn == Turn::first) {
    const KeptKey& key = command.key;
    if (key.kind == KeptKind::scene) erase_members(key.name);
    if (key.kind == KeptKind::object) forget({KeptKind::moved, key.name});
    if (key.kind == KeptKind::gone) forget_moves_and_attachments(key);
  }
  kept_.put(command);
  put_.put(command);
}

void Inventory::erase(const KeptKey& key) {
  forget(key);
  if (key.kind == KeptKind::object) forget_moves_and_attachments(key);
  if (key.kind != KeptKind::scene) return;
  erase_members(key.name);
  if (!start_scenes_.contains(key.name)) return;
  const nlohmann::json again{{"command", wire_contract::command::kClear}, {"scene", key.name}};
  put({.key = {KeptKind::cleared, key.name}, .text = again.dump()});
}

void Inventory::erase_members(const std::string& scene) {
  for (const KeptKey& member : kept_.members_of(scene)) forget(member);
}

void Inventory::forget(const KeptKey& key) {
  // Only the flight recorder knows which objects a publisher has.
  if (!kept_.erase(key) && key.kind != KeptKind::published) return;
  put_.erase(key);
  erased_.push_back(key);
}

/// An attachment that waits for its parent must not apply to a later object of this name.
void Inventory::forget_moves_and_attachments(const KeptKey& key) {
  forget({is_of_member(key.kind) ? KeptKind::member_moved : KeptKind::moved, key.name});
  forget({KeptKind::attached, is_of_member(key.kind) ? key.name.substr(key.name.find('\n') + 1) : key.name});
}

Inventory::Changes Inventory::flush(std::uint64_t client, std::uint64_t request) {
  Changes changes{.erased = std::exchange(erased_, {}), .put = {}, .client = client, .request = request};
  std::exchange(put_, {}).for_each([&](const KeptCommand& command) { changes.put.push_back(command); });
  for (const Sink& sink : sinks_) sink(changes);
  return changes;
}

}  // namespace collided::engine::service
