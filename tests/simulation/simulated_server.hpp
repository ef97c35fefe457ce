#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "server/service/events/broadcast.hpp"
#include "server/fleet/instant_digest.hpp"
#include "server/service/ingest/publishers.hpp"
#include "server/world/world.hpp"
#include "tests/simulation/recording_event_writer.hpp"

namespace collided::simulation {
using namespace engine;

using NamedPair = std::pair<std::string, std::string>;

/// One life of a server without network, thread or clock: the world, its publishers' book and what it tells, in the
/// order in which the server's loop calls them. After each step all pairs of objects are compared with the contacts
/// that hold.
class SimulatedServer {
 public:
  static constexpr std::int64_t kRecoveryNs = 300'000'000;

  /// lacks_nothing  it begins with what was there before it, or there was nothing: it does not wait for publishers
  SimulatedServer(std::uint64_t epoch, std::int64_t now_ns, std::FILE* to, RecordingEventWriter::Violation violation,
                  Voice voice = Voice::speaks, bool lacks_nothing = false);

  std::uint64_t epoch() const { return epoch_; }
  std::uint64_t steps() const { return steps_; }
  const World& world() const { return world_; }

  void take(service::DefinitionSample& sample, std::int64_t now_ns);
  void take(service::PoseSample& sample, std::int64_t now_ns);
  void lost(std::uint64_t publisher, std::int64_t now_ns);
  /// A step where something has changed; ten bookmarks a second.
  void tick(std::int64_t now_ns);
  /// Takes the place of the one that spoke so far.
  void speak(std::int64_t now_ns, const service::SpokenBefore& before);
  /// Of the world at the newest whole second that is settled, and the state that it is of.
  const service::DigestMaker& digests() const { return digests_; }
  /// Of what is in the world now, by all pairs.
  /// And pairs in doubt.
  std::set<NamedPair> touching() const;
  /// Once all is at rest and every publisher has said so: what is open is what touches.
  void compare_with_all_pairs();

 private:
  template <class Apply>
  void apply(std::int64_t now_ns, Apply&& once);
  void step(std::int64_t now_ns);
  void say_status(std::int64_t now_ns);

  std::uint64_t epoch_;
  std::int64_t started_ns_;
  bool lacks_nothing_;
  std::int64_t next_status_ns_;
  std::int64_t say_again_ns_ = 0;  // when all that holds is said once more; 0: not
  RecordingEventWriter::Violation violation_;
  std::unique_ptr<RecordingEventWriter> event_writer_;
  World world_;
  service::Publishers publishers_;
  service::Broadcast broadcast_;
  service::DigestMaker digests_;
  std::uint64_t changes_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace collided::simulation
