#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/service/durability/journal.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/runtime/work_queue.hpp"

namespace collided::engine::service {

/// What a server restores after a crash: the scenes and objects that commands added, where commands have moved these
/// to, probes, and which publishers were there, so that it knows which to wait for. Poses and events are not kept:
/// publishers send them again.
///
/// threads  the world's; writing and syncing is done in order on a thread of its own, so a slow disk delays the answers
///          of commands and nothing else
class DurableState {
 public:
  using Notice = std::function<void(const std::string&)>;
  /// Reads what an earlier process left.
  ///
  /// crashed  that process did not end in order; otherwise what it left is deleted
  /// notice   takes a sentence for the log, mostly called on the thread of its own
  DurableState(std::unique_ptr<Disk> disk, const std::string& file, bool crashed, Notice notice);
  ~DurableState();
  DurableState(const DurableState&) = delete;
  DurableState& operator=(const DurableState&) = delete;

  /// The commands that the crashed process had carried out: scenes first, then objects, their last moves, probes. Empty
  /// where it ended in order.
  const std::vector<CommandAsk>& commands_left() const { return commands_left_; }
  /// The publishers that the crashed process knew.
  const std::vector<std::uint64_t>& publishers_left() const { return publishers_left_; }

  /// These keep what a command did; the last one of a name counts.
  void scene_loaded(const std::string& scene, const CommandAsk& ask);
  /// Keeps that covers were stated: after a crash, too, what lies outside of them is unknown, whatever became of the
  /// scenes that stated them.
  void covers_stated();
  /// Whether the crashed process had stated covers.
  bool had_covers() const { return had_covers_; }
  void object_added(const std::string& object, const CommandAsk& ask);
  /// Keeps an object's last move. Ignored for an object that no command has added.
  void object_moved(const std::string& object, const CommandAsk& ask);
  void probe_set(const std::string& probe, const CommandAsk& ask);
  void probes_removed(const std::vector<std::string>& probes);
  /// Forgets the scenes and objects for which this is false.
  void keep_only(const std::function<bool(std::string_view scene)>& has_scene,
                 const std::function<bool(std::string_view object)>& has_object);
  /// From now on these publishers count and no others; until the first call, those that the crashed process left.
  void set_publishers(const std::set<std::uint64_t>& publishers);
  /// Calls done("") once all of the above is on the disk, or done(why) where it could not be written. After finish() at
  /// once.
  void then(std::function<void(const std::string& not_kept)> done);
  /// Waits until all of the above is written, at most for `longest`.
  void wait(std::chrono::milliseconds longest);
  /// Writes what waits, calls what then() was given, and takes nothing more.
  void finish();

 private:
  static constexpr std::size_t kMostJobs = 4'096;  // waiting; beyond it publishers are not noted
  using Job = std::function<void()>;

  void put(Journal::Entry entry, Journal::Sync sync);
  void erase(std::vector<std::string> keys, Journal::Sync sync);
  void say_problem();

  Journal journal_;   // used by thread_ alone once that runs
  std::string said_;  // the problem reported last
  Notice notice_;
  std::vector<CommandAsk> commands_left_;
  std::vector<std::uint64_t> publishers_left_;
  bool had_covers_ = false;
  std::set<std::string> keys_;  // in the journal once all jobs are done
  std::set<std::uint64_t> publishers_;
  WorkQueue<Job> jobs_;
  std::thread thread_;
};

}  // namespace collided::engine::service
