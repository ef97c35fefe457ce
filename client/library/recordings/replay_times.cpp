#include "client/library/recordings/replay_times.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "idl/topics.hpp"

namespace collided::client {
namespace {

using wire_contract::kPublisherLeaseNs;

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
/// Below this, sums and differences of times do not overflow.
constexpr std::int64_t kMostTimeNs = std::int64_t{1} << 61;

std::int64_t log_time(const RecordedItem& item) {
  return static_cast<std::int64_t>(std::min(item.log_time, static_cast<std::uint64_t>(kMostTimeNs)));
}

/// The stamps of one publisher's life compared with their recording times.
struct Dating {
  std::int64_t least_ns = kNever;  // from stamp to recording
  // The current run of batches that were recorded late.
  std::int64_t late_since_ns = kNever;
  std::int64_t most_late_ns = 0;
  bool is_undated = false;

  /// A recorder catches up in less time than its delay; stamps of a wrong clock stay late.
  void note_lateness(std::int64_t logged_ns, std::int64_t stamp_ns) {
    const std::int64_t late_ns = logged_ns - stamp_ns - least_ns;
    if (late_ns < kPublisherLeaseNs) {
      late_since_ns = kNever;
      most_late_ns = 0;
      return;
    }
    late_since_ns = std::min(late_since_ns, logged_ns);
    most_late_ns = std::max(most_late_ns, late_ns);
    is_undated = is_undated || logged_ns - late_since_ns > most_late_ns;
  }
  ReplayTime time_of(std::int64_t logged_ns, std::int64_t stamp_ns) const {
    const std::int64_t off_ns = logged_ns - stamp_ns;
    const bool is_near = off_ns < kPublisherLeaseNs && off_ns > -kPublisherLeaseNs;
    if (is_undated) return {.due_ns = logged_ns, .source_ns = is_near ? stamp_ns : logged_ns};
    const bool is_same_clock = least_ns < kPublisherLeaseNs && least_ns > -kPublisherLeaseNs;
    return {.due_ns = stamp_ns + least_ns, .source_ns = is_same_clock ? stamp_ns : stamp_ns + least_ns};
  }
};

using Life = std::pair<std::uint64_t, std::uint64_t>;  // publisher, incarnation

}  // namespace

ReplayTimes replay_times(const RecordedRun& run) {
  std::map<Life, Dating> datings;
  const auto for_each_stamped = [&](const auto& visit) {
    for (std::size_t i = 0; i < run.items.size(); ++i) {
      const RecordedOrigin& origin = run.origins[i];
      const std::int64_t logged_ns = log_time(run.items[i]);
      const bool is_stamped = origin.stamp_ns > 0 && origin.stamp_ns < kMostTimeNs;
      if (run.items[i].opening || !is_stamped) continue;
      visit(i, datings[{origin.publisher, origin.incarnation}], logged_ns, origin.stamp_ns);
    }
  };
  for_each_stamped([](std::size_t, Dating& dating, std::int64_t logged_ns, std::int64_t stamp_ns) {
    dating.least_ns = std::min(dating.least_ns, logged_ns - stamp_ns);
  });
  for_each_stamped([](std::size_t, Dating& dating, std::int64_t logged_ns, std::int64_t stamp_ns) {
    dating.note_lateness(logged_ns, stamp_ns);
  });
  ReplayTimes times;
  times.undated_publishers = static_cast<std::size_t>(
      std::ranges::count_if(datings, [](const auto& entry) { return entry.second.is_undated; }));
  for (const RecordedItem& item : run.items) times.of.push_back({log_time(item), log_time(item)});
  for_each_stamped([&](std::size_t i, const Dating& dating, std::int64_t logged_ns, std::int64_t stamp_ns) {
    times.of[i] = dating.time_of(logged_ns, stamp_ns);
  });
  // A publisher's samples keep their order: a sample is due no later than the samples recorded after it.
  std::map<std::uint64_t, std::int64_t> next_due;
  for (std::size_t i = run.items.size(); i-- > 0;) {
    if (run.origins[i].publisher == 0 || run.items[i].opening) continue;
    std::int64_t& next_ns = next_due.try_emplace(run.origins[i].publisher, kNever).first->second;
    next_ns = times.of[i].due_ns = std::min(times.of[i].due_ns, next_ns);
  }
  times.order.resize(run.items.size());
  std::iota(times.order.begin(), times.order.end(), std::size_t{0});
  std::ranges::stable_sort(times.order, [&](std::size_t a, std::size_t b) {
    const auto place = [&](std::size_t i) { return std::pair(!run.items[i].opening, times.of[i].due_ns); };
    return place(a) < place(b);
  });
  return times;
}

}  // namespace collided::client
