#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <utility>

#include "idl/commands.hpp"
#include "server/service/commands/commands.hpp"

// What outlives a crash: commands answered once they are kept, and carried out again by the next process.
namespace collided::engine::service {

using nlohmann::json;
using wire_contract::ReplyStatus;
namespace names = wire_contract::command;

namespace {

constexpr const char* kNoFolder = "the server has no folder to keep it in";
/// What a record takes beside a command's text and bytes, at most: its head, and a key of two names.
constexpr std::uint64_t kRecordBytes = 1'024;

}  // namespace

/// As answer(), but the answer waits until what was done is on the disk, or says why it is not.
void Commands::answer_once_kept(const CommandAsk& ask, const std::function<json()>& work, bool is_durable) {
  json result;
  try {
    result = work();
    tell_followers(ask);
    drop_uploads();
  } catch (...) {
    return answer(ask, []() -> json { throw; });
  }
  const CommandAsk whose{ask.client, ask.request, {}, {}};
  auto tell = [this, whose, result, is_durable](const std::string& not_kept) mutable {
    if (!not_kept.empty() && is_durable)
      return send(whose, ReplyStatus::refused, refusal_text("it was done, but is lost with a crash: " + not_kept));
    if (!not_kept.empty()) result["not_kept"] = not_kept;
    // Said once, at the start and in the plan, and not with every command.
    if (with_.durable == nullptr) result["keeps_nothing"] = true;
    answer(whose, [&] { return result; });
  };
  with_.durable != nullptr ? with_.durable->then(tell) : tell(kNoFolder);
}

/// What is carried out again after a crash a follower fetches with all that is kept. Fences are told where they are made,
/// since only those that are kept stand for themselves.
void Commands::tell_followers(const CommandAsk& ask) const {
  if (!with_.changed || ask.client == 0) return;
  const Arguments arguments(ask.text);
  const bool is_fence = arguments.command() == names::kFence && !arguments.truth("remove");
  if (!is_fence && arguments.command() != names::kAcceptLoss) with_.changed(ask);
}

std::string Commands::follow(CommandAsk ask) {
  const auto done = std::make_shared<std::promise<std::string>>();
  std::future<std::string> refusal = done->get_future();
  const CommandAsk followed = ask;
  {
    const std::lock_guard lock(followed_mutex_);
    followed_ = done;
  }
  try {
    const Arguments arguments(ask.text);
    const BoundCommand& handler = handler_of(arguments);
    if (arguments.command() == names::kLoad) {
      load_one(parse_load(std::move(ask), arguments));
    } else {
      if (!handler.is_on_world_thread) return "the command changes nothing";
      const bool taken = with_.inbox.push_job([this, &handler, ask = std::move(ask)] {
        answer_once_kept(ask, [&] { return handler.work(ask, Arguments(ask.text)); });
      });
      if (!taken) return "too many commands wait already";
    }
  } catch (const BadCommand& bad) { return bad.what(); }
  constexpr std::chrono::milliseconds kLook{50};
  while (!stopping_.load()) {
    if (refusal.wait_for(kLook) != std::future_status::ready) continue;
    const std::string why = refusal.get();
    if (why.empty()) tell_flight_recorder(followed);
    return why;
  }
  return "the server is stopping";
}

void Commands::answer_followed(ReplyStatus status, const std::string& text) {
  if (status == ReplyStatus::progress) return;
  std::shared_ptr<std::promise<std::string>> done;
  {
    const std::lock_guard lock(followed_mutex_);
    done = std::exchange(followed_, nullptr);
  }
  if (!done) return;
  const json refusal = json::parse(text, nullptr, false);
  const bool is_refused = status == ReplyStatus::refused;
  done->set_value(!is_refused ? "" : refusal.is_object() ? refusal.value("error", text) : text);
}

/// Goes on where what the command does will find room on the disk, if it asks for that; else refuses it.
void Commands::once_there_is_room(const CommandAsk& ask, bool is_durable, std::function<void()> go_on) {
  if (!is_durable) return go_on();
  const CommandAsk whose{ask.client, ask.request, {}, {}};
  const auto decide = [this, whose, go_on = std::move(go_on)](const std::string& no_room) {
    if (no_room.empty()) return go_on();
    send(whose, ReplyStatus::refused,
         refusal_text("it cannot be kept: " + no_room + ". Nothing was done",
                      "without --durable it is done, and lost with a crash"));
  };
  if (with_.durable == nullptr) return decide(kNoFolder);
  with_.durable->ask_room(ask.text.size() + ask.blob.size() + kRecordBytes, decide);
}

/// Removes the uploaded files of scenes that are gone.
void Commands::drop_uploads() {
  const World& world = with_.loop.world();
  const auto has_scene = [&](std::string_view name) {
    const SnapshotRing::Lease state = world.newest();
    return std::any_of(state->scenes.begin(), state->scenes.end(),
                       [&](const auto& scene) { return scene->name == name; });
  };
  for (auto upload = upload_of_scene_.begin(); upload != upload_of_scene_.end();) {
    const auto here = upload++;
    if (has_scene(here->first)) continue;
    forget_upload(here->second);
    upload_of_scene_.erase(here);
  }
}

/// Removes an uploaded file once the journal names it no longer: after a crash before that it is loaded again.
void Commands::forget_upload(const std::string& path) {
  if (with_.durable == nullptr) return uploads_.forget(path);
  with_.durable->then([this, path](const std::string& not_kept) {
    if (not_kept.empty()) uploads_.forget(path);
  });
}

/// Records a command that is carried out again or after another server: it did not come over the wire, so nothing else
/// records it.
void Commands::tell_flight_recorder(const CommandAsk& ask) {
  if (with_.flight == nullptr) return;
  dds::Sample<wire::Query> query;
  query->kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::command);
  query->chunk_count = 1;
  static_cast<void>(dds::set_text(query->text, ask.text));  // it came in such a field, so it fits
  const std::vector<std::uint8_t> blob(reinterpret_cast<const std::uint8_t*>(ask.blob.data()),
                                       reinterpret_cast<const std::uint8_t*>(ask.blob.data()) + ask.blob.size());
  dds::borrow(query->blob, blob);
  with_.flight->note(recording::Recorded::query, *query);
}

/// Loads the scenes on the thread for slow work, then adds, moves and probes on the world's, as some need those scenes.
void Commands::replay(const std::vector<CommandAsk>& asks) {
  if (asks.empty()) return;
  replaying_.store(true);
  slow_jobs_.push([this, asks] {
    std::vector<CommandAsk> others;
    for (const CommandAsk& ask : asks) {
      if (!with_.durable->is_due(ask.request)) continue;
      tell_flight_recorder(ask);
      try {
        const Arguments arguments(ask.text);
        if (arguments.command() == names::kLoad) {
          static_cast<void>(handler_of(arguments));
          load_one(parse_load(ask, arguments));
        } else if (arguments.command() == names::kClear) {
          with_.inbox.push_own_job([this, ask] { replay_on_world_thread({ask}); });
        } else {
          others.push_back(ask);
        }
      } catch (const BadCommand& bad) { send(ask, ReplyStatus::refused, refusal_text(bad.what(), bad.hint)); }
    }
    with_.inbox.push_own_job([this, others] {
      replay_on_world_thread(others);
      with_.durable->note_restored();
      replaying_.store(false);
    });
  });
}

void Commands::replay_on_world_thread(const std::vector<CommandAsk>& asks) {
  for (const CommandAsk& ask : asks) {
    if (!with_.durable->is_due(ask.request)) continue;
    if (waits_for_parent(ask)) {
      parted_.push_back(ask);
      continue;
    }
    answer_once_kept(ask, [&]() -> json {
      const Arguments arguments(ask.text);
      const BoundCommand& handler = handler_of(arguments);
      return is_removed_already(arguments) ? json::object() : handler.work(ask, arguments);
    });
  }
}

/// Whether the command removes what is not there: the start options or the file may be others than before.
bool Commands::is_removed_already(const Arguments& arguments) const {
  const World& world = with_.loop.world();
  if (arguments.command() == names::kRemove) return !world.find(arguments.text("name"));
  if (arguments.command() != names::kClear) return false;
  const std::string scene = arguments.text("scene");
  return std::ranges::none_of(world.newest()->scenes, [&](const auto& loaded) { return loaded->name == scene; });
}

/// What of the time before the crash is missing, and, unless that is only to be shown, that the world counts as whole
/// without it.
json Commands::accept_loss(const Arguments& arguments) {
  const bool shows_only = arguments.truth("show");
  const std::vector<std::string> losses =
      with_.durable != nullptr ? with_.durable->losses() : std::vector<std::string>();
  if (!shows_only && with_.durable != nullptr) with_.durable->accept_losses();
  return {{"losses", losses}, {"accepted", !shows_only && !losses.empty()}};
}

}  // namespace collided::engine::service
