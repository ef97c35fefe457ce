#include "server/service/recording/flight_commands.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "idl/command_table.hpp"
#include "idl/glob.hpp"

namespace collided::engine::service {
namespace {

using nlohmann::json;
using recording::Recorded;
namespace names = wire_contract::command;

std::string text_of(const json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

bool truth_of(const json& object, const char* key, bool otherwise) {
  const auto found = object.find(key);
  return found != object.end() && found->is_boolean() ? found->get<bool>() : otherwise;
}

std::vector<std::byte> command_of(const json& arguments) {
  dds::Sample<wire::Query> query;
  query->kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::command);
  query->chunk_count = 1;
  static_cast<void>(dds::set_text(query->text, arguments.dump(-1, ' ', false, json::error_handler_t::replace)));
  return wire::cdr_bytes(*query);
}

/// Of both ways to write the pair.
std::string pair_of(const json& arguments) {
  const std::string a = text_of(arguments, "a");
  const std::string b = text_of(arguments, "b");
  return std::min(a, b) + '\n' + std::max(a, b);
}

}  // namespace

template <class IsChosen>
std::size_t FlightCommands::drop_if(const IsChosen& is_chosen) {
  return std::erase_if(kept_, [&](const Kept& command) {
    const bool drop = is_chosen(command);
    bytes_ -= drop ? command.bytes.size() : 0;
    return drop;
  });
}

void FlightCommands::asked(const wire::Query& query) {
  if (query.kind != static_cast<std::uint8_t>(wire_contract::QuestionKind::command)) return;
  const std::string what = text_of(json::parse(query.text, nullptr, false), "command");
  const names::CommandSpec* const spec = names::find_command(what);
  if (spec == nullptr || !spec->is_recorded_change()) return;
  if (query.client == 0)
    return done(wire::cdr_bytes(query), json::object(), [](const std::string*, bool) { return false; });
  noted_.emplace_back(query.client, query.request);
  if (noted_.size() > kMostNoted) noted_.pop_front();
  unanswered_.push_back({query.client, query.request, wire::cdr_bytes(query)});
  if (unanswered_.size() <= kMostUnanswered) return;
  unanswered_.pop_front();
  ++left_out_;
}

void FlightCommands::answered(const wire::Reply& reply, const TakePublished& take) {
  if (reply.request == 0) return gone(reply);
  if (unanswered_.empty() || reply.status == static_cast<std::uint8_t>(wire_contract::ReplyStatus::progress)) return;
  const auto found = std::find_if(unanswered_.begin(), unanswered_.end(), [&](const Unanswered& command) {
    return command.client == reply.client && command.request == reply.request;
  });
  if (found == unanswered_.end()) return;
  const std::vector<std::byte> query = std::move(found->bytes);
  unanswered_.erase(found);
  if (reply.status != static_cast<std::uint8_t>(wire_contract::ReplyStatus::ok)) return;
  const auto text = dds::view(reply.text);
  done(query, json::parse(text.begin(), text.end(), nullptr, false), take);
}

void FlightCommands::gone(const wire::Reply& reply) {
  const auto text = dds::view(reply.text);
  if (std::ranges::equal(text, std::string_view(names::kClientGone))) fences_.owner_gone(reply.client);
}

void FlightCommands::done(const std::vector<std::byte>& query, const json& answer, const TakePublished& take) {
  dds::Sample<wire::Query> sample;
  if (!wire::read_cdr(query, sample)) return;
  const json arguments = json::parse(sample->text, nullptr, false);
  Kept command{.what = text_of(arguments, "command"),
               .name = text_of(arguments, "name"),
               .moving = truth_of(arguments, "moving", true),
               .bytes = query};
  if (command.what == names::kFence) return fences_.done(*sample, arguments);
  if (command.what == names::kRemove) {
    const auto gone = answer.is_object() ? answer.find("removed") : answer.end();
    // The list of removed names was too long for one sample: the command is kept with its glob instead, once.
    if (gone != answer.end() && gone->is_array()) return removed(*gone, take);
    drop(command.what, command.name);
  }
  if (command.what == names::kClear) return cleared(std::move(command), arguments, take);
  if (command.what == names::kProbe) return probed(std::move(command), arguments);
  if (command.what == names::kAllow || command.what == names::kDeny) return ruled(std::move(command), arguments);
  if (command.what == names::kAttach) return attached(std::move(command), arguments, answer);
  if (command.what == names::kDetach) {
    drop(names::kAttach, text_of(arguments, "child"));
    return;
  }
  if (command.what == names::kMove) {
    drop(command.what, command.name);
    drop(names::kAttach, command.name);  // the server moves only what is attached no longer
  }
  if (command.what == names::kLoad) {
    const std::string scene = text_of(answer, "scene");
    if (!scene.empty()) command.name = scene;
    drop(command.what, command.name);
  }
  keep(std::move(command));
}

/// What a command or a publisher had brought in is forgotten. For what came with a scene a removal is kept.
void FlightCommands::removed(const json& gone, const TakePublished& take) {
  for (const json& entry : gone) {
    if (!entry.is_string()) continue;
    const std::string name = entry.get<std::string>();
    drop(names::kMove, name);
    drop(names::kAttach, name);
    if (drop(names::kAdd, name) > 0 || take(&name, false)) continue;
    drop(names::kRemove, name);
    keep({.what = names::kRemove,
          .name = name,
          .moving = false,
          .bytes = command_of({{"command", names::kRemove}, {"name", name}})});
  }
}

void FlightCommands::cleared(Kept clear, const json& arguments, const TakePublished& take) {
  const std::string scene = text_of(arguments, "scene");
  const bool moving = truth_of(arguments, "moving", false);
  const bool is_of_scene = !scene.empty();
  if (is_of_scene && !moving && drop(names::kLoad, scene) > 0) return;
  if (is_of_scene) drop(names::kLoad, scene);
  if (!is_of_scene || moving) {
    static_cast<void>(take(nullptr, moving));
    drop_if([&](const Kept& command) {
      const bool is_loaded = !moving && command.what == names::kLoad;
      const bool is_added = command.what == names::kAdd && (command.moving || !moving);
      // Where only moving objects go, a move or a removal may be about an object that stays. One about an object that
      // is gone is refused when it is carried out again, which does no harm.
      const bool is_about_gone = !moving && (command.what == names::kMove || command.what == names::kRemove);
      return is_loaded || is_added || is_about_gone;
    });
  }
  // The command itself is kept too: it also removes scenes that the server started with and what came with scenes.
  clear.name = scene + (moving ? "/moving" : "");
  drop(clear.what, clear.name);
  keep(std::move(clear));
}

/// A removal goes by its glob: the names in its answer may be more than one sample holds.
void FlightCommands::probed(Kept probe, const json& arguments) {
  if (!truth_of(arguments, "remove", false)) {
    drop(probe.what, probe.name);
    return keep(std::move(probe));
  }
  drop_if([&](const Kept& command) {
    return command.what == names::kProbe && wire_contract::glob_matches(probe.name, command.name);
  });
}

/// The newest rule of a pair stands; one that takes back needs another that allows.
void FlightCommands::ruled(Kept rule, const json& arguments) {
  rule.name = pair_of(arguments);
  drop(names::kAllow, rule.name);
  drop(names::kDeny, rule.name);
  const bool is_needed = rule.what == names::kAllow ||
                         std::ranges::any_of(kept_, [](const Kept& command) { return command.what == names::kAllow; });
  if (is_needed) keep(std::move(rule));
}

/// Kept with the place that the child has in its parent's frame: where the two are when it is carried out again is another.
void FlightCommands::attached(Kept attachment, json arguments, const json& answer) {
  attachment.name = text_of(arguments, "child");
  const auto pose = answer.is_object() ? answer.find("pose") : answer.end();
  if (pose != answer.end()) {
    arguments["pose"] = *pose;
    attachment.bytes = command_of(arguments);
  }
  drop(names::kAttach, attachment.name);
  keep(std::move(attachment));
}

void FlightCommands::keep(Kept command) {
  if (bytes_ + command.bytes.size() > kMostBytes) {
    ++left_out_;
    return;
  }
  bytes_ += command.bytes.size();
  kept_.push_back(std::move(command));
}

std::size_t FlightCommands::drop(std::string_view what, std::string_view name) {
  return drop_if([&](const Kept& command) { return command.what == what && command.name == name; });
}

void FlightCommands::write(const std::function<void(Recorded, std::span<const std::byte>)>& put) const {
  for (const Kept& command : kept_) put(Recorded::query, command.bytes);
  fences_.write(put);
  for (const Unanswered& command : unanswered_) put(Recorded::query, command.bytes);
}

}  // namespace collided::engine::service
