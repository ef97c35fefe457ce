#pragma once

#include <array>
#include <cstdint>

#include "idl/peers.hpp"

namespace collided::engine::service {

/// The participants behind query writers. Asking DDS takes a lock and memory, so those of late are kept.
///
/// threads  one at a time
class Participants {
 public:
  /// The participant of a writer that `reader` is matched with; 0: it is matched no longer.
  std::uint64_t of(dds_entity_t reader, std::uint64_t writer) {
    Known& known = known_[writer % known_.size()];
    if (known.writer != writer || known.participant == 0) known = {writer, dds::participant_of(reader, writer)};
    return known.participant;
  }

 private:
  struct Known {
    std::uint64_t writer = 0;
    std::uint64_t participant = 0;
  };
  std::array<Known, 256> known_{};  // by the writer's handle, which DDS makes up at random
};

}  // namespace collided::engine::service
