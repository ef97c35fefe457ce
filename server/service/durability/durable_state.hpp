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

/// The state that a server restores after a stop or a crash: the inventory of what commands have added. After a crash
/// it also knows which publishers were connected, and waits for them. Poses and events are not kept: publishers send
/// them again. Acknowledged state that cannot be restored is a loss, which lasts until it is accepted, even over
/// further crashes.
///
/// threads  the world's, unless stated otherwise; writing and syncing is done in order on a thread of its own, so a
///          slow disk delays only the answers of commands
class DurableState {
 public:
  using Notice = std::function<void(const std::string&)>;
  /// What to do with the state of an earlier process.
  enum class Start : std::uint8_t { restores, drops };
  /// Reads the state of an earlier process. Throws StateError if another version wrote it, unless it is dropped.
  ///
  /// past    how that process ended, by its epoch's file; the journal takes precedence if it has this too
  /// notice  takes a sentence for the log, mostly called on the thread of its own
  DurableState(std::unique_ptr<Disk> disk, const std::string& file, PastEnd past, Notice notice,
               Start start = Start::restores);
  ~DurableState();
  DurableState(const DurableState&) = delete;
  DurableState& operator=(const DurableState&) = delete;

  /// Whether the earlier process ended without a proper stop.
  bool crashed() const { return crashed_; }
  /// The state of the earlier process, as commands in the order of their kinds. Each is known by its position here,
  /// from 1 on.
  const std::vector<KeptCommand>& commands_left() const { return commands_left_; }
  /// With Start::drops: how much was dropped of each kind, as words; empty: nothing.
  const std::string& dropped() const { return dropped_; }
  /// The publishers that the crashed process knew; none if it was stopped properly.
  const std::vector<std::uint64_t>& publishers_left() const { return publishers_left_; }

  /// What is missing, a sentence each. Any thread.
  std::vector<std::string> losses() const;
  bool has_losses() const { return has_losses_.load(); }
  /// Why new entries are lost when the server ends, such as a full disk; empty: they are not. Any thread.
  std::string problem() const;
  /// One of commands_left() failed when repeated. It stays in the journal until it is accepted, or its name is stored
  /// again. Any thread.
  void not_restored(std::uint64_t place, const std::string& why);
  /// Whether one of commands_left() must still be carried out: no client has since replaced or removed it. Any thread.
  bool is_due(std::uint64_t place) const { return is_due(commands_left_.at(place - 1).key); }
  bool is_due(const KeptKey& key) const;
  /// Forgets all losses, and commands that were not restored. Returns the keys of the latter.
  std::vector<KeptKey> accept_losses();

  /// Adds the entries of commands_left() to the inventory, and drops those that contradict the start options: entries
  /// of scenes that these no longer name or, under the same name, now load themselves. Call this before commands_left()
  /// are carried out.
  void restore(Inventory& inventory);
  /// Stores what commands have changed, except what is removed with a client or a publisher.
  void keep(const Inventory::Changes& changes);
  /// The commands that a follower carries out: all of the inventory, except what is removed with a client or a
  /// publisher, and attachments from before the start that wait for their parents.
  std::vector<KeptCommand> followed(const Inventory& inventory) const;
  /// Stores that covers were stated: after a crash the space outside of them stays unknown, even if the scenes that
  /// stated them are gone.
  void covers_stated();
  /// Whether the crashed process had stated covers.
  bool had_covers() const { return had_covers_; }
  /// Replaces the set of publishers; until the first call, it holds those that the crashed process left.
  void set_publishers(const std::set<std::uint64_t>& publishers);
  /// Calls done("") once all of the above is on disk, or done(why) if it could not be written. After finish() at once.
  void then(std::function<void(const std::string& not_kept)> done);
  /// Calls done("") if the disk has room for this many more bytes, else done(why). Any thread.
  void ask_room(std::uint64_t bytes, std::function<void(const std::string& no_room)> done);
  /// Waits until all of the above is written, at most for `longest`.
  void wait(std::chrono::milliseconds longest);
  /// Writes what is queued, calls the functions given to then(), and accepts nothing more.
  void finish();
  /// Call this after finish(): records that this process was stopped properly, so that the next one waits for no
  /// publishers.
  void close() { journal_.close(); }

 private:
  static constexpr std::size_t kMostJobs = 4'096;  // waiting; beyond it publishers are not stored
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
  mutable std::mutex losses_mutex_;            // guards these two
  std::map<std::string, std::string> losses_;  // sentence by key in the journal
  std::set<std::string> due_;                  // of commands_left_: not yet put or erased by this process
  std::atomic<bool> has_losses_{false};
  std::set<std::uint64_t> publishers_;
  WorkQueue<Job> jobs_;
  std::thread thread_;
};

}  // namespace collided::engine::service
