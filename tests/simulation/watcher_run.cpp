// The watchers' side of the simulation: reads a record from its standard input, each watcher behind a line of its own,
// and prints what the whole run amounted to. Exit status 1 where the contract was broken.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "client/library/watching/watch_decoding.hpp"
#include "tests/service/wire/rows.hpp"
#include "tests/simulation/record.hpp"
#include "tests/simulation/simulated_watcher.hpp"

namespace collided::simulation {
namespace {

client::ServerLife life_of(std::uint64_t epoch) { return {epoch, epoch}; }

template <class Columns>
Columns columns_of(Message& message) {
  Columns columns;
  Columns::for_each([&]<class Value>(auto, std::vector<Value> Columns::*column, std::uint32_t) {
    columns.*column = message.get_all<Value>();
  });
  return columns;
}

/// Decoded as off the wire: the same checks and the same book of names.
client::HeardFrame frame_of(Message& message, client::Names& names) {
  dds::Sample<wire::EventFrame> frame;
  frame->epoch = message.get<std::uint64_t>();
  frame->server = life_of(frame->epoch).server;
  frame->world_time_ns = message.get<std::int64_t>();
  const bool is_again = message.get<std::uint8_t>() != 0;
  frame->version = is_again ? 0 : 1;
  frame->settled_ns = message.get<std::int64_t>();
  frame->first_sequence = message.get<std::uint64_t>();
  const auto columns = columns_of<wire::EventFrameColumns>(message);
  wire::lend(columns, *frame);
  return client::decode(*frame, names).value();
}

client::HeardShard shard_of(Message& message, client::Names& names) {
  dds::Sample<wire::ContactShard> shard;
  shard->epoch = message.get<std::uint64_t>();
  shard->server = life_of(shard->epoch).server;
  shard->as_of_sequence = message.get<std::uint64_t>();
  shard->shard = message.get<std::uint8_t>();
  const auto columns = columns_of<wire::ContactShardColumns>(message);
  wire::lend(columns, *shard);
  return client::decode(*shard, names).value();
}

client::HeardBookmark bookmark_of(Message& message) {
  dds::Sample<wire::Status> status;
  status->epoch = message.get<std::uint64_t>();
  status->server = life_of(status->epoch).server;
  status->last_event_sequence = message.get<std::uint64_t>();
  status->contact_count = message.get<std::uint32_t>();
  status->contact_hash = message.get<std::uint64_t>();
  status->state = message.get<std::uint8_t>();
  status->settled_ns = message.get<std::int64_t>();
  status->world_time_ns = message.time_ns();
  return client::decode(*status);
}

std::set<NamedPair> truth_of(Message& message) {
  const auto bytes = message.get_all<std::uint8_t>();
  std::vector<std::string> names;
  for (std::size_t start = 0; start < bytes.size(); start += names.back().size() + 1) {
    names.emplace_back(reinterpret_cast<const char*>(&bytes[start]));
  }
  std::set<NamedPair> pairs;
  for (std::size_t i = 0; i + 1 < names.size(); i += 2) pairs.insert({names[i], names[i + 1]});
  return pairs;
}

struct Totals {
  std::uint64_t violations = 0;
  std::uint64_t resyncs = 0;
  std::uint64_t events = 0;
};

/// One seed's watchers.
class Run {
 public:
  Run(std::uint64_t seed, bool is_fleet, std::int64_t started_ns, Totals& totals)
      : seed_(seed), is_fleet_(is_fleet), totals_(totals) {
    constexpr std::int64_t kMs = 1'000'000;
    const auto violation = [this](const std::string& what) {
      ++totals_.violations;
      std::fprintf(stderr, "violation: seed=%llu: %s\n", static_cast<unsigned long long>(seed_), what.c_str());
    };
    const auto add = [&](const char* name, const Line& line) {
      watchers_.push_back(
          std::make_unique<SimulatedWatcher>(name, line, seed * 8 + watchers_.size(), is_fleet_, violation));
    };
    const auto late_ns = static_cast<std::int64_t>(seed % 1'500) * kMs;
    add("good line", {});
    add("lossy line", {.loss = 0.1, .repeats = 0.05, .longest_delay_ns = 60 * kMs});
    add("partitions",
        {.loss = 0.01, .longest_delay_ns = 20 * kMs, .partitions = 0.01, .longest_partition_ns = 900 * kMs});
    add("late joiner", {.loss = 0.02, .joins_ns = started_ns + late_ns});
  }

  void take(Message& message) {
    switch (message.kind()) {
      case Kind::frame: {
        const client::HeardFrame frame = frame_of(message, names_);
        last_sequence_ = frame.first_sequence + frame.entries.size() - 1;
        totals_.events += frame.entries.size();
        return send(frame, message.time_ns());
      }
      case Kind::expected:
        for (const client::HeardFrame::Entry& entry : frame_of(message, expected_names_).entries)
          expected_[pair_of(entry.event)].push_back(entry.event);
        return;
      case Kind::shard: return send(shard_of(message, names_), message.time_ns());
      case Kind::bookmark: return send(bookmark_of(message), message.time_ns());
      case Kind::calm:
        for (auto& watcher : watchers_) watcher->calm(message.time_ns());
        return;
      default: finish(truth_of(message));
    }
  }

 private:
  void send(const SimulatedWatcher::Heard& heard, std::int64_t now_ns) {
    epoch_ = std::visit([](const auto& message) { return message.from.epoch; }, heard);
    for (auto& watcher : watchers_) watcher->send(heard, now_ns);
  }

  void finish(const std::set<NamedPair>& truth) {
    for (auto& watcher : watchers_) {
      watcher->compare(truth);
      totals_.resyncs += watcher->resyncs();
    }
    if (is_fleet_) return compare_with_expected();
    // Nothing was lost and the server never fell: each event came once, as it happened.
    const std::vector<std::uint64_t>& told = watchers_.front()->told();
    bool is_each_once = epoch_ != 1 || (told.size() == last_sequence_ && watchers_.front()->resyncs() == 0);
    for (std::size_t i = 0; i < told.size() && epoch_ == 1; ++i) is_each_once = is_each_once && told[i] == i + 1;
    if (is_each_once) return;
    ++totals_.violations;
    std::fprintf(stderr, "violation: seed=%llu: a good line told %zu events of %llu\n",
                 static_cast<unsigned long long>(seed_), told.size(), static_cast<unsigned long long>(last_sequence_));
  }

  static NamedPair pair_of(const Event& event) { return std::minmax(event.a, event.b); }

  /// On a good line each event that the server which never failed found is told once, as it happened, whoever spoke.
  void compare_with_expected() {
    std::map<NamedPair, std::vector<Event>> told;
    for (const Event& event : watchers_.front()->events()) told[pair_of(event)].push_back(event);
    for (auto& [pair, events] : told) expected_[pair];  // so that what was invented is compared too
    for (const auto& [pair, events] : expected_) {
      const std::string difference = first_difference(events, told[pair]);
      if (difference.empty()) continue;
      ++totals_.violations;
      std::fprintf(stderr, "violation: fleet seed=%llu: %s x %s: %s\n", static_cast<unsigned long long>(seed_),
                   pair.first.c_str(), pair.second.c_str(), difference.c_str());
    }
  }

  static std::string first_difference(const std::vector<Event>& expected, const std::vector<Event>& told) {
    const auto words = [](const std::vector<Event>& events, std::size_t i) {
      if (i >= events.size()) return std::string("nothing");
      const Event& one = events[i];
      return std::string(one.kind == EventKind::began   ? "began"
                         : one.kind == EventKind::ended ? "ended"
                                                        : "changed") +
             " at " + std::to_string(happened(one).count()) + " ns" + (one.resync ? ", as a difference" : "") +
             " (epoch " + std::to_string(one.epoch) + ')';
    };
    for (std::size_t i = 0; i < std::max(expected.size(), told.size()); ++i) {
      constexpr std::chrono::nanoseconds kRounded{4};
      const bool is_same = i < expected.size() && i < told.size() && expected[i].kind == told[i].kind &&
                           !told[i].resync && std::chrono::abs(happened(expected[i]) - happened(told[i])) <= kRounded;
      if (!is_same)
        return "event " + std::to_string(i) + ": expected " + words(expected, i) + ", told " + words(told, i);
    }
    return {};
  }

  std::uint64_t seed_;
  bool is_fleet_;
  Totals& totals_;
  client::Names names_;
  client::Names expected_names_;
  std::map<NamedPair, std::vector<Event>> expected_;
  std::vector<std::unique_ptr<SimulatedWatcher>> watchers_;
  std::uint64_t epoch_ = 0;
  std::uint64_t last_sequence_ = 0;
};

}  // namespace
}  // namespace collided::simulation

int main() {
  using namespace collided::simulation;
  Totals totals;
  std::unique_ptr<Run> run;
  Message message;
  while (message.receive(stdin)) {
    if (message.kind() == Kind::run) {
      const auto seed = message.get<std::uint64_t>();
      const bool is_fleet = message.get<std::uint8_t>() != 0;
      run = std::make_unique<Run>(seed, is_fleet, message.time_ns(), totals);
    } else if (message.kind() == Kind::end) {
      const auto seeds = message.get<std::uint64_t>();
      const auto steps = message.get<std::uint64_t>();
      const std::uint64_t violations = totals.violations + message.get<std::uint64_t>();
      std::printf("seeds=%llu steps=%llu events=%llu resyncs=%llu takeovers=%llu violations=%llu\n",
                  static_cast<unsigned long long>(seeds), static_cast<unsigned long long>(steps),
                  static_cast<unsigned long long>(totals.events), static_cast<unsigned long long>(totals.resyncs),
                  static_cast<unsigned long long>(message.get<std::uint64_t>()),
                  static_cast<unsigned long long>(violations));
      return violations == 0 ? 0 : 1;
    } else {
      run->take(message);
    }
    if (message.is_short()) break;
  }
  std::fprintf(stderr, "the record ended early\n");
  return 2;
}
