#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "idl/dds.hpp"
#include "server/service/runtime/clock.hpp"

// What a starting server learns of the others of its namespace, before it publishes anything: DDS keeps the last sample
// of each for participants that join.
namespace collided::engine::service {

/// Calls hear(sample) with samples of live servers on a topic, until it returns true or the time is over.
template <class T, class Hear>
void hear_servers(const dds::Participant& participant, const std::string& name_space, std::int64_t time_ns,
                  Hear&& hear) {
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

/// After this time, samples of all running servers must have arrived.
///
/// uses_keys  the others must complete the handshake first
constexpr std::int64_t listening_ns(bool uses_keys) { return uses_keys ? 1'000'000'000 : 250'000'000; }

/// least_ns  how long to wait at least while no server is received
/// returns   the process of the namespace's primary; nothing: there is none
std::optional<long> heard_primary(const dds::Participant& participant, const std::string& name_space, bool uses_keys,
                                  std::int64_t least_ns = 0);

}  // namespace collided::engine::service
