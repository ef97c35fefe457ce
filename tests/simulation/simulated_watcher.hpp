#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>

#include "client/library/connection/names.hpp"
#include "client/library/watching/watch_state.hpp"

namespace collided::simulation {

using NamedPair = std::pair<std::string, std::string>;

/// What happens to messages on the way to one watcher.
struct Line {
  double loss = 0;
  double repeats = 0;
  std::int64_t longest_delay_ns = 0;
  double partitions = 0;  // a message begins one
  std::int64_t longest_partition_ns = 0;
  std::int64_t joins_ns = 0;
};

/// A watch behind a line, held against the contract: began and ended alternate for each pair, sequences and epochs
/// never go back, and what it holds at the end is the truth.
class SimulatedWatcher {
 public:
  using Violation = std::function<void(const std::string&)>;
  using Heard = std::variant<client::HeardFrame, client::HeardShard, client::HeardBookmark>;
  /// has_watermarks  no event may be older than a watermark that came before it
  SimulatedWatcher(std::string name, const Line& line, std::uint64_t seed, bool has_watermarks, Violation violation);

  void send(const Heard& message, std::int64_t now_ns);
  /// The line is good from now on.
  void calm(std::int64_t now_ns);
  void compare(const std::set<NamedPair>& truth);

  /// Sequences of what came as it happened, of the newest epoch.
  const std::vector<std::uint64_t>& told() const { return reported_; }
  std::uint64_t resyncs() const { return state_.resyncs(); }
  /// All that was told, in order.
  const std::vector<Event>& events() const { return events_; }

 private:
  bool chance(double probability) { return std::uniform_real_distribution<double>()(random_) < probability; }
  std::int64_t up_to(std::int64_t most_ns) {
    return static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(most_ns + 1));
  }
  void hear(const Heard& message, std::int64_t now_ns);
  void hear_due(std::int64_t now_ns);
  void emit(const Event& event);

  std::string name_;
  bool has_watermarks_;
  Line line_;
  std::mt19937_64 random_;
  Violation violation_;
  std::int64_t cut_off_until_ns_ = 0;
  std::multimap<std::int64_t, Heard> delayed_;
  // By server and number: those that DDS brings in the end, lost or not.
  std::map<std::pair<std::uint64_t, std::uint8_t>, client::HeardShard> newest_shards_;
  std::set<NamedPair> open_;
  std::uint64_t last_epoch_ = 0;
  std::uint64_t last_sequence_ = 0;
  std::vector<std::uint64_t> reported_;
  std::vector<Event> events_;
  client::WatchState state_;
};

}  // namespace collided::simulation
