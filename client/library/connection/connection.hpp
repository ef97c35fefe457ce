#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "client/library/connection/names.hpp"
#include "client/library/connection/requests.hpp"
#include "client/library/connection/server_pulse.hpp"
#include "client/library/connection/shared_participant.hpp"
#include "collided/client.hpp"

namespace collided::client {

/// What a publisher wrote last, for questions that must see it.
struct WriteBarrier {
  std::uint64_t publisher = 0;
  std::uint64_t sequence = 0;
};

/// One client's line to the server: its query writer, its reply reader in a partition of its own, the server's status.
/// Shared by the Client and the publishers and watches made from it. Any thread.
class Connection {
 public:
  /// Waits until a server answers hello.
  /// role  server: other clients find this one too, which listening to them takes
  static Result<std::shared_ptr<Connection>> open(const ConnectOptions& options, dds::Role role = dds::Role::client);

  const ConnectOptions& options() const { return options_; }
  const dds::Participant& participant() const { return *participant_; }
  std::uint64_t client() const { return client_; }
  Requests& requests() { return requests_; }
  Names& names() { return names_; }
  ServerPulse& pulse() { return pulse_; }
  const ServerPulse& pulse() const { return pulse_; }

  /// Says hello when a server is there that does not know this client yet; the error when none can answer.
  std::optional<Error> ready(Clock::time_point deadline);
  /// Puts this client's number in and sends; the error when the server takes nothing more.
  std::optional<Error> send(wire::Query& query);
  /// Replies for a request as they come. The error when `deadline` passes, the server falls silent or is another.
  struct Waited {
    const std::vector<SamplePool<wire::Reply>::Pointer>* replies = nullptr;
    std::optional<Error> error = {};
  };
  Waited wait(Requests::Running& request, Clock::time_point deadline, std::uint64_t server, const std::string& what);

  Error disconnected() const;
  WriteBarrier last_write() const;
  void note_write(const WriteBarrier& fence);

 private:
  Connection(const ConnectOptions& options, std::shared_ptr<dds::Participant> participant);
  bool greet(Clock::time_point deadline);
  Error no_server() const;

  ConnectOptions options_;
  std::shared_ptr<dds::Participant> participant_;
  std::uint64_t client_;
  Requests requests_;
  Names names_;
  ServerPulse pulse_;
  dds::Sample<wire::Status> incoming_status_;
  std::mutex greeting_mutex_;
  std::atomic<std::uint64_t> greeted_server_{0};
  mutable std::mutex fence_mutex_;
  WriteBarrier last_write_;

  // Last, so that they go first: their callbacks use what stands above.
  dds::Topic<wire::Query> query_topic_;
  dds::Topic<wire::Reply> reply_topic_;
  dds::Topic<wire::Status> status_topic_;
  dds::Reader<wire::Reply> reply_reader_;
  dds::Reader<wire::Status> status_reader_;
  dds::Writer<wire::Query> query_writer_;
};

/// A number that no other process draws: for clients and publishers. Never 0.
std::uint64_t random_number();

}  // namespace collided::client
