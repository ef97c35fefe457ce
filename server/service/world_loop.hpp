#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/service/events/broadcast.hpp"
#include "server/service/events/event_writer.hpp"
#include "server/service/ingest/inbox.hpp"
#include "server/service/ingest/publishers.hpp"
#include "server/service/questions/snapshot_leases.hpp"
#include "server/service/questions/write_barriers.hpp"
#include "server/service/runtime/clock.hpp"
#include "server/service/runtime/counters.hpp"
#include "server/service/runtime/step_sums.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

struct LoopOptions {
  std::int64_t step_ns = 0;      // 0: a step as soon as something has changed
  std::int64_t recovery_ns = 0;  // after a crash, the longest wait for publishers to find this server
  PublisherLimits limits;
};

/// What the loop met; read by the log.
struct LoopCounts {
  std::uint64_t steps = 0;
  std::uint64_t stalled_steps = 0;   // readers held every free state; tried again
  std::uint64_t sweeps_skipped = 0;  // pairs whose way could not be followed to its end
};

/// The one thread that writes the world: takes what has come, steps, tells what has changed.
class WorldLoop {
 public:
  struct Collaborators {
    World& world;
    const WorldClock& clock;
    Inbox& inbox;
    EventWriter& event_writer;
    WriteBarriers& write_barriers;
    SnapshotLeases& leases;
    QuestionCounts& questions;
    std::function<void(AskPointer)> admit;           // asks whose fence has been passed
    std::function<void()> tick;                      // ten times a second
    std::function<void(const std::string&)> notice;  // a sentence for the log
    std::function<void()> has_new_publisher = {};    // told at once: a crash may be near
    // Asked after a crash.
    std::function<bool()> is_adding_again = {};  // scenes and objects that commands had added; however long it takes
    std::function<bool()> has_all_back = {};     // every publisher that was there
    // Asked while overloaded.
    std::function<bool()> leaves_out_details = {};  // contacts that go on are not told anew
  };

  WorldLoop(const Collaborators& with, const LoopOptions& options)
      : with_(with),
        options_(options),
        publishers_(with.world, options.limits),
        broadcast_(with.world, with.event_writer, with.notice),
        recovering_(options.recovery_ns > 0),
        started_ns_(steady_ns()) {}

  /// Runs until stop(); then ends every contact with server_stopping and says so. Ends the process where no memory is left.
  void run();
  /// This is the thread that run() is on.
  bool runs_here() const { return thread_.load() == std::this_thread::get_id(); }
  /// Any thread.
  void stop();

  /// For jobs on this thread.
  World& world() { return with_.world; }
  Probes& probes() { return probes_; }
  /// After probes() was changed.
  void note_probes() { probe_count_.store(probes_.size(), std::memory_order_relaxed); }
  /// In the newest state, in the order of probes().definition(); for jobs on this thread.
  const std::vector<ProbeReading>& read_probes();
  const Publishers& publishers() const { return publishers_; }
  /// All changes so far become events and a state. What began and ended is in world().events() until the next step.
  void step_now();
  /// A change that a job made itself.
  void note_change() { ++own_changes_; }
  const LoopCounts& counts() const { return counts_; }
  /// Any thread.
  const StepSums& sums() const { return sums_; }
  /// 0: a step as soon as something has changed. Any thread.
  std::int64_t step_period_ns() const { return options_.step_ns; }
  /// Any thread; as of the last status.
  std::string publisher_name(std::uint64_t publisher) const;
  /// Not everything that was there before a crash may be back yet. Any thread.
  bool recovering() const { return recovering_.load(std::memory_order_relaxed); }
  /// A sentence for the log; any thread.
  void say(const std::string& sentence) const { with_.notice(sentence); }
  bool contacts_wanted() const { return with_.event_writer.contacts_wanted(); }
  bool probes_wanted() const { return with_.event_writer.probes_wanted(); }
  /// Any thread; as of the last change of them.
  std::size_t probe_count() const { return probe_count_.load(std::memory_order_relaxed); }

 private:
  void serve();
  void take(Arrival& arrival);
  void take(DefinitionSample& sample);
  template <class Apply>
  void apply(Apply&& once);
  void keep_time();
  bool has_recovered() const;
  void take_arrivals();
  void step_if_due();
  void sum_up(std::int64_t started_ns, std::int64_t stepped_ns);
  void sum_up_poses();
  void publish();
  void publish_probes(const Stamp& stamp);
  void release_passed_barriers();
  void write_status(wire_contract::ServerState state);
  void write_step();
  void list_publishers(bool with_names);
  void list_publisher_names();
  void end_contacts();
  void say_notices();
  void say_skipped_sweeps();
  std::chrono::steady_clock::time_point next_wake() const;

  Collaborators with_;
  LoopOptions options_;
  Publishers publishers_;
  Broadcast broadcast_;
  std::atomic<bool> stopping_{false};
  std::atomic<std::thread::id> thread_{};
  std::atomic<bool> recovering_{false};
  std::int64_t started_ns_ = 0;
  std::vector<Arrival> arrivals_;
  std::uint64_t own_changes_ = 0;
  std::uint64_t pending_changes_ = 0;
  std::int64_t next_step_ns_ = 0;
  std::int64_t next_status_ns_ = 0;
  std::int64_t next_tick_ns_ = 0;
  LoopCounts counts_;
  StepSums sums_;
  std::int64_t stepping_ns_ = 0;  // in steps, since the start

  Probes probes_;
  std::atomic<std::size_t> probe_count_{0};
  std::vector<ProbeReading> probe_readings_;
  ProbeColumns probe_columns_;
  StatusColumns status_;
  WriteBarriers::Applied applied_;
  mutable std::mutex publisher_names_mutex_;
  std::map<std::uint64_t, std::string> publisher_names_;
};

}  // namespace collided::engine::service
