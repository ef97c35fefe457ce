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

#include "server/world/query/fcl_opinion.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine::service {

struct AuditCounts {
  std::uint64_t chosen = 0;  // answers that were to be worked out again
  std::uint64_t audited = 0;
  std::uint64_t differing = 0;
  std::uint64_t skipped = 0;   // chosen, but the auditor was behind
  OpinionCounts opinion = {};  // FCL's of the audited, where it is asked
};

/// Works one answer in so many out again, on a thread of its own, after the reply has left.
/// Workers call consider(); any thread may read counts() and differences().
class BackgroundAudit {
 public:
  /// every   one answer in so many; 0: none, and no thread
  /// notice  told each of the first differences, from the auditing thread
  /// asks_fcl  FCL is asked about every chosen answer too, in a process of its own each time
  BackgroundAudit(std::uint64_t every, std::function<void(const std::string&)> notice, bool asks_fcl = false);
  ~BackgroundAudit();

  /// Chooses among the answers just given. Returns at once; copies what is chosen.
  void consider(const SnapshotRing::Lease& state, const Questions& asked, const Answers& given);
  std::uint64_t every() const { return every_; }
  bool asks_fcl() const { return asks_fcl_; }
  AuditCounts counts() const;
  std::vector<std::string> differences() const;
  void stop();

 private:
  /// States kept alive for auditing: the world's writer needs the others.
  static constexpr std::size_t kMostStates = 4;
  static constexpr std::size_t kMostWaiting = 4'096;
  static constexpr std::size_t kMostReported = 16;

  struct Pinned {
    std::uint64_t version = 0;
    SnapshotRing::Lease lease;
  };
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
  /// Keeps and tells the first ones.
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
