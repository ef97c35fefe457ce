#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "collided/nearest.hpp"

namespace collided::client {

/// Whether the question or one of the objects is of those.
bool is_wanted(const NearestEvent& event, const NearestWatchOptions& wanted);

/// Makes news of the events that a Watch on the fences' topics reports: who follows whom. No DDS, no threads.
class NearestNews {
 public:
  /// Nothing: the event is about a fence, or says only that the next one has more.
  std::optional<NearestEvent> take(const Event& event);

 private:
  struct Newest {
    std::string object;
    std::uint64_t id = 0;
    EndReason ended = EndReason::none;  // why it is not any more, while it is not told who follows
    bool poses_merged = false;          // with that end
  };
  std::map<std::uint64_t, Newest> newest_;  // by question
};

}  // namespace collided::client
