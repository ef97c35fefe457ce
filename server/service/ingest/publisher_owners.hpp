#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace collided::engine::service {

/// Which process a publisher's number belongs to: the DDS participant whose writer used it first, for as long as one of
/// its writers of that number lives. What others send under it is refused. So is a number too many of one participant.
///
/// threads  any
class PublisherOwners {
 public:
  static constexpr std::size_t kMostOfOne = 256;  // numbers of one participant

  /// Whether the writer may send under this number; it holds it from then on.
  bool claim(std::uint64_t publisher, std::uint64_t participant, std::uint64_t writer);
  /// The writer holds the number no longer.
  void release(std::uint64_t publisher, std::uint64_t writer);
  /// Samples refused since the start.
  std::uint64_t refused() const { return refused_.load(std::memory_order_relaxed); }
  /// The publishers under whose numbers others have sent since the last call, at most 8.
  std::vector<std::uint64_t> take_forged();

 private:
  struct Owner {
    std::uint64_t participant = 0;
    std::set<std::uint64_t> writers;
  };
  mutable std::mutex mutex_;
  std::map<std::uint64_t, Owner> owners_;              // by publisher
  std::map<std::uint64_t, std::size_t> number_count_;  // by participant
  std::set<std::uint64_t> forged_;
  std::atomic<std::uint64_t> refused_{0};
};

}  // namespace collided::engine::service
