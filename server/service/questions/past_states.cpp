#include "server/service/questions/past_states.hpp"

#include <fmt/format.h>

#include "idl/clocks.hpp"

namespace collided::engine::service {
namespace {

using wire_contract::AskedInstant;

std::int64_t time_of(const AskedInstant& instant, const Snapshot& newest) {
  if (instant.kind == AskedInstant::Kind::settled) return newest.settled_ns;
  return instant.kind == AskedInstant::Kind::at ? instant.ns : newest.world_time_ns - instant.ns;
}

double seconds(std::int64_t ns) { return wire_contract::kNanosecond_s * static_cast<double>(ns); }

}  // namespace

std::variant<std::shared_ptr<const Snapshot>, std::string> PastStates::at(const AskedInstant& instant,
                                                                          const Snapshot& newest) {
  if (!world_.memory().is_on())
    return "this server remembers no poses (--memory off), so it knows of no instant but the latest";
  const std::int64_t time_ns = time_of(instant, newest);
  if (const auto whole_since_ns = place_.whole_since_ns(); !whole_since_ns || time_ns < *whole_since_ns)
    return "at that instant this replica did not surely hold the primary's world; the primary may know";
  // Making a state takes long. The lock is held meanwhile, so that another question about the same instant waits for
  // this state instead of making its own.
  const std::lock_guard lock(mutex_);
  for (const Kept& kept : kept_) {
    if (kept.state && kept.time_ns == time_ns && kept.version == newest.version) return kept.state;
  }
  Kept& kept = kept_[next_++ % kept_.size()];
  kept = {.time_ns = time_ns, .version = newest.version, .state = world_.memory().at(time_ns)};
  if (kept.state) return kept.state;
  return why_not(time_ns, newest);
}

std::string PastStates::why_not(std::int64_t time_ns, const Snapshot& newest) const {
  const PoseMemory::Reach reach = world_.memory().reach();
  if (time_ns > reach.to_ns) {
    return fmt::format("the instant is {:.3f} s ahead of the world's time, and nobody knows what will be",
                       seconds(time_ns - reach.to_ns));
  }
  return fmt::format("the instant is {:.3f} s back, and this server remembers poses of the last {:.3f} s (--memory)",
                     seconds(newest.world_time_ns - time_ns), seconds(reach.to_ns - reach.from_ns));
}

}  // namespace collided::engine::service
