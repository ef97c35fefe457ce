#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/world/query/world_digest.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// The digest of the world at an instant, a whole second of world time; 0: there is none.
struct InstantDigest {
  std::int64_t time_ns = 0;
  WorldDigest digest;
};

/// Works out what two servers compare: the world at whole seconds that are settled, which is the same wherever the same
/// batches have arrived, and the fingerprint of the scenes.
///
/// threads  one
class DigestMaker {
 public:
  explicit DigestMaker(const World& world) : world_(world) {}

  /// Works out the digest of the newest whole second that is settled, unless that is done. False: there is no newer one.
  ///
  /// settled_ns  up to which all is known where nothing has changed since the world's newest state; found before the call
  /// cost        all objects, and an index over them
  bool make(std::int64_t now_ns, std::int64_t settled_ns);
  /// The newest that was made.
  const InstantDigest& newest() const { return newest_; }
  /// The state that it is of; null: there is none.
  const std::shared_ptr<const Snapshot>& state() const { return state_; }

  /// The fingerprint of the scenes that are loaded now. Costs something once for each change of them.
  std::uint64_t scene_fingerprint();

 private:
  bool make_past(const Snapshot& newest, std::int64_t instant_ns);
  void keep(std::int64_t instant_ns, std::shared_ptr<const Snapshot> state);

  const World& world_;
  InstantDigest newest_;
  std::shared_ptr<const Snapshot> state_;
  std::uint64_t quiet_version_ = 0;  // of the world, where state_ is its newest state; 0: an earlier one
  SceneList scenes_;                 // that fingerprint_ is of
  std::uint64_t fingerprint_ = 0;
};

}  // namespace collided::engine::service
