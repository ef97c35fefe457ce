#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "idl/dds.hpp"
#include "server/fleet/change_feed.hpp"

namespace collided::engine::service {

/// Follows a primary: fetches all that its commands have done, then repeats each change in order.
///
/// threads  one of its own; the calls here are for any
class ChangeFollower {
 public:
  struct Collaborators {
    /// Carries out a change and waits for it; returns why it was refused, empty: it was not.
    std::function<std::string(const WorldChange&)> carry_out;
    std::function<void(const std::string&)> notice;
  };
  /// self  the number of this server
  ChangeFollower(const dds::Participant& participant, std::uint64_t self, const std::string& name_space,
                 Collaborators with);
  ~ChangeFollower();
  ChangeFollower(const ChangeFollower&) = delete;
  ChangeFollower& operator=(const ChangeFollower&) = delete;

  /// The primary that is to be followed; the first one counts.
  void follow(std::uint64_t primary, const std::string& name);
  /// Another server has taken the primary's place, and had carried out so many of its changes. It is followed from there on,
  /// once this server has carried out as many: after that both have done the same. To be called again and again.
  /// returns  false: it cannot be followed, since this server has done others
  bool follow_heir(std::uint64_t heir, const std::string& name, std::uint64_t carried_out);
  /// Carries out nothing any more: the primary is given up.
  void give_up() { is_over_.store(true); }
  /// The same, and waits for what is under way; not for the own thread.
  void leave();
  /// The number of the newest of the primary's changes that was carried out.
  std::uint64_t carried_out() const { return last_sequence_.load(); }
  /// Whether it has carried out a change some seconds ago.
  bool has_carried_out_lately() const;
  /// Which primary it follows; 0: none yet.
  std::uint64_t primary() const { return primary_.load(); }
  /// Which fetch of all that is kept it waits for.
  std::uint64_t fetch() const { return fetch_.load(); }
  /// All that the primary had kept was carried out, and nothing was missed since.
  bool is_whole() const { return is_whole_.load() && alarms().empty(); }
  /// What it lacks of the primary, a sentence each.
  std::vector<std::string> alarms() const;

 private:
  /// A server that has taken the primary's place.
  struct NextPrimary {
    std::uint64_t server = 0;
    std::string name;
    std::uint64_t carried_out = 0;
    std::int64_t heard_ns = 0;  // first, steady clock
  };
  /// A change of a server that is not followed yet.
  struct EarlyChange {
    std::uint64_t server = 0;
    std::uint64_t sequence = 0;
    WorldChange change;
  };
  void run();
  void take();
  void take_fetched();
  void take_live();
  void keep_early();
  void turn_to_heir();
  void carry_out_next(std::uint64_t sequence, const WorldChange& change);
  void carry_out(const WorldChange& change);
  void raise(std::string sentence);

  const std::uint64_t self_;
  const Collaborators with_;
  std::atomic<std::uint64_t> primary_{0};
  std::atomic<std::uint64_t> fetch_{0};
  std::atomic<bool> is_whole_{false};
  mutable std::mutex mutex_;  // for these three
  std::string primary_name_;
  std::vector<std::string> alarms_;
  std::optional<NextPrimary> heir_;  // until it is followed
  dds::Topic<wire::Change> topic_;
  dds::Reader<wire::Change> reader_;
  dds::WaitSet waitset_;
  dds::Sample<wire::Change> sample_;  // this and the next are of the thread
  std::vector<WorldChange> fetched_;
  std::uint64_t expected_left_ = 0;  // of the next one that is fetched
  std::deque<EarlyChange> early_;
  std::atomic<std::uint64_t> last_sequence_{0};  // of the newest change that was carried out
  std::atomic<std::int64_t> carried_out_ns_{0};  // when the newest change was, steady clock; 0: none was
  std::int64_t asked_ns_ = 0;                    // when the fetch was asked for, steady clock
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

}  // namespace collided::engine::service
