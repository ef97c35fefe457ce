#include "client/library/connection/known_server.hpp"

#include "idl/peers.hpp"

namespace collided::client {

KnownServer::Origin KnownServer::origin_of(dds_entity_t reader, dds_instance_handle_t writer, bool is_silent) {
  const std::uint64_t server = server_.load(std::memory_order_acquire);
  if (server == 0) return Origin::unknown;
  const std::uint64_t participant = participant_of(reader, writer);
  if (participant == server) {
    if (is_rival_due_.load(std::memory_order_relaxed)) has_rival_.store(true, std::memory_order_relaxed);
    return Origin::server;
  }
  if (is_silent) return Origin::unknown;
  refused_.fetch_add(1, std::memory_order_relaxed);
  // The participant of a writer that no longer exists is unknown.
  if (participant != 0) is_rival_due_.store(true, std::memory_order_relaxed);
  return Origin::stranger;
}

void KnownServer::greeted(dds_entity_t reader, dds_instance_handle_t writer) {
  const std::uint64_t participant = participant_of(reader, writer);
  if (server_.exchange(participant, std::memory_order_acq_rel) != participant)
    is_rival_due_.store(false, std::memory_order_relaxed);
}

std::uint64_t KnownServer::participant_of(dds_entity_t reader, dds_instance_handle_t writer) {
  const std::lock_guard lock(mutex_);
  // Several times the number of a server's writers; the excess belongs to ended servers.
  constexpr std::size_t kMost = 1'024;
  if (participants_.size() > kMost) participants_.clear();
  const auto [known, is_new] = participants_.try_emplace({reader, writer}, 0);
  if (known->second == 0) known->second = dds::participant_of(reader, writer);
  return known->second;
}

}  // namespace collided::client
