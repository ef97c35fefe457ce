#include "server/service/source_clock.hpp"

#include <algorithm>

namespace collided::service {

std::int64_t SourceClock::server_time_ns(std::int64_t source_ns, std::int64_t received_ns) {
  // Beyond this no difference of two overflows; 1970 plus or minus 146 years.
  constexpr std::int64_t kMostSourceNs = std::int64_t{1} << 62;
  if (source_ns <= 0 || source_ns > kMostSourceNs) return received_ns;
  const std::int64_t way_ns = received_ns - source_ns;
  // Quartz clocks differ by up to 100 ppm: the shortest way of the past must not bind a slower clock for ever.
  const std::int64_t drift_ns = std::max<std::int64_t>(0, received_ns - received_ns_) / 10'000;
  const bool jumped = way_ns - shortest_way_ns_ > kMostJitterNs;
  shortest_way_ns_ = !started_ || jumped ? way_ns : std::min(way_ns, shortest_way_ns_ + drift_ns);
  started_ = true;
  received_ns_ = received_ns;
  return source_ns + shortest_way_ns_;
}

}  // namespace collided::service
