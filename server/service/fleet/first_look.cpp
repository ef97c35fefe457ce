#include "server/service/fleet/first_look.hpp"

#include <algorithm>

#include "server/service/runtime/clock.hpp"

namespace collided::engine::service {
namespace {

/// Calls hear(sample) with what living servers say on a topic, until it returns true or whoever is there must have been heard.
template <class T, class Hear>
void listen(const dds::Participant& participant, const std::string& name_space, std::int64_t time_ns, Hear&& hear) {
  const dds::Topic<T> topic(participant, name_space);
  dds::Reader<T> reader(topic);
  dds::WaitSet waitset(participant);
  waitset.attach(reader, 1);
  dds::Sample<T> sample;
  const std::int64_t until_ns = steady_ns() + time_ns;
  for (std::int64_t now_ns = steady_ns(); now_ns < until_ns; now_ns = steady_ns()) {
    waitset.wait(until_ns - now_ns);
    while (reader.take(sample)) {
      const bool lives = sample.info().valid_data && sample.info().instance_state == DDS_ALIVE_INSTANCE_STATE;
      if (lives && hear(*sample)) return;
    }
  }
}

std::int64_t listening_ns(bool uses_keys) {
  constexpr std::int64_t kInTheOpenNs = 250'000'000;
  constexpr std::int64_t kBehindKeysNs = 1'000'000'000;
  return uses_keys ? kBehindKeysNs : kInTheOpenNs;
}

}  // namespace

std::optional<long> heard_primary(const dds::Participant& participant, const std::string& name_space, bool uses_keys,
                                  std::int64_t least_ns) {
  std::optional<long> pid;
  listen<wire::Status>(participant, name_space, std::max(listening_ns(uses_keys), least_ns),
                       [&](const wire::Status& status) {
                         pid = static_cast<long>(status.pid);
                         return true;
                       });
  return pid;
}

std::uint64_t greatest_epoch(const dds::Participant& participant, const std::string& name_space, bool uses_keys) {
  std::uint64_t greatest = 0;
  listen<wire::Member>(participant, name_space, listening_ns(uses_keys), [&](const wire::Member& member) {
    greatest = std::max<std::uint64_t>(greatest, member.epoch);
    return false;
  });
  return greatest;
}

}  // namespace collided::engine::service
