#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "server/fleet/authority/leadership.hpp"
#include "server/fleet/authority/serving_term.hpp"
#include "server/service/runtime/place.hpp"

namespace collided::engine::service {

struct ElectionOptions {
  std::string store;        // what the store is called in sentences
  std::string prefix;       // of the keys
  int life_s = 0;           // of the lease
  std::string description;  // of this server, in the store
  TakeOverMode mode = TakeOverMode::strict;
};

/// Has this server's leadership taken, confirmed and given up, on a thread of its own; who steps and who answers only
/// reads the term.
///
/// threads  begin(), win(), connect() and close() are for one thread, the rest is for any
class Election {
 public:
  using Notice = std::function<void(const std::string&)>;  // takes a sentence; called on any thread
  /// term  over until this server has the place, and whenever it cannot be confirmed; must outlive this
  Election(std::unique_ptr<etcd::LeaseStore> store, ElectionOptions options, ServingTerm& term, Notice notice);
  /// Closes.
  ~Election();
  Election(const Election&) = delete;
  Election& operator=(const Election&) = delete;

  /// Draws the epoch, at least that one. Waits for the store twice as long as a lease lives; throws CannotServeNow.
  std::uint64_t begin(std::uint64_t least);
  /// Becomes the primary. Waits as long for the store, and for another one's place: a server that was killed and is
  /// started again finds its own. Throws CannotServeNow.
  void win();
  /// has_successor  called with the reason once another server has the place, on the thread of the election; also where that was so
  /// before
  void connect(Notice has_successor);

  /// Whether this server has the place of the one with that epoch. If not, the thread tries to take it for a quarter of
  /// a second: to be called again and again.
  bool succeeds(std::uint64_t predecessor);
  bool has_place() const { return has_place_.load(); }
  /// Draws a greater epoch, at least `least`, for a standby. Waits for the store, after connect().
  /// returns  nothing if the store does not answer, see problem(), or if this server has the place
  std::optional<std::uint64_t> draw_again(std::uint64_t least);
  /// Gives the place up for a moment, for another one to take it. Waits for the store.
  void lend();
  /// Has the place again. Waits for the store. False: another one has it.
  bool take_back();
  /// What is wrong between this server and the store, as a sentence; empty: nothing.
  std::string problem() const;
  TakeOverMode mode() const { return options_.mode; }

  /// Gives up the place, and ends the thread.
  void close();

 private:
  void start();
  void run();
  void look_after(std::uint64_t wanted);
  void hold();
  void try_to_succeed(std::uint64_t predecessor);
  void note_problem(const std::string& problem);
  void leave_to(const std::string& why);
  std::int64_t period_ns(bool wants) const;
  std::int64_t patience_ns() const;
  /// Has the thread do it, and waits until it is done.
  void done_on_thread(std::function<void()> job);

  const ElectionOptions options_;
  ServingTerm& term_;
  const Notice notice_;
  const std::unique_ptr<etcd::LeaseStore> store_;
  Leadership leadership_;         // of the thread, once that runs; the next two too
  bool is_waiting_told_ = false;  // that another one's lease has not ended yet
  bool is_silence_told_ = false;
  std::atomic<bool> has_place_{false};
  mutable std::mutex mutex_;  // for the rest
  std::condition_variable changed_;
  Notice has_successor_;
  std::string problem_;
  std::string why_left_;           // another one has the place; empty: none
  std::uint64_t predecessor_ = 0;  // whose place is wanted
  std::int64_t wanted_until_ns_ = 0;
  std::int64_t next_ns_ = 0;  // when the thread looks next, steady clock
  std::function<void()> job_;
  bool is_closing_ = false;
  std::thread thread_;
};

}  // namespace collided::engine::service
