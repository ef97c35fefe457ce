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

/// What a server brings back after a crash: the scenes and objects that commands added, where commands have moved these to,
/// probes, and which publishers were there, so that it knows for whom to wait. Poses and events are not kept: publishers send them anew.
///
/// threads  the world's; writing and syncing is done on a thread of its own, in order, so that a slow disk delays the
///          answers of commands and nothing else
class DurableState {
 public:
  using Notice = std::function<void(const std::string&)>;
  /// notice  takes a sentence for the log; called on the thread of its own
  DurableState(std::unique_ptr<Disk> disk, const std::string& file, bool crashed, Notice notice);
  ~DurableState();
  DurableState(const DurableState&) = delete;
  DurableState& operator=(const DurableState&) = delete;

  /// The commands that an earlier process had carried out, scenes first, then objects, their last moves and probes; empty
  /// where it ended in order.
  const std::vector<CommandAsk>& commands_left() const { return commands_left_; }
  /// The publishers that it knew.
  const std::vector<std::uint64_t>& publishers_left() const { return publishers_left_; }

  void scene_loaded(const std::string& scene, const CommandAsk& ask);
  /// What lies outside of stated covers stays unknown after a crash too, whatever has become of the scenes that stated them.
  void covers_stated();
  bool had_covers() const { return had_covers_; }
  void object_added(const std::string& object, const CommandAsk& ask);
  /// The last one counts. Of an object that no command has added nothing is kept.
  void object_moved(const std::string& object, const CommandAsk& ask);
  void probe_set(const std::string& probe, const CommandAsk& ask);
  void probes_removed(const std::vector<std::string>& probes);
  /// Forgets the scenes and objects of which this is false.
  void keep_only(const std::function<bool(std::string_view scene)>& has_scene,
                 const std::function<bool(std::string_view object)>& has_object);
  /// These and no others from now on; those left count until then.
  void set_publishers(const std::set<std::uint64_t>& publishers);
  /// Called once all of the above is on the disk, or has failed to get there: then not_kept says why. After finish() at once.
  void then(std::function<void(const std::string& not_kept)> done);
  /// Until all of the above is written, or `longest` has passed.
  void wait(std::chrono::milliseconds longest);
  /// Writes what waits, calls whoever waits for it, and takes nothing more.
  void finish();

 private:
  static constexpr std::size_t kMostJobs = 4'096;  // that wait; commands come in dozens
  using Job = std::function<void()>;

  void put(Journal::Entry entry, Journal::Sync sync);
  void erase(std::vector<std::string> keys, Journal::Sync sync);
  void say_problem();

  Journal journal_;  // after the start only on the thread
  std::string said_;
  Notice notice_;
  std::vector<CommandAsk> commands_left_;
  std::vector<std::uint64_t> publishers_left_;
  bool had_covers_ = false;
  std::set<std::string> keys_;
  std::set<std::uint64_t> publishers_;
  WorkQueue<Job> jobs_;
  std::thread thread_;
};

}  // namespace collided::engine::service
