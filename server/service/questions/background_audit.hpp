#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/world/audit/fcl_opinion.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine::service {

/// What the audit has found so far.
struct AuditCounts {
  std::uint64_t chosen = 0;     // answers chosen for the audit
  std::uint64_t audited = 0;    // recomputed
  std::uint64_t differing = 0;  // of the audited, not the same as the answer given
  std::uint64_t skipped = 0;    // chosen, but too many waited already
  OpinionCounts opinion = {};   // FCL's opinions of the audited, if enabled
};

/// Recomputes one answer in every `every`, exactly and without an index, on a thread of its own, after the reply has
/// left.
///
/// threads  workers call consider(); any may read counts() and differences()
class BackgroundAudit {
 public:
  /// every     one answer in this many; 0: none, and no thread
  /// notice    called from the auditing thread with each of the first differences
  /// asks_fcl  FCL checks every chosen answer too, each time in a process of its own
  BackgroundAudit(std::uint64_t every, std::function<void(const std::string&)> notice, bool asks_fcl = false);
  ~BackgroundAudit();

  /// Chooses among the answers just given and copies those chosen. Returns at once.
  void consider(const SnapshotRing::Lease& state, const Questions& asked, const Answers& given);
  std::uint64_t every() const { return every_; }
  bool asks_fcl() const { return asks_fcl_; }
  /// Any thread.
  AuditCounts counts() const;
  /// The first differences, as sentences.
  std::vector<std::string> differences() const;
  /// Ends the thread; waiting answers are not audited.
  void stop();

 private:
  /// States that the audit keeps alive at once: the world's writer needs the rest of its ring.
  static constexpr std::size_t kMostStates = 4;
  static constexpr std::size_t kMostWaiting = 4'096;
  static constexpr std::size_t kMostReported = 16;

  struct Pinned {
    std::uint64_t version = 0;
    SnapshotRing::Lease lease;
  };
  /// One answer to be audited, with copies of everything its question points to.
  struct Item {
    std::shared_ptr<const Pinned> state;
    Questions question;
    std::string only;
    std::string skip;
    std::vector<double> numbers;
    Answers given;
  };

  void choose(const SnapshotRing::Lease& state, const Questions& asked, const Answers& given, std::size_t index,
              std::size_t first_hit);
  std::shared_ptr<const Pinned> pin(const SnapshotRing::Lease& state);
  void run();
  void work_out(const Item& item);
  void ask_fcl(const Item& item);
  /// Keeps and reports a difference, up to kMostReported of them.
  void tell(const Item& item, const std::string& difference);

  const std::uint64_t every_;
  const std::function<void(const std::string&)> notice_;
  const bool asks_fcl_;
  std::atomic<std::uint64_t> considered_{0};
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<std::unique_ptr<Item>> waiting_;
  std::vector<std::weak_ptr<const Pinned>> pinned_;
  std::vector<std::string> differences_;
  AuditCounts counts_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace collided::engine::service
