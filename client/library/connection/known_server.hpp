#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <utility>

#include "idl/dds.hpp"

namespace collided::client {

/// Which DDS participant is the server: the one that answered hello, or took the place of one that fell silent. What others write on the server's topics is not
/// taken while that one is heard.
///
/// threads  any
class KnownServer {
 public:
  /// Whose a sample is: the server's; that of a process that may be the server, since none has answered hello yet or the
  /// known one is silent; or a stranger's, which is not taken.
  enum class Origin { server, unknown, stranger };
  /// reader, writer  that took it, and its publication handle
  /// is_silent       the known server has not been heard for so long that another may take its place
  Origin origin_of(dds_entity_t reader, dds_instance_handle_t writer, bool is_silent);
  /// Whether anybody has answered hello.
  bool is_known() const { return server_.load(std::memory_order_acquire) != 0; }
  /// The participant of a reply to hello, or of an heir's status: from now on the server.
  void greeted(dds_entity_t reader, dds_instance_handle_t writer);
  /// Whether the server was heard after samples of others came. Where a new server takes the place of one that has ended,
  /// the old one is never heard again.
  bool has_rival() const { return has_rival_.load(std::memory_order_relaxed); }
  /// Samples that were not taken.
  std::uint64_t refused() const { return refused_.load(std::memory_order_relaxed); }

 private:
  std::uint64_t participant_of(dds_entity_t reader, dds_instance_handle_t writer);

  std::atomic<std::uint64_t> server_{0};
  std::atomic<std::uint64_t> refused_{0};
  std::atomic<bool> is_rival_due_{
      false};  // others were refused since the server was known: once it speaks, there are two
  std::atomic<bool> has_rival_{false};
  std::mutex mutex_;
  std::map<std::pair<dds_entity_t, dds_instance_handle_t>, std::uint64_t> participants_;  // by reader and writer
};

}  // namespace collided::client
