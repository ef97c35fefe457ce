#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <utility>

#include "idl/dds.hpp"

namespace collided::client {

/// The DDS participant that is the server: the one that answered hello, or replaced one that fell silent. While it is
/// alive, messages of others on the server's topics are ignored.
///
/// threads  any
class KnownServer {
 public:
  /// Origin of a sample. server: the server. unknown: possibly the server, since none has answered hello yet or the
  /// known one is silent. stranger: another process, whose sample is ignored.
  enum class Origin { server, unknown, stranger };
  /// reader, writer  the reader of the sample, and the publication handle of its writer
  /// is_silent       the known server has been silent for so long that another may replace it
  Origin origin_of(dds_entity_t reader, dds_instance_handle_t writer, bool is_silent);
  /// True after a reply to hello.
  bool is_known() const { return server_.load(std::memory_order_acquire) != 0; }
  /// The participant that wrote a reply to hello, or an heir's status, is the server from now on.
  void greeted(dds_entity_t reader, dds_instance_handle_t writer);
  /// True if a message of the server came after samples of others. After a normal replacement the old server never
  /// sends again.
  bool has_rival() const { return has_rival_.load(std::memory_order_relaxed); }
  /// Number of ignored samples.
  std::uint64_t refused() const { return refused_.load(std::memory_order_relaxed); }

 private:
  std::uint64_t participant_of(dds_entity_t reader, dds_instance_handle_t writer);

  std::atomic<std::uint64_t> server_{0};
  std::atomic<std::uint64_t> refused_{0};
  std::atomic<bool> is_rival_due_{
      false};  // samples of others were ignored since the server was known: if it sends again, there are two
  std::atomic<bool> has_rival_{false};
  std::mutex mutex_;
  std::map<std::pair<dds_entity_t, dds_instance_handle_t>, std::uint64_t> participants_;  // by reader and writer
};

}  // namespace collided::client
