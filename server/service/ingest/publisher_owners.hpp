#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace collided::engine::service {

/// Who sends under a publisher's number.
struct NumberOwner {
  NumberOwner(std::uint64_t its_participant, std::string its_keys = {})
      : participant(its_participant), keys_of(std::move(its_keys)) {}

  std::uint64_t participant;  // 0: it is gone already
  std::string keys_of;        // the name in its keys; empty: the server has none
};

/// Which process a publisher's number belongs to: the DDS participant whose writer used it first, for as long as one of
/// its writers of that number lives. What others send under it is refused. So is a number too many of one participant.
/// With keys, a number stays with the name in them when the process is gone: what a lost publisher left is nobody else's.
///
/// threads  any
class PublisherOwners {
 public:
  static constexpr std::size_t kMostOfOne = 256;         // numbers of one participant
  static constexpr std::size_t kMostRemembered = 1'024;  // numbers of one name; then its own oldest one is forgotten

  /// Whether the writer may send under this number; it holds it from then on.
  bool claim(std::uint64_t publisher, const NumberOwner& owner, std::uint64_t writer);
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
  bool may_hold(std::uint64_t publisher, const NumberOwner& owner) const;
  void remember(std::uint64_t publisher, const std::string& keys_of);

  mutable std::mutex mutex_;
  std::map<std::uint64_t, Owner> owners_;                // by publisher
  std::map<std::uint64_t, std::size_t> number_count_;    // by participant
  std::map<std::uint64_t, std::string> name_of_number_;  // with keys: whose a number is, also while it is free
  std::map<std::string, std::deque<std::uint64_t>> numbers_of_name_;  // the same, oldest first
  std::set<std::uint64_t> forged_;
  std::atomic<std::uint64_t> refused_{0};
};

}  // namespace collided::engine::service
