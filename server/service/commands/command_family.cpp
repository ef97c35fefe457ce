#include "server/service/commands/command_family.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "server/service/questions/validation.hpp"

namespace collided::engine::service {

void CommandFamily::refuse_if_foreign(const CommandAsk& ask, std::string_view object, const char* not_done) {
  if (!ask.from.peer || ask.from.peer->may_name(object)) return;
  throw BadCommand(fmt::format("the keys of '{}' are not for object {}. Nothing was {}", ask.from.peer->name,
                               printable(object), not_done));
}

const ObjectInfo* CommandFamily::foreign_in_scene(const CommandAsk& ask, std::string_view scene) const {
  if (!ask.from.peer) return nullptr;
  for (const auto& info : with_.loop.world().objects()) {
    if (info && info->rare->scene == scene && !ask.from.peer->may_name(info->name)) return info.get();
  }
  return nullptr;
}

void CommandFamily::keep(KeptKey key, const CommandAsk& ask, std::uint64_t owner) {
  using enum Inventory::Turn;
  with_.inventory.put({.key = std::move(key), .text = ask.text, .blob = ask.blob, .owner = owner},
                      ask.is_carried_out_again() ? again : first);
}

std::uint64_t CommandFamily::step() {
  with_.loop.note_change();
  with_.loop.step_now();
  return with_.loop.world().newest()->version;
}

std::uint32_t CommandFamily::ended_count() const {
  const auto& events = with_.loop.world().events();
  return static_cast<std::uint32_t>(
      std::count_if(events.begin(), events.end(), [](const Event& event) { return event.kind == EventKind::ended; }));
}

}  // namespace collided::engine::service
