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
#include "server/service/world_loop.hpp"

namespace collided::engine::service {

/// What commands work with; all must outlive them.
struct CommandCollaborators {
  WorldLoop& loop;
  Inbox& inbox;
  const WorldClock& clock;
  const QuestionCounts& counts;
  const BackgroundAudit& audit;
  DurableState* durable;   // keeps over a crash what commands add; null: nothing is kept
  FlightRecorder* flight;  // for `recording`; null: there is none
  PartMeshes& part_meshes;
  QuestionSamples& samples;
  std::int64_t clock_error_ns = 0;      // by which publishers' clocks may differ; the world has it too
  const ShardPlace* shard = nullptr;    // null: it holds all of the world
  std::int64_t replaced_within_ns = 0;  // of a shard: so long its place may be empty between it and a standby
  // Called on the world's thread with each command that has changed the world, for servers that follow; empty: there
  // can be none.
  std::function<void(const CommandAsk&)> changed = {};
  // The name of the server that takes this one's place, by the name that was asked for, or any; throws BadCommand.
  std::function<std::string(const std::string&)> hand_over = {};
  bool is_replica = false;                          // what changes the world is the primary's to do
  std::function<std::uint64_t()> predecessor = {};  // the server whose place this one has taken; 0: none
  // Why a publisher's samples are not taken; empty: they are. On the world's thread
  std::function<std::string(std::uint64_t)> why_refused = {};
};

/// Sends the answers of commands, those of changes once they are kept, and passes changes on to servers that follow and to
/// the flight recorder.
class CommandAnswers {
 public:
  explicit CommandAnswers(const CommandCollaborators& with) : with_(with) {}

  /// Sets where the answers go. To be called before the first answer.
  void connect(Answering& answering) { answering_ = &answering; }
  Answering& answering() const { return *answering_; }
  /// Sets what is called on the world's thread after each change.
  void after_change(std::function<void()> call) { after_change_ = std::move(call); }

  /// Sends an answer to the client. A command that is carried out again has no client: its refusal is logged as a loss.
  void send(const CommandAsk& ask, wire_contract::ReplyStatus status, std::string text);
  void refuse(const CommandAsk& ask, const std::string& error, const std::string& hint = {}) {
    send(ask, wire_contract::ReplyStatus::refused, refusal_text(error, hint));
  }
  void refuse(const CommandAsk& ask, const BadCommand& bad) { refuse(ask, bad.what(), bad.hint); }
  /// Sends the result of the work, or the refusal that it threw.
  void answer(const CommandAsk& ask, const std::function<nlohmann::json()>& work);
  /// Like answer(), but sends the answer once the change is on the disk; if it cannot be kept, the answer has the reason.
  void answer_once_kept(const CommandAsk& ask, const std::function<nlohmann::json()>& work, bool is_durable = false);
  /// Calls go_on, for a durable command only if the disk has room for it; else refuses the command.
  void once_there_is_room(const CommandAsk& ask, bool is_durable, std::function<void()> go_on);

  /// Why the next command of another server is refused; empty: it is carried out.
  std::future<std::string> followed();
  /// Records a command that is carried out again or comes from another server: only commands on the wire are recorded
  /// elsewhere.
  void tell_flight_recorder(const CommandAsk& ask);

 private:
  void answer_followed(wire_contract::ReplyStatus status, const std::string& text);
  void tell_followers(const CommandAsk& ask) const;

  const CommandCollaborators& with_;
  Answering* answering_ = nullptr;
  std::function<void()> after_change_;
  std::mutex followed_mutex_;
  std::shared_ptr<std::promise<std::string>> followed_;  // under followed_mutex_
};

}  // namespace collided::engine::service
