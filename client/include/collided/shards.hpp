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

/// One world on several servers, each of which holds what touches its part of space.
#pragma GCC visibility push(default)

namespace collided {

namespace client {
class ShardLinks;
class ShardedPublishing;
class ShardedWatching;
}  // namespace client

/// One shard, as this client sees it.
struct ShardState {
  std::string name = {};
  std::string name_space = {};  // in which it serves
  Vec3 low = Vec3::Zero();      // its box, which is closed; sides may be infinite
  Vec3 high = Vec3::Zero();
  bool is_there = false;      // it answers, and says that it is this shard of this map
  std::string fault = {};     // why it is not there
  std::string state = {};     // as in ServerStatus
  std::uint32_t objects = 0;  // that it holds; those near a border are held by several
  std::uint64_t static_triangles = 0;
};

/// A publisher of a world on several shards: what it says of an object goes to the shards that the object touches, with
/// the margin of the map, and no others. It is a publisher of each shard where it has, or may soon have, an object.
///
/// An object that enters a shard's margin is defined there where it was at the last flush, and moves from there; it is
/// removed from a shard some time after it has left. A shard that does not answer is told nothing, and everything that it
/// should hold once it answers again.
///
/// errors   as Publisher; bad_input for a half-space that moves
/// threads  calls from any thread
class ShardedPublisher {
 public:
  ~ShardedPublisher();
  ShardedPublisher(ShardedPublisher&&) noexcept;
  ShardedPublisher& operator=(ShardedPublisher&&) noexcept;

  using Object = std::uint32_t;
  /// Defines an object; its name must be free in this publisher. It is in the world from the last flush on, which shows with
  /// the next one.
  Result<Object> add(const ObjectOptions& options);
  Result<void> remove(Object object);
  /// As Publisher::move.
  Result<void> move(Object object, const Pose& pose, bool teleport = false);
  /// As Publisher::flush, on every shard. Contacts are decided up to the last flush.
  ///
  /// source_time  when the objects were there, since 1970; 0: now. The same for all shards
  Result<FlushReport> flush(std::chrono::nanoseconds source_time = {});
  /// As Publisher::keep_alive, on every shard.
  Result<void> keep_alive(std::chrono::nanoseconds source_time = {});
  /// Waits until every shard that is there has applied what it was sent.
  Result<void> wait_applied(std::chrono::nanoseconds timeout);
  /// As Publisher::report, of all shards that are there together. An object that several shards lack counts in each.
  Result<PublisherReport> report(std::chrono::nanoseconds timeout);
  /// How many shards hold an object of this publisher now, summed over its objects; for figures of borders.
  std::size_t copies() const;

 private:
  friend class ShardedClient;
  explicit ShardedPublisher(std::unique_ptr<client::ShardedPublishing> state);
  std::unique_ptr<client::ShardedPublishing> state_;
};

/// The contact events of a world on several shards, as one server would tell them: each episode of a pair once, whichever
/// shards it passes through, in the order of their time. An event is told when every shard has decided up to its time.
///
/// Event::epoch, sequence, episode, a_id and b_id are this watch's own: 0 for the epoch, and numbers that count from 1.
///
/// threads  calls from any thread
class ShardedWatch : public Subscription<Event> {
 public:
  /// World time up to which all events have been told.
  std::chrono::nanoseconds settled() const;
  /// How often something of a shard may be missing: it was not there for a while, its server was started again, or what it
  /// told was lost. That a standby took its server's place is none where all that it told was heard.
  std::uint64_t gaps() const { return resyncs(); }
  /// Number of contacts that hold now according to the events reported.
  std::size_t open_contacts() const;

 private:
  friend class ShardedClient;
  explicit ShardedWatch(std::unique_ptr<client::ShardedWatching> state);
  client::ShardedWatching& state() const;
};

/// How two objects of a world on several shards stand to each other.
struct ShardedPairAnswer : PairAnswer {
  /// Undecided with not_covered: no shard holds both, so they are farther apart than this. 0: one that may hold both does not
  /// answer.
  double farther_than_m = 0;
};

/// The nearest pairs of two groups in a world on several shards.
struct ShardedClearanceAnswer : ClearanceAnswer {
  /// Pairs that are farther apart than this are not told, since no shard may hold them.
  double complete_to_m = std::numeric_limits<double>::infinity();
};

/// A client of a world on several servers. Which shards there are and which space each one serves is in the shard map that
/// the servers were started with, too (collided --shard MAP:NAME): a file, or a key of etcd by its address,
/// etcd://HOST:PORT[,HOST:PORT...]/KEY.
///
/// A question goes to the shards that it touches; their answers become one, as a single server that held everything would
/// give it. What a shard that does not answer could change is undecided with not_covered, never a miss.
///
/// threads  several threads may call at once
class ShardedClient {
 public:
  /// Looks for all the shards at once. A shard that is not there is looked for again, once a second.
  ///
  /// map      the shard map: a file, or an address. Read once: what becomes of the shards their servers say
  /// options  as for one server; the shards serve in name_space + "/shard_" + their name
  /// errors   bad_input for a map that cannot be used; no_server where no shard, or no etcd, answers within options.wait
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
  /// Asks 1 to 100,000 questions of one kind. With Instant::settled all are about one instant that every shard has
  /// decided; with latest each shard answers by its newest poses.
  ///
  /// Of Answers: epoch, version and server are 0; world_time is the earliest of the shards', and equal for all but `latest`.
  /// Hits at equal distances come by the objects' names, whose ids are 0 here.
  template <std::ranges::contiguous_range Questions>
  requires Question<std::ranges::range_value_t<Questions>> Result<Answers> ask(const Questions& questions,
                                                                               const AskOptions& options = {}) {
    return ask_all(std::span<const std::ranges::range_value_t<Questions>>(questions), options);
  }

  /// As Client::pair, of a shard that holds both; two that no shard holds are undecided with not_covered, and
  /// farther_than_m says how far they are apart at least. With Instant::settled every shard has decided that instant. The version is 0.
  Result<ShardedPairAnswer> pair(const std::string& a, const std::string& b, const PairOptions& options = {});
  /// As Client::clearance, of pairs that are no farther apart than the margin of the map: where fewer than asked for are so
  /// near, and farther ones were asked for, it is undecided with not_covered, and complete_to_m says up to where. The numbers of
  /// objects and the version are 0.
  ///
  /// options  `to` must be named; `progress` is not called
  Result<ShardedClearanceAnswer> clearance(const std::string& from, const ClearanceOptions& options);

  Result<ShardedPublisher> publish(const std::string& publisher_name, const PublishOptions& options = {});
  /// Subscribes to contact events; WatchOptions::since and persisted are bad_input.
  Result<ShardedWatch> watch(const WatchOptions& options = {});

  /// The shards in the map's order, and who of them is there.
  std::vector<ShardState> shards();

 private:
  template <Question Q>
  Result<Answers> ask_all(std::span<const Q> questions, const AskOptions& options);

  explicit ShardedClient(std::shared_ptr<client::ShardLinks> links);
  std::shared_ptr<client::ShardLinks> links_;
};

/// How a shard is split.
struct ShardSplitOptions {
  /// So long the new shards may take to hold all that the old one holds; then it is taken back.
  std::chrono::nanoseconds patience = std::chrono::seconds(60);
  bool undo = false;                                  // takes back what was begun and does not hold yet
  std::function<void(const std::string&)> said = {};  // gets a sentence with each step
};

/// A split that was carried out.
struct ShardSplitReport {
  std::string shard;              // that was split
  std::vector<std::string> into;  // in its place
  std::uint64_t objects = 0;      // that it held, when the new ones held them all
  std::size_t watches = 0;        // that watched it then
  std::chrono::nanoseconds took{0};
};

/// Splits a shard while its world runs: no event is lost or told twice, and no question fails or misses anything. The next
/// map differs from the map before in that one shard is replaced by others that fill its box; their servers run already.
///
/// Every ShardedClient takes part by itself: publishers tell the new shards too, and watches watch them. Once these hold
/// everything, questions go to them; then publishers and watches leave the old one, which covers nothing from then on and
/// may be stopped. One that is called again after it was cut short goes on where that ended.
///
/// A map in etcd has the next one in its place before the servers are told that that holds; it is kept under KEY/before. Where
/// somebody has put another one there since it was read, the split is taken back: refused.
///
/// map      that holds: a file, or the address of one in etcd
/// next     the same of the one after it; empty: what is under KEY/next in etcd
/// options  as for ShardedClient::connect
/// errors   bad_input for maps that do not differ by one split; no_server where a shard of either map, or etcd, is not there; refused
///          by a server with another map; timeout where the new shards do not come to hold everything. With all of these the
///          map before holds, as long as the next one did not
/// cost     some six seconds, and lists of all objects of the shard
Result<ShardSplitReport> split_shard(const std::string& map, const std::string& next, const ConnectOptions& options,
                                     const ShardSplitOptions& how = {});

}  // namespace collided

#pragma GCC visibility pop
