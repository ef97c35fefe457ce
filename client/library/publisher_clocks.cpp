#include "client/library/publisher_clocks.hpp"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "client/library/errors.hpp"

namespace collided::client {
namespace {

using std::chrono::nanoseconds;

/// Ways of batches on one machine differ by less, unless it is overloaded.
constexpr std::int64_t kNoticedNs = 5'000'000;
/// The first may have waited for us, and one alone may have been late.
constexpr std::uint32_t kFewest = 3;

std::string milliseconds_text(std::int64_t ns) {
  const std::int64_t tenths = (ns + 50'000) / 100'000;
  return std::to_string(tenths / 10) + '.' + std::to_string(tenths % 10) + " ms";
}

}  // namespace

PublisherClocks::PublisherClocks(const Connection& connection)
    : topic_(connection.participant(), connection.options().name_space),
      reader_(topic_, {.data = [this](dds::Taker<wire::PoseBatch> taker) { hear(taker); }}) {}

void PublisherClocks::hear(dds::Taker<wire::PoseBatch> taker) {
  const std::int64_t now_ns = nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
  const std::lock_guard lock(mutex_);
  dds::Sample<wire::PoseBatch> batch;
  while (taker.take(batch)) {
    if (!batch.info().valid_data) continue;
    Clock& clock = clocks_[batch->publisher];
    if (++clock.heard > 1) clock.behind_ns = std::min(clock.behind_ns, now_ns - batch.info().source_timestamp);
  }
}

std::optional<Finding> PublisherClocks::finding(const std::map<std::uint64_t, std::string>& names) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::pair<std::uint64_t, std::int64_t>> heard;
  for (const auto& [publisher, clock] : clocks_) {
    if (clock.heard >= kFewest) heard.emplace_back(publisher, clock.behind_ns);
  }
  if (heard.size() < 2) return std::nullopt;
  const auto by_clock = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto [ahead, behind] = std::minmax_element(heard.begin(), heard.end(), by_clock);
  const std::int64_t apart_ns = behind->second - ahead->second;
  if (apart_ns < kNoticedNs) {
    return Finding{Health::ok, "publisher_clocks", "the clocks of " + std::to_string(heard.size()) + " publishers agree within " + milliseconds_text(apart_ns), ""};
  }
  const auto name_of = [&](std::uint64_t publisher) {
    const auto found = names.find(publisher);
    return found == names.end() ? std::string("a publisher") : "'" + found->second + "'";
  };
  return Finding{Health::warn, "publisher_clocks",
                 "the clock of " + name_of(ahead->first) + " is " + milliseconds_text(apart_ns) + " ahead of that of " + name_of(behind->first) +
                     "; when their objects met is off by that",
                 "let both machines follow one time server (PTP, chrony), or start collided with --clock-error " + std::to_string(apart_ns / 1'000'000 + 1) + "ms"};
}

}  // namespace collided::client
