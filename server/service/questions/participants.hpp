#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>

#include "idl/peers.hpp"
#include "idl/topics.hpp"
#include "server/service/roles/keyed_peers.hpp"

namespace collided::engine::service {

/// The process behind a query writer, and its rights.
struct QuerySender {
  std::uint64_t participant = 0;          // 0: it is already gone, and so unknown
  std::shared_ptr<const KeyedPeer> peer;  // null: the server has no keys, or the peer has proved nothing
  std::uint8_t rights = 0;                // bits by QueryRight

  bool has(wire_contract::QueryRight right) const { return ((rights >> static_cast<unsigned>(right)) & 1U) != 0; }
};

/// The participants behind query writers. Asking DDS takes a lock and memory, so recent ones are cached.
///
/// threads  one at a time
class Participants {
 public:
  /// peers  null: the server has no keys, and every client has all rights
  explicit Participants(KeyedPeers* peers = nullptr) : peers_(peers) {}

  /// The sender behind a writer that `reader` is matched with. Valid until the next call.
  const QuerySender& of(dds_entity_t reader, std::uint64_t writer) {
    Known& known = known_[writer % known_.size()];
    if (known.writer != writer || known.asker.participant == 0) known = {writer, look_up(reader, writer)};
    return known.asker;
  }

 private:
  struct Known {
    std::uint64_t writer = 0;
    QuerySender asker;
  };

  QuerySender look_up(dds_entity_t reader, std::uint64_t writer) const {
    if (peers_ == nullptr) return {.participant = dds::participant_of(reader, writer), .peer = nullptr, .rights = 0xff};
    const auto facts = dds::facts_of_writer(reader, writer);
    if (!facts) return {};
    QuerySender asker{.participant = facts->participant, .peer = peers_->of(facts->prefix), .rights = 0};
    if (asker.peer) asker.rights = rights_in(facts->partition);
    return asker;
  }

  /// DDS has let the writer into this partition only by the right of that name. A sender with any right may greet.
  static std::uint8_t rights_in(const std::string& partition) {
    for (const wire_contract::QueryRight right : wire_contract::kQueryRights) {
      if (partition == wire_contract::name_of(right))
        return static_cast<std::uint8_t>(1U | (1U << static_cast<unsigned>(right)));
    }
    return 0;
  }

  KeyedPeers* peers_;
  std::array<Known, 256> known_{};  // by the writer's handle, which DDS makes up at random
};

}  // namespace collided::engine::service
