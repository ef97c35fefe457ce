#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "client/library/recordings/recorded_run.hpp"

namespace collided::client {

/// When a replay gives a recorded sample, and of which instant its poses are. Both in the recording's time.
struct ReplayTime {
  std::int64_t due_ns = 0;
  std::int64_t source_ns = 0;
};

/// The times of a recording's samples. A recorder may write down late what it received, such as after a pause of its machine:
/// a publisher's stamps say when that really was. So a sample is due, and its poses are dated, by the stamp; the shortest time
/// from stamp to recording is the way that every sample took. Where that is a lease or more the publisher's clock was off by it.
///
/// Stamps that stay away from the times of recording, as where a clock jumped, are not followed: those poses are dated by
/// their recording unless the stamp is near, as far as can be told, and the publisher counts as undated.
struct ReplayTimes {
  std::vector<ReplayTime> of;      // by item
  std::vector<std::size_t> order;  // of the items, by due time; a publisher's samples stay in their order
  std::size_t undated_publishers = 0;
};

/// threads  pure
ReplayTimes replay_times(const RecordedRun& run);

}  // namespace collided::client
