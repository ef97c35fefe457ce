#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "idl/dds.hpp"
#include "server/service/questions/background_audit.hpp"
#include "server/service/questions/clients.hpp"
#include "server/service/questions/command_ask.hpp"
#include "server/service/questions/overload.hpp"
#include "server/service/questions/participants.hpp"
#include "server/service/questions/past_states.hpp"
#include "server/service/questions/question_samples.hpp"
#include "server/service/questions/short_questions.hpp"
#include "server/service/questions/snapshot_leases.hpp"
#include "server/service/questions/write_barriers.hpp"
#include "server/service/recording/flight_recorder.hpp"
#include "server/service/runtime/clock.hpp"
#include "server/service/runtime/counters.hpp"
#include "server/service/runtime/fair_queue.hpp"
#include "server/service/runtime/place.hpp"
#include "server/world/groups/part_meshes.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// How questions are answered. `server` goes into every reply, and `epoch` until set_epoch().
struct AnsweringOptions {
  std::uint64_t server = 0;
  std::uint64_t epoch = 0;
  unsigned threads = 1;                // that answer, at least 1; as many again, up to 8, answer costly questions
  std::int64_t deadline_ns = 0;        // for questions without one, counted from when they are taken; 0: none
  double error_m = 0;                  // for questions without one; 0: exact
  std::function<bool()> recovering;    // true: after a crash the world may lack what publishers have not sent again
  const Overload* overload = nullptr;  // null: never overloaded
  FlightRecorder* flight = nullptr;    // records every question and reply; null: none
  KeyedPeers* peers = nullptr;         // rights by key; null: no keys
};

/// The text of a refusal: {"error": ..., "hint": ...}, without the hint if it is empty.
///
/// retry_after_ns  if above 0, adds {"retry_after_ms": ...}: asking again after this long may help
std::string refusal_text(const std::string& error, const std::string& hint = {}, std::int64_t retry_after_ns = 0);

/// Takes questions from DDS, has workers answer them on snapshots, and writes the replies.
///
/// threads  the listener's calls listen(); workers are started by the constructor and end in stop()
class Answering {
 public:
  using Command = std::function<void(CommandAsk)>;  // called on a worker; it answers through send_text()

  /// What it works with; all must outlive the Answering.
  struct Collaborators {
    const World& world;
    const WorldClock& clock;
    WriteBarriers& write_barriers;
    SnapshotLeases& leases;
    QuestionCounts& counts;
    BackgroundAudit& audit;
    PartMeshes& part_meshes;
    QuestionSamples& samples;
    const Place& place;  // once it may not publish any more, no answer is written
  };

  /// Starts the workers. `replies` must outlive the Answering.
  Answering(const Collaborators& with, const dds::Topic<wire::Reply>& replies, const AnsweringOptions& options,
            Command command);
  ~Answering();

  /// Called by the query reader's listener: takes, stamps and passes on. Answers the first short question itself, which
  /// saves waking a worker and waiting for the workers' current tasks.
  void listen(const dds::Taker<wire::Query>& taker);
  /// Leaves questions with DDS, which makes the clients wait, until go_on(): used while it is undecided whether this
  /// server or another one answers them. Any thread.
  void hold() { holds_.store(true); }
  /// Takes what was held. Any thread.
  void go_on();
  bool holds() const { return holds_.load(); }
  /// Queues a question that has passed its write barrier. A request in several chunks is admitted with its first one,
  /// which waits for a state to be answered on; after that none of its chunks is refused for lack of room. Any thread.
  void admit(AskPointer ask);
  /// Queues the text of a command's answer, which is written in as many replies as it needs. Any thread.
  ///
  /// is_recorded  whether the flight recorder keeps the replies
  void send_text(std::uint64_t client, std::uint64_t request, wire_contract::ReplyStatus status, std::string text,
                 bool is_recorded = true);
  /// Records that a client has gone, and what was removed with it: wire_contract::command::kClientGone. Any thread.
  void send_farewell(std::uint64_t client) { queue_.push_own(Farewell{client}); }
  /// Call this regularly, from one thread: refuses questions that waited too long at a barrier, expires leases, forgets
  /// clients that are gone.
  ///
  /// query_owners  possible owners of the live clients' numbers: see Ask::owner
  void tick(std::vector<std::uint64_t> query_owners);
  /// Sets the epoch of all further replies. Any thread.
  void set_epoch(std::uint64_t epoch) { epoch_.store(epoch, std::memory_order_relaxed); }
  /// Answers queued questions for up to a second, refuses the rest and those that wait at barriers, then ends the
  /// workers.
  void stop();
  std::size_t clients() const { return clients_.size(); }
  /// Whether answers to this client may still be read: false once it has gone and tick() has noticed. Any thread.
  bool knows(std::uint64_t client) const { return clients_.find(client) != nullptr; }
  PastStates& past_states() { return past_states_; }
  /// Whether the queue is more than half full, or refused something since the last call. One thread.
  bool was_pressed();
  /// Clients::turned_away(). Any thread.
  std::uint64_t clients_turned_away() const { return clients_.turned_away(); }

 private:
  static constexpr std::size_t kMostQueued = 4'096;
  static constexpr std::size_t kMostQueuedBytes = std::size_t{64} << 20;
  static constexpr std::int64_t kTurnNs = 10'000'000;  // of a chunk, while others wait
  // Limit for one question on a thread that others wait for. A turn's last question may begin at the turn's end.
  static constexpr std::int64_t kQuestionNs = 2 * kTurnNs;
  static constexpr std::int64_t kListeningNs = 500'000;  // limit for one question on the listener's thread
  static constexpr std::size_t kMostCostlyThreads =
      8;  // each keeps a state of the world, of which there are 16, for long
  static constexpr double kNsPerCostAtFirst = 500;
  static constexpr double kLeastPartNs = 200'000;  // work that is worth waking a thread and writing a reply of its own
  static constexpr std::uint32_t kPartQuestions = 64;  // rays are looked up in groups of this size
  static constexpr std::int64_t kStopPatienceNs = 1'000'000'000;

  struct TextReply {
    std::uint64_t client = 0;
    std::uint64_t request = 0;
    wire_contract::ReplyStatus status = wire_contract::ReplyStatus::ok;
    std::string text;
    bool is_recorded = true;
  };
  struct Farewell {
    std::uint64_t client = 0;
  };
  struct Resume {
    std::uint32_t place = 0;
  };
  struct ExpireLeases {
    std::vector<std::uint64_t> query_owners;
  };
  /// What waits for a worker: a question, a text to be written, a client that has gone, a place whose clients' asks may
  /// go on, or leases to expire.
  using Work = std::variant<AskPointer, TextReply, Farewell, Resume, ExpireLeases>;
  class Worker;

  void refuse_later(AskPointer ask, std::string reason, std::int64_t retry_after_ns = 0);
  void refuse_as_left_out(AskPointer ask);
  void refuse_for_now(AskPointer ask);
  void note_cost(double cost, std::int64_t took_ns);
  void enqueue(AskPointer ask);
  void share(Ask& ask);
  std::uint32_t parts_of(const Ask& ask, std::uint32_t left);
  void push_part(Ask& ask, std::uint32_t first);
  bool put_back(AskPointer& ask);
  bool put_among_costly(AskPointer& ask, std::int64_t took_ns, bool was_there);
  /// Whether the time to answer the rest during the stop has passed; what is left is refused.
  bool is_over() const { return stopping_.load() && steady_ns() >= stops_by_ns_.load(); }
  static Share share_of(const Ask& ask);
  std::int64_t retry_after_ns();
  bool leaves_out(const wire::Query& query) const;
  std::uint64_t least_version(const wire::Query& query) const;
  void take(const dds::Taker<wire::Query>& taker, AskPointer* single);
  void drain(const dds::Taker<wire::Query>& taker, AskPointer* single);
  void route(AskPointer ask, AskPointer* single);
  const char* why_not_allowed(const Ask& ask) const;
  const char* why_not_answered(const wire::Query& query) const;
  void take_more();

  Collaborators with_;
  PastStates past_states_;
  AnsweringOptions options_;
  std::atomic<std::uint64_t> epoch_;
  Command command_;
  AskPool pool_;
  FairQueue<Work> queue_;
  FairQueue<AskPointer> costly_;      // asks with a question that took longer than kQuestionNs; costs in nanoseconds
  std::uint64_t refused_before_ = 0;  // at the last was_pressed()
  Clients clients_;
  Participants participants_;                 // of the thread that takes
  std::atomic<double> ns_per_cost_;           // moving mean; see cost_of()
  std::atomic<std::uint32_t> takers_{0};      // threads that want to take; see take()
  std::array<AskPointer, 4> next_;            // of the thread that takes: mostly all that one call brings
  std::unique_ptr<Worker> listening_worker_;  // these three: used by the listener's thread alone
  AskPointer spare_;
  ShortQuestions short_questions_;
  std::atomic<dds_entity_t> left_in_reader_{
      0};  // a reader with questions that were not taken for lack of room or while held; 0: none
  std::atomic<bool> holds_{false};
  std::atomic<bool> stopping_{false};
  std::atomic<std::int64_t> stops_by_ns_{std::numeric_limits<std::int64_t>::max()};  // steady clock
};

}  // namespace collided::engine::service
