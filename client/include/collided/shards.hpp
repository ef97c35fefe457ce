#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <ranges>
#include <span>
#include <string>
#include <vector>

#include <collided/client.hpp>

/// One world on several servers (shards), each of which holds the objects that touch its part of space.
#pragma GCC visibility push(default)

namespace collided {

namespace client {
class ShardLinks;
class ShardedPublishing;
class ShardedWatching;
}  // namespace client

/// The state of one shard, as this client sees it.
struct ShardState {
  std::string name = {};
  std::string name_space = {};  // the namespace it serves
  Vec3 low = Vec3::Zero();      // its box, which is closed; sides may be infinite
  Vec3 high = Vec3::Zero();
  bool is_there = false;      // it answers, and confirms that it is this shard of this map
  std::string fault = {};     // why it is not available
  std::string state = {};     // as in ServerStatus
  std::uint32_t objects = 0;  // that it holds; several shards hold those near a border
  std::uint64_t static_triangles = 0;
};

/// A publisher of a world on several shards. Data of an object goes only to the shards that the object touches,
/// enlarged by the map's margin. It registers as a publisher with each shard where it has, or may soon have, an object.
///
/// An object that enters a shard's margin is defined there at its pose of the last flush, and moves from there. It is
/// removed from a shard some time after it has left. A shard that does not answer receives nothing; when it answers
/// again, it receives everything that it should hold.
///
/// errors   as for Publisher; also bad_input for a moving half-space
/// threads  calls from any thread
class ShardedPublisher {
 public:
  ~ShardedPublisher();
  ShardedPublisher(ShardedPublisher&&) noexcept;
  ShardedPublisher& operator=(ShardedPublisher&&) noexcept;

  using Object = std::uint32_t;
  /// Defines an object; its name must be free in this publisher. It is in the world from the time of the last flush on;
  /// the next flush sends it.
  Result<Object> add(const ObjectOptions& options);
  Result<void> remove(Object object);
  /// As Publisher::move.
  Result<void> move(Object object, const Pose& pose, bool teleport = false);
  /// As Publisher::flush, on every shard. Contacts are decided up to the last flush.
  ///
  /// source_time  time of the poses, since 1970; 0: now. The same for all shards
  Result<FlushReport> flush(std::chrono::nanoseconds source_time = {});
  /// As Publisher::keep_alive, on every shard.
  Result<void> keep_alive(std::chrono::nanoseconds source_time = {});
  /// Waits until every available shard has applied all that was sent to it.
  Result<void> wait_applied(std::chrono::nanoseconds timeout);
  /// As Publisher::report, summed over all available shards. An object that several shards lack counts for each.
  Result<PublisherReport> report(std::chrono::nanoseconds timeout);
  /// Number of copies: the number of shards that now hold an object, summed over this publisher's objects. For
  /// statistics about borders.
  std::size_t copies() const;

 private:
  friend class ShardedClient;
  explicit ShardedPublisher(std::unique_ptr<client::ShardedPublishing> state);
  std::unique_ptr<client::ShardedPublishing> state_;
};

/// The contact events of a world on several shards, as one server would report them: each episode of a pair once,
/// whichever shards it passes through, in order of time. An event is reported when every shard has decided up to its
/// time.
///
/// Event::epoch, sequence, episode, a_id and b_id are assigned by this watch: the epoch is 0, the others count from 1.
///
/// threads  calls from any thread
class ShardedWatch : public Subscription<Event> {
 public:
  /// World time up to which all events have been reported.
  std::chrono::nanoseconds settled() const;
  /// Number of possible gaps in the events of shards: a shard was unavailable for a while, its server was restarted, or
  /// its messages were lost. A failover to a standby is not a gap if all its messages were received.
  std::uint64_t gaps() const { return resyncs(); }
  /// Number of contacts now open, according to the events reported.
  std::size_t open_contacts() const;

 private:
  friend class ShardedClient;
  explicit ShardedWatch(std::unique_ptr<client::ShardedWatching> state);
  client::ShardedWatching& state() const;
};

/// The answer about two objects of a world on several shards.
struct ShardedPairAnswer : PairAnswer {
  /// With undecided and not_covered: no shard holds both, so they are farther apart than this. 0: a shard that may hold
  /// both does not answer.
  double farther_than_m = 0;
};

/// The nearest pairs of two groups in a world on several shards.
struct ShardedClearanceAnswer : ClearanceAnswer {
  /// Pairs that are farther apart than this are not reported, since possibly no shard holds both.
  double complete_to_m = std::numeric_limits<double>::infinity();
};

/// A client of a world on several servers. The shard map lists the shards and the space that each one serves; the
/// servers are started with the same map (collided --shard MAP:NAME). It is a file, or a key in etcd:
/// etcd://HOST:PORT[,HOST:PORT...]/KEY, or etcds:// with TLS and ConnectOptions::etcd_keys.
///
/// A question goes to the shards that it touches. Their answers are merged into the one that a single server with the
/// whole world would give. An answer that a silent shard could change is undecided with not_covered, never a miss.
///
/// threads  several threads may call at once
class ShardedClient {
 public:
  /// Connects to all shards in parallel. It retries a missing shard once a second.
  ///
  /// map      the shard map: a file, or an address. It is read once; later changes come from the servers
  /// options  as for one server; a shard serves the namespace name_space + "/shard_" + its name
  /// errors   bad_input for an invalid map; no_server if no shard, or no etcd, answers within options.wait
  static Result<ShardedClient> connect(const std::string& map, const ConnectOptions& options);
  ~ShardedClient();
  ShardedClient(ShardedClient&&) noexcept;
  ShardedClient& operator=(ShardedClient&&) noexcept;

  /// Asks one question.
  template <Question Q>
  Result<Answer> ask(const Q& question, const AskOptions& options = {}) {
    Result<Answers> answers = ask_all(std::span<const Q>(&question, 1), options);
    if (!answers) return answers.error();
    return std::move(answers->answers.front());
  }
  /// Asks 1 to 100,000 questions of one kind. With Instant::settled all answers are about one instant that every shard
  /// has decided; with `latest` each shard uses its newest poses.
  ///
  /// In Answers, epoch, version and server are 0; world_time is the earliest of the shards' times, which differ only
  /// for `latest`. Hits at equal distances are ordered by object name; object ids are 0.
  template <std::ranges::contiguous_range Questions>
  requires Question<std::ranges::range_value_t<Questions>> Result<Answers> ask(const Questions& questions,
                                                                               const AskOptions& options = {}) {
    return ask_all(std::span<const std::ranges::range_value_t<Questions>>(questions), options);
  }

  /// As Client::pair, answered by a shard that holds both objects. If no shard holds both, the answer is undecided with
  /// not_covered, and farther_than_m is a lower bound on their distance. With Instant::settled every shard has decided
  /// that instant. The version is 0.
  Result<ShardedPairAnswer> pair(const std::string& a, const std::string& b, const PairOptions& options = {});
  /// As Client::clearance, for pairs no farther apart than the map's margin. If there are fewer such pairs than
  /// requested, and farther ones were requested, it is undecided with not_covered, and complete_to_m is the distance up
  /// to which it is complete. The numbers of objects and the version are 0.
  ///
  /// options  `to` is required; `progress` is not called
  Result<ShardedClearanceAnswer> clearance(const std::string& from, const ClearanceOptions& options);

  /// As Client::publish; see ShardedPublisher.
  Result<ShardedPublisher> publish(const std::string& publisher_name, const PublishOptions& options = {});
  /// Subscribes to contact events; WatchOptions::since and persisted are bad_input.
  Result<ShardedWatch> watch(const WatchOptions& options = {});

  /// The shards in the map's order, with their availability.
  std::vector<ShardState> shards();

 private:
  template <Question Q>
  Result<Answers> ask_all(std::span<const Q> questions, const AskOptions& options);

  explicit ShardedClient(std::shared_ptr<client::ShardLinks> links);
  std::shared_ptr<client::ShardLinks> links_;
};

/// Options of split_shard().
struct ShardSplitOptions {
  /// The time in which the new shards must come to hold all that the old one holds. After it the split is rolled back.
  std::chrono::nanoseconds patience = std::chrono::seconds(60);
  bool undo = false;                                  // rolls back a split that has begun but is not in force yet
  std::function<void(const std::string&)> said = {};  // receives a sentence for each step
};

/// A completed split.
struct ShardSplitReport {
  std::string shard;              // the shard that was split
  std::vector<std::string> into;  // its successors
  std::uint64_t objects = 0;      // number of its objects when the new shards held them all
  std::size_t watches = 0;        // number of its watches at that time
  std::chrono::nanoseconds took{0};
};

/// Splits a shard while its world runs: no event is lost or reported twice, and no question fails or misses anything.
/// The next map differs from the current one in that several shards, which fill its box, replace one shard. Their
/// servers must be running.
///
/// Every ShardedClient follows automatically: its publishers also send to the new shards, and its watches also watch
/// them. Once these hold everything, questions go to them. Then publishers and watches leave the old shard, which
/// covers nothing from then on and may be stopped. To resume an interrupted split, call it again.
///
/// In etcd, the next map replaces the current one before the servers are notified that it is in force; the old one is
/// kept under KEY/before. If the map in etcd was changed after it was read, the split is rolled back with error
/// refused.
///
/// map      the current map: a file, or the address of one in etcd
/// next     the next map, likewise a file or an address; empty: KEY/next in etcd
/// options  as for ShardedClient::connect
/// errors   bad_input for maps that do not differ by one split; no_server if a shard of either map, or etcd, is not
///          available; refused by a server with another map; timeout if the new shards do not get everything. After any
///          of these the current map stays in force, unless the next one already was
/// cost     about six seconds, and lists of all objects of the shard
Result<ShardSplitReport> split_shard(const std::string& map, const std::string& next, const ConnectOptions& options,
                                     const ShardSplitOptions& how = {});

}  // namespace collided

#pragma GCC visibility pop
