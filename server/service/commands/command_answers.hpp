#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>

#include "server/service/commands/command_arguments.hpp"
#include "server/service/commands/shard_place.hpp"
#include "server/service/durability/durable_state.hpp"
#include "server/service/ingest/inbox.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/questions/background_audit.hpp"
#include "server/service/runtime/place.hpp"
#include "server/service/world_loop.hpp"

namespace collided::engine::service {

/// What commands work with; all members must outlive them.
struct CommandCollaborators {
  WorldLoop& loop;
  Inbox& inbox;
  const WorldClock& clock;
  const QuestionCounts& counts;
  const BackgroundAudit& audit;
  DurableState* durable;   // keeps the inventory for the next process; null: nothing is kept
  Inventory& inventory;    // of what commands bring in
  FlightRecorder* flight;  // for `recording`; null: there is none
  PartMeshes& part_meshes;
  QuestionSamples& samples;
  Place& place;
  bool uses_keys = false;
  std::int64_t clock_error_ns = 0;    // by which publishers' clocks may differ; the world has the same value
  const ShardPlace* shard = nullptr;  // null: this server holds all of the world
  // Why a publisher's samples are refused; empty: they are accepted. On the world's thread.
  std::function<std::string(std::uint64_t)> why_refused = {};
};

/// Sends the answers of commands, those of changes once they are stored, and passes changes on to followers.
class CommandAnswers {
 public:
  explicit CommandAnswers(const CommandCollaborators& with) : with_(with) {}

  /// Sets where the answers go. Call this before the first answer.
  void connect(Answering& answering) { answering_ = &answering; }
  Answering& answering() const { return *answering_; }
  /// Sets what is called on the world's thread after each change.
  void after_change(std::function<void()> call) { after_change_ = std::move(call); }

  /// Sends an answer to the client. A repeated command has no client: its refusal is logged as a loss.
  void send(const CommandAsk& ask, wire_contract::ReplyStatus status, std::string text);
  void refuse(const CommandAsk& ask, const std::string& error, const std::string& hint = {}) {
    send(ask, wire_contract::ReplyStatus::refused, refusal_text(error, hint));
  }
  void refuse(const CommandAsk& ask, const BadCommand& bad) { refuse(ask, bad.what(), bad.hint); }
  /// Sends the result of the work, or the refusal that it threw.
  void answer(const CommandAsk& ask, const std::function<nlohmann::json()>& work);
  /// Like answer(), but passes on what the work has changed in the inventory and sends the answer once that is on disk;
  /// if it cannot be stored, the answer gives the reason.
  void answer_once_kept(const CommandAsk& ask, const std::function<nlohmann::json()>& work, bool is_durable = false);
  /// Calls go_on, for a durable command only if the disk has room for it; otherwise refuses the command.
  void once_there_is_room(const CommandAsk& ask, bool is_durable, std::function<void()> go_on);

  /// Why the next command of another server is refused; empty: it is carried out.
  std::future<std::string> followed();

 private:
  void answer_followed(wire_contract::ReplyStatus status, const std::string& text);
  void tell_followers(const CommandAsk& ask, const Inventory::Changes& changes) const;

  const CommandCollaborators& with_;
  Answering* answering_ = nullptr;
  std::function<void()> after_change_;
  std::mutex followed_mutex_;
  std::shared_ptr<std::promise<std::string>> followed_;  // under followed_mutex_
};

}  // namespace collided::engine::service
