#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace collided::engine::service {

/// The sender of samples under a publisher's number.
struct NumberOwner {
  NumberOwner(std::uint64_t its_participant, std::string its_keys = {})
      : participant(its_participant), keys_of(std::move(its_keys)) {}

  std::uint64_t participant;  // 0: it is already gone
  std::string keys_of;        // the name in its keys; empty: the server has none
};

/// Records the process that owns a publisher's number: the DDS participant whose writer used it first, as long as one
/// of its writers of that number lives. Samples of others under it are refused. With keys, a number stays with the name
/// in them when the process is gone: another name cannot take what a lost publisher left.
///
/// Numbers are limited: those of one participant, and in total. The last kReserved go to owners that have few, so that
/// a process or key with many does not shut out the others. A number whose writers are gone does not count.
///
/// threads  any
class PublisherOwners {
 public:
  static constexpr std::size_t kMost = 1'000;            // numbers with a living writer
  static constexpr std::size_t kReserved = 128;          // of them, for owners ...
  static constexpr std::size_t kFew = 8;                 // ... with fewer numbers than this
  static constexpr std::size_t kMostOfOne = 256;         // numbers of one participant
  static constexpr std::size_t kMostRemembered = 1'024;  // numbers of one name; then its own oldest one is forgotten

  /// Whether the writer may send under this number; it then holds the number.
  bool claim(std::uint64_t publisher, const NumberOwner& owner, std::uint64_t writer);
  /// The writer no longer holds the number.
  void release(std::uint64_t publisher, std::uint64_t writer);
  /// Samples refused since the start.
  std::uint64_t refused() const { return refused_.load(std::memory_order_relaxed); }
  /// The publishers under whose numbers others have sent since the last call, at most 8.
  std::vector<std::uint64_t> take_forged();
  /// Why a number was recently refused because there are too many; empty: it was not.
  std::string why_refused(std::uint64_t publisher) const;
  /// The number refused last because there are too many. Nothing until twice as many samples were refused for that as
  /// at the last one returned, so that a log of them stays short.
  std::optional<std::uint64_t> take_refused();

 private:
  enum class Excess : std::uint8_t { too_many_of_one, too_many };
  struct Owner {
    std::uint64_t participant = 0;
    std::string keys_of;
    std::set<std::uint64_t> writers;
  };
  /// How many numbers an owner holds: its key's if there are keys, since one key may run many processes.
  std::size_t share_of(const NumberOwner& owner) const;
  std::optional<Excess> why_not(const NumberOwner& owner) const;
  bool may_hold(std::uint64_t publisher, const NumberOwner& owner) const;
  void remember(std::uint64_t publisher, const std::string& keys_of);
  void note_refused(std::uint64_t publisher, Excess refusal);

  mutable std::mutex mutex_;
  std::map<std::uint64_t, Owner> owners_;                // by publisher
  std::map<std::uint64_t, std::size_t> number_count_;    // by participant
  std::map<std::string, std::size_t> count_of_name_;     // with keys: by the name in them
  std::map<std::uint64_t, std::string> name_of_number_;  // with keys: the owner of a number, also while it is free
  std::map<std::string, std::deque<std::uint64_t>> numbers_of_name_;  // the same, oldest first
  std::set<std::uint64_t> forged_;
  std::map<std::uint64_t, Excess> refusals_;  // by publisher; the newest few
  std::deque<std::uint64_t> refused_order_;   // their publishers, oldest first
  std::uint64_t too_many_ = 0;                // samples refused because there are too many
  std::uint64_t too_many_returned_ = 0;       // the same, at the last take_refused() that returned one
  std::atomic<std::uint64_t> refused_{0};
};

}  // namespace collided::engine::service
