#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <variant>

#include "idl/instant.hpp"
#include "server/service/runtime/place.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// States of the world at past instants, for questions that name one. The newest few are kept: all chunks of a request
/// are answered on one state, and often many questions are about the same instant.
///
/// threads  any
class PastStates {
 public:
  /// place  since when this server's states are complete
  PastStates(const World& world, const Place& place) : world_(world), place_(place) {}

  /// instant  of any kind but `latest`
  /// newest   the origin of relative instants; also identifies the state for the chunks of one request
  /// returns  the state, or a sentence why there is none
  std::variant<std::shared_ptr<const Snapshot>, std::string> at(const wire_contract::AskedInstant& instant,
                                                                const Snapshot& newest);

 private:
  struct Kept {
    std::int64_t time_ns = 0;
    std::uint64_t version = 0;  // of the newest state when it was made
    std::shared_ptr<const Snapshot> state;
  };

  std::string why_not(std::int64_t time_ns, const Snapshot& newest) const;

  const World& world_;
  const Place& place_;
  std::mutex mutex_;
  std::array<Kept, 4> kept_;
  std::size_t next_ = 0;
};

}  // namespace collided::engine::service
