#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "client/library/recordings/recorded_run.hpp"

namespace collided::client {

/// When a recorded sample is due in a replay, and the instant of its poses. Both in the recording's time.
struct ReplayTime {
  std::int64_t due_ns = 0;
  std::int64_t source_ns = 0;
};

/// The times of a recording's samples. A recorder may record samples late, for example after a pause of its machine;
/// the publisher's stamps are the true times. Therefore the stamp determines when a sample is due and its poses'
/// instant. The shortest time from stamp to recording counts as the transport time of all samples. If it is a lease or
/// more, it counts as the offset of the publisher's clock.
///
/// Stamps that stay far from the recording times, such as after a jump of the clock, are not followed: the publisher
/// counts as undated, and its poses are dated by their recording unless the stamp is near it.
struct ReplayTimes {
  std::vector<ReplayTime> of;      // by item
  std::vector<std::size_t> order;  // indexes of items by due time; a publisher's samples keep their order
  std::size_t undated_publishers = 0;
};

/// threads  pure
ReplayTimes replay_times(const RecordedRun& run);

}  // namespace collided::client
