#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "client/library/connection/server_pulse.hpp"
#include "client/library/publishing/published_objects.hpp"
#include "client/fleet/shards/shard_links.hpp"
#include "collided/shards.hpp"

namespace collided::client {

/// One publisher of each shard where an object is or may soon be, and which shard holds which object.
///
/// threads  any; one mutex. A thread of its own becomes a publisher of the shards that objects may enter next
class [[gnu::visibility("hidden")]] ShardedPublishing {
 public:
  using Object = ShardedPublisher::Object;

  static Result<std::unique_ptr<ShardedPublishing>> start(std::shared_ptr<ShardLinks> links, const std::string& name,
                                                          const PublishOptions& options);
  ~ShardedPublishing();

  Result<Object> add(const ObjectOptions& options);
  Result<void> remove(Object object);
  Result<void> move(Object object, const Pose& pose, bool teleport);
  Result<FlushReport> flush(std::chrono::nanoseconds source_time);
  Result<void> keep_alive(std::chrono::nanoseconds source_time);
  Result<void> wait_applied(std::chrono::nanoseconds timeout);
  Result<PublisherReport> report(std::chrono::nanoseconds timeout);
  std::size_t copies() const;

 private:
  using ShardSet = shards::ShardSet;
  /// A shard that had none of this publisher's objects has to have the first one before others may decide beyond its time.
  static constexpr std::chrono::nanoseconds kEnterWait = std::chrono::milliseconds(250);
  /// This publisher in one shard.
  struct ShardMember {
    std::unique_ptr<Publisher> publisher;  // null: it is not one there
    std::chrono::nanoseconds flushed{0};   // the newest instant that the shard was told
    std::size_t objects = 0;               // that it holds
    bool was_away = false;     // it did not answer since the last flush: what it holds is placed there again, not moved
    Clock::time_point tried;   // when joining it failed last
    Clock::time_point joined;  // when this became a publisher of it
    std::optional<std::chrono::nanoseconds>
        decided;  // when something was found missing: how far it has decided without this
  };
  /// An object in one shard.
  struct Copy {
    Publisher::Object handle = 0;
    std::chrono::nanoseconds left{0};  // the instant since when it has been out of the shard; 0: it is there
  };
  /// An object's shape, and where it is defined.
  struct Copies {
    Shape shape;
    double reach_m = 0;         // about its frame's origin
    ShardSet held = 0;          // by these shards
    std::vector<Copy> in_each;  // of them, in the order of the bits
    bool is_leaving = false;    // its number is in leaving_
  };

  ShardedPublishing(std::shared_ptr<ShardLinks> links, const std::string& name, const PublishOptions& options);
  shards::ShardBox box_around(const Vec3& a, const Vec3& b, double reach_m) const;
  Error unknown(Object object) const;

  void follow_view();
  void give_up(std::size_t shard);
  void join(ShardSet needed, std::unique_lock<std::mutex> & lock);
  void take_part(std::size_t shard, Publisher publisher);
  void catch_up(std::size_t shard);
  void try_missing();
  bool may_fill(std::size_t shard) const;
  std::chrono::nanoseconds decided_by(std::size_t shard) const;
  void find_decided();
  void drop_left();
  void join_ahead();
  void run();

  std::optional<Error> enter(std::uint32_t number, std::size_t shard);
  void leave(std::uint32_t number, std::size_t shard);
  static std::size_t place_of(const Copies& copies, std::size_t shard);
  ShardSet needed() const;
  ShardSet holders_on_way(std::uint32_t number) const;
  ShardSet fill_missing();
  void fill(ShardSet into);
  std::optional<Error> enter_all(ShardSet & entered);
  std::optional<Error> move_copies(std::uint32_t number);
  std::optional<Error> tell(std::size_t shard, std::chrono::nanoseconds instant, bool is_entered);
  void note_left(std::chrono::nanoseconds instant);

  const std::shared_ptr<ShardLinks> links_;
  const std::string name_;
  const PublishOptions options_;
  mutable std::mutex mutex_;
  std::shared_ptr<const ShardView> view_;  // by which objects are told, until follow_view()
  std::vector<ShardMember> members_;       // by place in the view; it never moves
  std::vector<ShardSet> neighbours_;       // likewise: the shards that hold something in common with it
  PublishedObjects objects_;               // their shapes are in copies_
  std::vector<Copies> copies_;             // by object number
  std::vector<std::uint32_t> leaving_;     // numbers of objects with a copy that is out of its shard
  std::chrono::nanoseconds flushed_{0};
  Clock::time_point flushed_at_;
  std::string lost_;            // what a shard reports of a loss since the last flush
  bool has_own_clock_ = false;  // the last flush had no time, so the library's clock counts
  ShardSet missing_ =
      0;  // shards that do not hold all that they should: they were not there, or have not come far enough
  ShardSet new_in_ = 0;  // shards where an object was added since the last flush
  ShardSet wanted_ = 0;  // to be joined
  bool is_over_ = false;
  std::condition_variable news_;    // something is wanted, or it is over
  std::condition_variable joined_;  // a shard was joined, or that failed
  std::thread thread_;
};

}  // namespace collided::client
