#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/service/durability/epoch.hpp"
#include "server/service/durability/inventory.hpp"
#include "server/service/durability/journal.hpp"
#include "server/service/runtime/work_queue.hpp"

namespace collided::engine::service {

/// The state folder cannot be used: one sentence for the user.
struct StateError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What a server restores after a stop or a crash: the inventory of what commands have brought in. After a crash it also
/// knows which publishers were there, and waits for them. Poses and events are not kept: publishers send them again.
/// What had been acknowledged and cannot be restored is a loss, which lasts, over crashes too, until it is accepted.
///
/// threads  the world's, where nothing else is said; writing and syncing is done in order on a thread of its own, so a
///          slow disk delays the answers of commands and nothing else
class DurableState {
 public:
  using Notice = std::function<void(const std::string&)>;
  /// What becomes of what an earlier process left.
  enum class Start : std::uint8_t { restores, drops };
  /// Reads what an earlier process left. Throws StateError if another version wrote it, unless it is dropped.
  ///
  /// past    how that process ended, by its epoch's file; where the journal says it too, the journal counts
  /// notice  takes a sentence for the log, mostly called on the thread of its own
  DurableState(std::unique_ptr<Disk> disk, const std::string& file, PastEnd past, Notice notice,
               Start start = Start::restores);
  ~DurableState();
  DurableState(const DurableState&) = delete;
  DurableState& operator=(const DurableState&) = delete;

  /// Whether the earlier process did not end in order.
  bool crashed() const { return crashed_; }
  /// What the earlier process had carried out, as commands in the order of their kinds. Each is known by its place
  /// here, from 1 on.
  const std::vector<KeptCommand>& commands_left() const { return commands_left_; }
  /// With Start::drops: how much was dropped of each kind, as words; empty: nothing.
  const std::string& dropped() const { return dropped_; }
  /// The publishers that the crashed process knew; none if it ended in order.
  const std::vector<std::uint64_t>& publishers_left() const { return publishers_left_; }

  /// What is missing, a sentence each. Any thread.
  std::vector<std::string> losses() const;
  bool has_losses() const { return has_losses_.load(); }
  /// Why what is added now is lost when the server ends, such as a full disk; empty: it is not. Any thread.
  std::string problem() const;
  /// One of commands_left() could not be carried out again. It stays in the journal until it is accepted, or something
  /// of its name is kept anew. Any thread.
  void not_restored(std::uint64_t place, const std::string& why);
  /// Whether one of commands_left() is still to be carried out: no client has meanwhile put something in its place, or
  /// taken that away. Any thread.
  bool is_due(std::uint64_t place) const { return is_due(commands_left_.at(place - 1).key); }
  bool is_due(const KeptKey& key) const;
  /// Forgets all losses, and what was not restored. Returns the keys of the latter.
  std::vector<KeptKey> accept_losses();

  /// Gives the inventory what commands_left() bring in, and drops what the start options contradict: what was kept of
  /// scenes that they no longer name or, under the same name, now load themselves. Before commands_left() are carried out.
  void restore(Inventory& inventory);
  /// Keeps what commands have changed, but for what goes with a client or a publisher.
  void keep(const Inventory::Changes& changes);
  /// What a server that follows carries out: all of the inventory, but for what goes with a client or a publisher, and
  /// for attachments of before the start that wait for their parents.
  std::vector<KeptCommand> followed(const Inventory& inventory) const;
  /// Keeps that covers were stated: after a crash, too, what lies outside of them is unknown, whatever became of the
  /// scenes that stated them.
  void covers_stated();
  /// Whether the crashed process had stated covers.
  bool had_covers() const { return had_covers_; }
  /// From now on these publishers count and no others; until the first call, those that the crashed process left.
  void set_publishers(const std::set<std::uint64_t>& publishers);
  /// Calls done("") once all of the above is on the disk, or done(why) where it could not be written. After finish() at
  /// once.
  void then(std::function<void(const std::string& not_kept)> done);
  /// Calls done(""), where so many bytes more will find room on the disk, else done(why). Any thread.
  void ask_room(std::uint64_t bytes, std::function<void(const std::string& no_room)> done);
  /// Waits until all of the above is written, at most for `longest`.
  void wait(std::chrono::milliseconds longest);
  /// Writes what waits, calls what then() was given, and takes nothing more.
  void finish();
  /// After finish(): writes down that this process ends in order, so that the next one waits for no publishers.
  void close() { journal_.close(); }

 private:
  static constexpr std::size_t kMostJobs = 4'096;  // waiting; beyond it publishers are not noted
  using Job = std::function<void()>;

  void take_over(const std::string& file, PastEnd past);
  void read_left();
  void forget_publishers();
  void change(std::vector<std::string> erased, std::vector<Journal::Entry> put,
              Journal::Sync sync = Journal::Sync::now);
  void lose(const std::string& key, const std::string& why);
  void say_problem();

  Journal journal_;  // used by thread_ alone once that runs
  mutable std::mutex said_mutex_;
  std::string said_;  // the problem reported last
  Notice notice_;
  bool crashed_ = false;
  std::string dropped_;
  std::vector<KeptCommand> commands_left_;
  std::vector<std::uint64_t> publishers_left_;
  bool had_covers_ = false;
  mutable std::mutex losses_mutex_;            // for these two
  std::map<std::string, std::string> losses_;  // sentence by key in the journal
  std::set<std::string> due_;                  // of commands_left_: what this process has neither put nor erased
  std::atomic<bool> has_losses_{false};
  std::set<std::uint64_t> publishers_;
  WorkQueue<Job> jobs_;
  std::thread thread_;
};

}  // namespace collided::engine::service
