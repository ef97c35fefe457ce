#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "idl/dds.hpp"
#include "server/service/questions/background_audit.hpp"
#include "server/service/questions/clients.hpp"
#include "server/service/questions/overload.hpp"
#include "server/service/questions/past_states.hpp"
#include "server/service/questions/short_questions.hpp"
#include "server/service/questions/snapshot_leases.hpp"
#include "server/service/questions/write_barriers.hpp"
#include "server/service/recording/flight_recorder.hpp"
#include "server/service/runtime/clock.hpp"
#include "server/service/runtime/counters.hpp"
#include "server/service/runtime/fair_queue.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

struct AnsweringOptions {
  std::uint64_t server = 0;
  std::uint64_t epoch = 0;
  unsigned threads = 1;
  std::int64_t deadline_ns = 0;        // of questions that bring none; 0: none
  double error_m = 0;                  // the same
  std::function<bool()> recovering;    // the world may lack what publishers have yet to say again
  const Overload* overload = nullptr;  // null: never
  FlightRecorder* flight = nullptr;    // hears every question and reply
};

/// A command as it came; see idl/commands.hpp.
struct CommandAsk {
  std::uint64_t client = 0;
  std::uint64_t request = 0;
  std::string text;
  std::vector<std::byte> blob;
};

/// {"error": ..., "hint": ...}: the text of a refusal.
std::string refusal_text(const std::string& error, const std::string& hint = {});

/// Takes questions, has workers answer them on snapshots, writes the replies.
class Answering {
 public:
  using Command = std::function<void(CommandAsk)>;  // called on a worker; answers through send_text

  /// All of them outlive the Answering.
  struct Collaborators {
    const World& world;
    const WorldClock& clock;
    WriteBarriers& write_barriers;
    SnapshotLeases& leases;
    QuestionCounts& counts;
    BackgroundAudit& audit;
  };

  Answering(const Collaborators& with, const dds::Topic<wire::Reply>& replies, const AnsweringOptions& options,
            Command command);
  ~Answering();

  /// From the query reader's listener: takes, stamps and hands over; answers the first short question itself, which
  /// saves waking another thread and waiting for what the others are at.
  void listen(const dds::Taker<wire::Query>& taker);
  /// Past its fence: pins the state of a request in chunks and queues.
  void admit(AskPointer ask);
  /// The text of a command's answer, in as many replies as it needs. Any thread.
  void send_text(std::uint64_t client, std::uint64_t request, wire_contract::ReplyStatus status, std::string text);
  /// Now and then, from one thread: questions that waited too long, clients that are gone.
  void tick(std::vector<std::uint64_t> askers);
  /// Answers what is in, then ends.
  void stop();
  std::size_t clients() const { return clients_.size(); }
  PastStates& past_states() { return past_states_; }
  /// Too much waits, or some was turned away since the last call. One thread.
  bool was_pressed();

 private:
  struct TextReply {
    std::uint64_t client = 0;
    std::uint64_t request = 0;
    wire_contract::ReplyStatus status = wire_contract::ReplyStatus::ok;
    std::string text;
  };
  struct Resume {
    std::uint32_t place = 0;
  };
  struct ExpireLeases {
    std::vector<std::uint64_t> askers;
  };
  using Work = std::variant<AskPointer, TextReply, Resume, ExpireLeases>;
  class Worker;

  void refuse_later(AskPointer ask, std::string reason);
  void enqueue(AskPointer ask);
  bool leaves_out(const wire::Query& query) const;
  std::uint64_t least_version(const wire::Query& query) const;
  void take(const dds::Taker<wire::Query>& taker, AskPointer* single);
  void drain(const dds::Taker<wire::Query>& taker, AskPointer* single);
  void route(AskPointer ask, AskPointer* single);
  void take_more();

  Collaborators with_;
  PastStates past_states_;
  AnsweringOptions options_;
  Command command_;
  AskPool pool_;
  FairQueue<Work> queue_;
  std::uint64_t refused_before_ = 0;  // as of the last was_pressed()
  Clients clients_;
  std::atomic<std::uint32_t> takers_{0};         // one takes, the others tell it that there is more
  std::array<AskPointer, 4> next_;               // of who takes: one call brings what there is as a rule
  std::unique_ptr<Worker> listening_worker_;     // of the listener's thread
  AskPointer spare_;                             // the same
  ShortQuestions short_questions_;               // the same
  std::atomic<dds_entity_t> left_in_reader_{0};  // the queue was full: this reader has more
  std::atomic<bool> stopping_{false};
  std::vector<std::thread> threads_;
};

}  // namespace collided::engine::service
