#pragma once

#include <cstdint>

namespace collided::service {

/// When one publisher's poses were true, on the server's clock. Reception alone carries the jitter of the way, which
/// would smear the time between two poses and with it the bracket of a contact; the publisher's own clock alone may be
/// anything. So: source time plus the shortest way seen, held within a bound of the reception. A publisher whose clock
/// jumps or runs away can shift its poses by kMostJitterNs and no more.
class SourceClock {
 public:
  static constexpr std::int64_t kMostJitterNs = 100'000'000;

  /// source_ns  0: the publisher says none
  std::int64_t server_time_ns(std::int64_t source_ns, std::int64_t received_ns);

 private:
  bool started_ = false;
  std::int64_t shortest_way_ns_ = 0;  // reception minus source time: the way and the difference of the clocks
  std::int64_t received_ns_ = 0;
};

}  // namespace collided::service
