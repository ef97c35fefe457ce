#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "server/service/events/broadcast.hpp"
#include "server/service/events/standing_broadcast.hpp"
#include "server/service/events/event_writer.hpp"
#include "server/service/ingest/inbox.hpp"
#include "server/service/ingest/publishers.hpp"
#include "server/service/questions/snapshot_leases.hpp"
#include "server/service/questions/write_barriers.hpp"
#include "server/service/runtime/clock.hpp"
#include "server/service/runtime/counters.hpp"
#include "server/service/runtime/place.hpp"
#include "server/service/runtime/step_sums.hpp"
#include "server/service/runtime/step_traces.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// When the world steps, and the limits of publishers.
struct LoopOptions {
  std::int64_t step_ns = 0;      // 0: a step as soon as something has changed
  std::int64_t recovery_ns = 0;  // longest wait for publishers after a crash; 0: there was none
  bool restores = false;         // the kept state is restored; until that is done, the server recovers
  PublisherLimits limits;
};

/// Counts of the loop since the start. Not atomic: for the world's thread, or once run() has returned.
struct LoopCounts {
  std::uint64_t steps = 0;
  std::uint64_t stalled_steps = 0;   // readers held every free state; tried again each time
  std::uint64_t sweeps_skipped = 0;  // pairs whose motion could not be followed to its end
};

/// The loop of the one thread that writes the world: takes what has arrived, steps, publishes the changes.
class WorldLoop {
 public:
  /// What it works with; all must outlive the WorldLoop. The functions are called on the world's thread, except
  /// `notice`, which is called on any.
  struct Collaborators {
    World& world;
    const WorldClock& clock;
    Inbox& inbox;
    EventWriter& event_writer;
    WriteBarriers& write_barriers;
    SnapshotLeases& leases;
    QuestionCounts& questions;
    const Place& place;
    std::function<void(AskPointer)> admit;           // questions whose write barrier has been passed
    std::function<void()> tick;                      // ten times a second
    std::function<void(const std::string&)> notice;  // a sentence for the log
    std::function<void()> has_new_publisher = {};    // called at once, since a crash may be near; empty: not called
    // Called while the server recovers; empty: nothing to wait for.
    std::function<bool()> is_adding_again = {};  // commands are still being repeated; without time limit
    std::function<bool()> has_all_back = {};     // every publisher from before the crash is back
    // Called before each step.
    std::function<bool()> leaves_out_details = {};  // overloaded: ongoing contacts are not reported again
  };

  WorldLoop(const Collaborators& with, const LoopOptions& options)
      : with_(with),
        options_(options),
        publishers_(with.world, options.limits),
        broadcast_(with.world, with.event_writer, with.notice),
        standing_broadcast_(with.world, with.event_writer, with.notice),
        recovering_(options.recovery_ns > 0 || options.restores),
        started_ns_(steady_ns()) {}

  /// Runs until stop(), then ends every contact with server_stopping and publishes that. The calling thread becomes the
  /// world's. Ends the process if no memory is left.
  void run();
  /// Whether the calling thread is the one of run().
  bool runs_here() const { return thread_.load() == std::this_thread::get_id(); }
  /// Makes run() end soon; does not wait for it. Any thread.
  void stop();

  /// For jobs on this thread.
  World& world() { return with_.world; }
  /// For jobs on this thread; note_probes() after a change.
  Probes& probes() { return probes_; }
  /// Call this after probes() was changed.
  void note_probes() { probe_count_.store(probes_.size(), std::memory_order_relaxed); }
  /// The probes' readings in the newest state, in the order of probes().definition(). For jobs on this thread.
  const std::vector<ProbeReading>& read_probes();
  const Publishers& publishers() const { return publishers_; }
  /// Steps at once: all changes so far become events and a new state. Events of the step stay in world().events() until
  /// the next one. For jobs on this thread.
  void step_now();
  /// Begins publishing after a silence: the newest unpublished events, everything that holds, and the status. For jobs
  /// on this thread.
  void speak(const SpokenBefore& before);
  /// Writes nothing from now on. For jobs on this thread.
  void fall_silent() { with_.event_writer.fall_silent(); }
  /// Steps, announces that this server stops, and falls silent: everything received from publishers is published.
  /// Returns how far that is. For jobs on this thread.
  WriteBarriers::Applied say_last_words();
  /// Counts a change made by a job itself, so that a step follows.
  void note_change() { ++own_changes_; }
  /// settled_ns() as of the last status. Any thread.
  std::int64_t settled_lately_ns() const { return settled_lately_ns_.load(std::memory_order_acquire); }
  const LoopCounts& counts() const { return counts_; }
  /// Any thread.
  const StepSums& sums() const { return sums_; }
  /// The newest steps, stage by stage. Any thread.
  const StepTraces& traces() const { return traces_; }
  /// Period of the steps; 0: a step as soon as something has changed. Any thread.
  std::int64_t step_period_ns() const { return options_.step_ns; }
  /// The publisher's name at the last status; empty: unknown. Any thread.
  std::string publisher_name(std::uint64_t publisher) const;
  /// The clocks of the publishers that live, at the last status. Any thread.
  std::vector<PublisherClock> publisher_clocks() const;
  /// Whether something from before a crash may not be back yet. Any thread.
  bool recovering() const { return recovering_.load(std::memory_order_relaxed); }
  /// Whether everything known is restored. Any thread.
  wire_contract::ServerState state() const {
    const bool lacks = recovering() || !with_.place.whole_since_ns();
    return lacks ? wire_contract::ServerState::recovering : wire_contract::ServerState::ready;
  }
  /// The newest events of contacts, and of standing questions. Any thread.
  const RecentEvents& recent_contacts() const { return broadcast_.recent(); }
  const RecentEvents& recent_standing() const { return standing_broadcast_.recent(); }
  /// Asks the publishers to define everything again, in the statuses of the next second. Any thread.
  void ask_publishers_again();
  /// Writes a sentence to the log. Any thread.
  void say(const std::string& sentence) const { with_.notice(sentence); }
  /// Whether contacts, or probes, have readers. Any thread.
  bool contacts_wanted() const { return with_.event_writer.contacts_wanted(); }
  bool probes_wanted() const { return with_.event_writer.probes_wanted(); }
  /// Number of probes at the last note_probes(). Any thread.
  std::size_t probe_count() const { return probe_count_.load(std::memory_order_relaxed); }

 private:
  void serve();
  void take(Arrival& arrival);
  void take(DefinitionSample& sample);
  void declare_solid(DefinitionSample& sample, bool by_winding) const;
  template <class Apply>
  void apply(Apply&& once);
  void keep_time();
  bool has_recovered() const;
  void take_arrivals();
  void count_taking(std::int64_t now_ns);
  void step_if_due();
  void sum_up(std::int64_t started_ns, std::int64_t stepped_ns);
  void sum_up_fences();
  void sum_up_poses();
  void publish();
  void publish_probes(const Stamp& stamp);
  void write_watermark();
  /// World time up to which every contact is decided and told: what has come since the last step is not. Where nothing is
  /// at work, that is the clock.
  std::int64_t settled_ns() const;
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
  StandingBroadcast standing_broadcast_;
  std::atomic<bool> stopping_{false};
  std::atomic<std::thread::id> thread_{};
  std::atomic<bool> recovering_{false};
  std::atomic<std::int64_t> settled_lately_ns_{0};
  std::atomic<std::int64_t> asks_until_ns_{0};  // steady clock: publishers are asked to define everything again
  std::int64_t started_ns_ = 0;
  std::vector<Arrival> arrivals_;
  std::uint64_t own_changes_ = 0;       // made by jobs, since the last step
  std::uint64_t pending_changes_ = 0;   // waiting for a step, of publishers and jobs
  std::int64_t settled_before_ns_ = 0;  // world time up to which everything was decided before the newest step
  std::int64_t next_step_ns_ = 0;       // these three: steady clock
  std::int64_t next_status_ns_ = 0;
  std::int64_t next_watermark_ns_ = 0;  // likewise
  std::int64_t next_tick_ns_ = 0;
  std::int64_t say_again_ns_ = 0;  // likewise: when all that holds is said once more; 0: not
  // The number of the first event that it has told since it took another server's place, or will tell.
  std::uint64_t told_from_ = 0;
  std::uint64_t told_sequence_ = 0;  // of the newest event that is published
  LoopCounts counts_;
  StepSums sums_;
  StepTraces traces_;
  std::unordered_map<ObjectId, std::uint32_t> objects_in_;  // how many, by fence; only of those with some
  std::int64_t taking_since_ns_ = 0;                        // 0 while no samples are being taken
  std::int64_t taken_ns_ = 0;                               // spent on taking samples since the last step

  Probes probes_;
  std::atomic<std::size_t> probe_count_{0};
  std::vector<ProbeReading> probe_readings_;
  ProbeColumns probe_columns_;
  StatusColumns status_;
  WriteBarriers::Applied applied_;            // at the newest published state
  mutable std::mutex publisher_names_mutex_;  // guards the next two, which other threads read
  std::map<std::uint64_t, std::string> publisher_names_;
  std::vector<PublisherClock> publisher_clocks_;
};

}  // namespace collided::engine::service
