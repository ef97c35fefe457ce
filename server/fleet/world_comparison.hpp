#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "server/fleet/instant_digest.hpp"

namespace collided::engine::service {

/// Compares the own world with that of another server, wherever both have a digest of the same instant.
///
/// threads  one
class WorldComparison {
 public:
  /// The own digest of an instant, later than the last one, with the state that it is of.
  void note_own(const InstantDigest& digest, std::shared_ptr<const Snapshot> state);
  /// The other's; the last one may come again.
  void hear(const InstantDigest& digest);
  /// From now on with another server: what the one before said counts no more.
  void begin_anew();

  /// Instants in a row at which the two differed, up to the newest that could be compared.
  std::uint64_t differing() const { return differing_; }
  /// Instants that were compared.
  std::uint64_t compared() const { return compared_; }
  /// The newest instant that was compared; 0: none was.
  std::int64_t compared_to_ns() const { return compared_to_ns_; }
  /// The first object that differs, at the newest instant at which the two did; empty if none can be named.
  const std::string& object() const { return object_; }
  std::int64_t differed_at_ns() const { return differed_at_ns_; }
  /// True if all objects of publishers were equal then, and only objects of scenes and commands differed.
  bool only_unpublished_differed() const { return only_unpublished_differed_; }

 private:
  static constexpr std::size_t kMost = 8;  // seconds by which one of the two may be behind
  struct Own {
    InstantDigest digest;
    std::shared_ptr<const Snapshot> state;
  };
  void compare();

  std::deque<Own> own_;               // by time
  std::deque<InstantDigest> others_;  // by time
  std::int64_t compared_to_ns_ = 0;
  std::uint64_t compared_ = 0;
  std::uint64_t differing_ = 0;
  std::string object_;
  std::int64_t differed_at_ns_ = 0;
  bool only_unpublished_differed_ = false;
};

}  // namespace collided::engine::service
