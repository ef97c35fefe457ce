#pragma once

#include <cstdint>

#include "idl/topics.hpp"

namespace collided::service {

/// What one publisher's stamp means in world time.
enum class StampKind : std::uint8_t {
  good,
  none,    // it says none: the batch's reception counts
  jumped,  // its clock went back or ahead by more than a lease: no way leads there
  late,    // before what it has said already: where things are now is news all the same
};

struct WorldStamp {
  std::int64_t time_ns = 0;
  StampKind kind = StampKind::good;
};

/// World time is the publishers' own: a stamp is taken as it is, to the nanosecond. A clock that is a lease and more off the
/// server's (nanoseconds since boot, another epoch) counts from where its first batch came; so does one after a jump.
class SourceClock {
 public:
  /// Of clocks that are taken as one.
  static constexpr std::int64_t kMostOffNs = wire_contract::kPublisherLeaseNs;

  /// source_ns  0: the publisher says none
  WorldStamp stamp(std::int64_t source_ns, std::int64_t received_ns);
  /// Whether the last batch said no time: the next one without may say something all the same.
  bool is_without_stamps() const { return is_without_stamps_; }

 private:
  bool started_ = false;
  bool is_without_stamps_ = false;
  std::int64_t offset_ns_ = 0;  // of world time, from the publisher's
  std::int64_t source_ns_ = 0;  // of the last good stamp
  std::int64_t received_ns_ = 0;
  std::int64_t newest_ns_ = 0;  // world time
};

}  // namespace collided::service
