#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/service/durability/epoch.hpp"
#include "server/service/durability/journal.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/runtime/work_queue.hpp"

namespace collided::engine::service {

/// What a server restores after a crash: the scenes and objects that commands added, where commands have moved these
/// to, what they took out of scenes, probes, kept fences, rules for pairs, what is attached to what, and which publishers were there, so that it knows
/// which to wait for. Poses and events are not kept: publishers send them again.
/// What had been acknowledged and cannot be restored is a loss, which lasts, over crashes too, until it is accepted.
///
/// threads  the world's, where nothing else is said; writing and syncing is done in order on a thread of its own, so a
///          slow disk delays the answers of commands and nothing else
class DurableState {
 public:
  using Notice = std::function<void(const std::string&)>;
  /// Reads what an earlier process left. Writes only where that ended in order: what it left is deleted then.
  ///
  /// past    how that process ended, by its epoch's file; where the journal says it too, the journal counts
  /// notice  takes a sentence for the log, mostly called on the thread of its own
  DurableState(std::unique_ptr<Disk> disk, const std::string& file, PastEnd past, Notice notice);
  ~DurableState();
  DurableState(const DurableState&) = delete;
  DurableState& operator=(const DurableState&) = delete;

  /// Whether the earlier process did not end in order.
  bool crashed() const { return crashed_; }
  /// What the crashed process had carried out, as commands: scenes out of the start options that it had removed, scenes,
  /// what it had taken out of scenes, objects, moves, probes, fences. The request of each is its place here, from 1 on. Empty
  /// where it ended in order.
  const std::vector<CommandAsk>& commands_left() const { return commands_left_; }
  /// The publishers that the crashed process knew.
  const std::vector<std::uint64_t>& publishers_left() const { return publishers_left_; }

  /// What is missing, a sentence each. Any thread.
  std::vector<std::string> losses() const;
  bool has_losses() const { return has_losses_.load(); }
  /// Why what is added now is lost with a crash, such as a full disk; empty: it is not. Any thread.
  std::string problem() const;
  /// One of commands_left() could not be carried out again. It stays in the journal until it is accepted, or something
  /// of its name is kept anew. Any thread.
  void not_restored(std::uint64_t request, const std::string& why);
  /// Whether one of commands_left() is still to be carried out: no client has meanwhile put something in its place, or
  /// taken that away.
  bool is_due(std::uint64_t request) const;
  /// All of commands_left() was carried out again, or could not be.
  void note_restored();
  /// Forgets all losses, and what was not restored.
  void accept_losses();

  /// The scenes out of the start options, which the next process loads whatever is kept here.
  void set_start_scenes(std::set<std::string> scenes) { start_scenes_ = std::move(scenes); }
  /// These keep what a command did; the last one of a name counts.
  void scene_loaded(const std::string& scene, const CommandAsk& ask);
  /// Keeps that a scene is gone, with all that was kept of its members.
  void scene_removed(const std::string& scene);
  /// What a command took out of the world: a part or object of a scene, or what a command had added (scene empty).
  struct Removed {
    std::string scene;
    std::string name;
  };
  void removed(const std::vector<Removed>& gone);
  /// Keeps that covers were stated: after a crash, too, what lies outside of them is unknown, whatever became of the
  /// scenes that stated them.
  void covers_stated();
  /// Whether the crashed process had stated covers.
  bool had_covers() const { return had_covers_; }
  void object_added(const std::string& object, const CommandAsk& ask);
  /// Keeps the last move of an object of a scene, or of one that a command has added (scene empty); ignored for others.
  void object_moved(const std::string& scene, const std::string& object, const CommandAsk& ask);
  void probe_set(const std::string& probe, const CommandAsk& ask);
  void probes_removed(const std::vector<std::string>& probes);
  /// The command and the name of each.
  void fences_set(const std::vector<std::pair<std::string, CommandAsk>>& fences);
  void fences_removed(const std::vector<std::string>& fences);
  /// Keeps the rules of which pairs may touch, in their order, in place of as many as there were.
  void rules_set(std::size_t earlier_count, const std::vector<std::string>& rules);
  /// Keeps what an object is attached to, as the command that does it again.
  void attached(const std::string& child, const std::string& command);
  void detached(const std::string& child);
  /// Keeps what becomes of the shards, in place of what was to become of them before.
  void succession_set(const CommandAsk& ask);
  /// From now on these publishers count and no others; until the first call, those that the crashed process left.
  void set_publishers(const std::set<std::uint64_t>& publishers);
  /// Calls done("") once all of the above is on the disk, or done(why) where it could not be written. After finish() at
  /// once.
  void then(std::function<void(const std::string& not_kept)> done);
  /// Calls done(""), where so many bytes more will find room on the disk, else done(why). Any thread.
  void ask_room(std::uint64_t bytes, std::function<void(const std::string& no_room)> done);
  /// Calls done, on the thread of its own, with all that is kept as of now, as commands in the order in which they are
  /// carried out again.
  void list_kept(std::function<void(std::vector<CommandAsk> kept)> done);
  /// Waits until all of the above is written, at most for `longest`.
  void wait(std::chrono::milliseconds longest);
  /// Writes what waits, calls what then() was given, and takes nothing more.
  void finish();
  /// After finish(): writes down that this process ends in order, so that what it kept is not restored.
  void close() { journal_.close(); }

 private:
  static constexpr std::size_t kMostJobs = 4'096;  // waiting; beyond it publishers are not noted
  using Job = std::function<void()>;

  void read_left();
  void change(std::vector<std::string> erased, std::vector<Journal::Entry> put,
              Journal::Sync sync = Journal::Sync::now);
  void change_without_members(const std::string& scene, std::vector<std::string> erased,
                              std::vector<Journal::Entry> put);
  void note_erased(const std::string& key);
  void lose(const std::string& key, const std::string& why);
  void say_problem();

  Journal journal_;  // used by thread_ alone once that runs
  mutable std::mutex said_mutex_;
  std::string said_;  // the problem reported last
  Notice notice_;
  bool crashed_ = false;
  std::vector<CommandAsk> commands_left_;
  std::vector<std::string> keys_left_;  // in the journal, of commands_left_
  std::vector<std::uint64_t> publishers_left_;
  bool had_covers_ = false;
  std::set<std::string> start_scenes_;
  mutable std::mutex losses_mutex_;            // for these four
  std::map<std::string, std::string> losses_;  // sentence by key in the journal
  std::set<std::string> keys_;                 // what this process has put, in the journal once all jobs are done
  std::set<std::string> erased_;               // by this process, before note_restored()
  bool is_restoring_ = false;
  std::atomic<bool> has_losses_{false};
  std::set<std::uint64_t> publishers_;
  WorkQueue<Job> jobs_;
  std::thread thread_;
};

}  // namespace collided::engine::service
