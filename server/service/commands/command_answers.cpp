#include "server/service/commands/command_answers.hpp"

#include <exception>
#include <utility>

namespace collided::engine::service {

using nlohmann::json;
using wire_contract::ReplyStatus;
using wire_contract::command::Changes;

namespace {

constexpr const char* kNoFolder = "the server has no folder to keep it in";
/// Upper bound on a record's size beyond a command's text and bytes: its head, and a key of two names.
constexpr std::uint64_t kRecordBytes = 1'024;

}  // namespace

void CommandAnswers::answer(const CommandAsk& ask, const std::function<json()>& work) {
  try {
    send(ask, ReplyStatus::ok, work().dump(-1, ' ', false, json::error_handler_t::replace));
  } catch (const BadCommand& bad) { refuse(ask, bad); } catch (const std::bad_alloc&) {
    // On the world's thread, half of a change may already be in the world: the caller ends the process.
    if (with_.loop.runs_here()) throw;
    refuse(ask, "not enough memory");
  } catch (const std::exception& failed) { refuse(ask, failed.what()); }
}

void CommandAnswers::send(const CommandAsk& ask, ReplyStatus status, std::string text) {
  if (ask.client != 0) return answering_->send_text(ask.client, ask.request, status, std::move(text));
  if (ask.request == 0) return answer_followed(status, text);
  if (status != ReplyStatus::refused) return;
  const json refusal = json::parse(text, nullptr, false);
  if (with_.durable != nullptr && refusal.is_object())
    with_.durable->not_restored(ask.request, refusal.value("error", text));
  with_.loop.say("what was kept cannot be carried out again: " + text);
}

void CommandAnswers::answer_once_kept(const CommandAsk& ask, const std::function<json()>& work, bool is_durable) {
  json result;
  std::exception_ptr refusal;
  // Commands from the wire are recorded elsewhere.
  if (with_.flight != nullptr && ask.client == 0) with_.flight->note_own(ask.text, ask.blob);
  try {
    result = work();
  } catch (...) { refusal = std::current_exception(); }
  // Changes made before a refusal stay in the world.
  const Inventory::Changes changes = with_.inventory.flush(ask.client, ask.request);
  if (refusal) return answer(ask, [&]() -> json { std::rethrow_exception(refusal); });
  tell_followers(ask, changes);
  if (after_change_) after_change_();
  const CommandAsk whose{ask.client, ask.request, {}, {}};
  auto tell = [this, whose, result, is_durable](const std::string& not_kept) mutable {
    if (!not_kept.empty() && is_durable)
      return refuse(whose, "it was done, but is lost when the server ends: " + not_kept);
    if (!not_kept.empty()) result["not_kept"] = not_kept;
    // Reported once, at the start and in the plan, not with every command.
    if (with_.durable == nullptr) result["keeps_nothing"] = true;
    answer(whose, [&] { return result; });
  };
  with_.durable != nullptr ? with_.durable->then(tell) : tell(kNoFolder);
}

/// Followers fetch commands that are carried out again at the start with the rest of the kept state. Of added fences
/// only the kept ones are passed on, one by one.
void CommandAnswers::tell_followers(const CommandAsk& ask, const Inventory::Changes& changes) const {
  if (ask.client == 0) return;
  const Arguments arguments(ask.text);
  const Changes what = arguments.spec()->changes;
  const bool is_added_fence = what == Changes::fences && !arguments.truth("remove");
  if (!is_added_fence && what != Changes::losses) with_.place.changed(ask);
  if (!is_added_fence) return;
  for (const KeptCommand& fence : changes.put) {
    if (fence.owner == 0) with_.place.changed({0, 0, fence.text, fence.blob});
  }
}

std::future<std::string> CommandAnswers::followed() {
  const std::lock_guard lock(followed_mutex_);
  followed_ = std::make_shared<std::promise<std::string>>();
  return followed_->get_future();
}

void CommandAnswers::answer_followed(ReplyStatus status, const std::string& text) {
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

void CommandAnswers::once_there_is_room(const CommandAsk& ask, bool is_durable, std::function<void()> go_on) {
  if (!is_durable) return go_on();
  const CommandAsk whose{ask.client, ask.request, {}, {}};
  const auto decide = [this, whose, go_on = std::move(go_on)](const std::string& no_room) {
    if (no_room.empty()) return go_on();
    refuse(whose, "it cannot be kept: " + no_room + ". Nothing was done",
           "without --durable it is done, and lost when the server ends");
  };
  if (with_.durable == nullptr) return decide(kNoFolder);
  with_.durable->ask_room(ask.text.size() + ask.blob.size() + kRecordBytes, decide);
}

}  // namespace collided::engine::service
