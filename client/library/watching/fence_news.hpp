#pragma once

#include <optional>
#include <vector>

#include "collided/fences.hpp"

namespace collided::client {

/// Makes news of fences of the events that a Watch on the fences' topics reports. No DDS, no threads.
class FenceNews {
 public:
  /// What the event says, if its fence tells that. The coming in of a passage waits for its going out.
  std::vector<FenceEvent> take(const Event& event);

 private:
  std::optional<Event> passing_;  // the `began` of a passage
};

}  // namespace collided::client
