#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "client/library/connection/known_server.hpp"
#include "client/library/connection/names.hpp"
#include "client/library/connection/query_writers.hpp"
#include "client/library/connection/requests.hpp"
#include "client/library/connection/server_pulse.hpp"
#include "client/library/connection/shared_participant.hpp"
#include "collided/client.hpp"

namespace collided::client {

class Route;

/// The last message of a publisher, for questions whose answers must take it into account.
struct WriteBarrier {
  std::uint64_t publisher = 0;
  std::uint64_t sequence = 0;
};

/// A client's connection to the server: its query writer, the reader of its replies in their own partition, and the
/// server's status. The Client and the publishers and watches made from it share it. Any thread.
class Connection {
 public:
  /// Joins the domain and waits until a server answers hello.
  /// role  `server` lets other clients discover this process too, which is needed to receive from them
  static Result<std::shared_ptr<Connection>> open(const ConnectOptions& options, dds::Role role = dds::Role::client);

  /// Opens a connection to a replica of the primary's server, on the same participant; null if it does not answer
  /// within `wait`. It gives up sooner than other connections, since another server can be asked.
  static std::shared_ptr<Connection> open_beside(const Connection& primary, const std::string& name_space,
                                                 std::chrono::nanoseconds wait);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  const ConnectOptions& options() const { return options_; }
  const dds::Participant& participant() const { return *participant_; }
  std::uint64_t client() const { return client_; }
  Requests& requests() { return requests_; }
  Names& names() { return names_; }
  /// Null: only the server of this connection is asked.
  Route* route() { return route_.get(); }
  ServerPulse& pulse() { return pulse_; }
  const ServerPulse& pulse() const { return pulse_; }
  /// True if the server wrote a sample that this reader took; that shows it is alive. Any thread, DDS's too.
  ///
  /// server  the sender according to the sample
  bool is_from_server(const dds::ReaderBase& reader, const dds_sample_info_t& info, std::uint64_t server);
  /// The same for a sample with an epoch. If the known server is silent, a sample with a greater epoch is from its
  /// heir, even before the heir's status arrives. If the old server resumes in between, it is ignored.
  bool is_from_server(const dds::ReaderBase& reader, const dds_sample_info_t& info, std::uint64_t server,
                      std::uint64_t epoch);

  /// Messages of other processes on the server's topics.
  Strangers strangers() const { return {.samples = known_server_.refused(), .speak_now = known_server_.has_rival()}; }

  using QueryRight = wire_contract::QueryRight;
  /// Ensures that queries with this right can be sent: greets a server that is new to this client, through the same
  /// writer. Returns the error if none answers.
  std::optional<Error> ready(Clock::time_point deadline, QueryRight right = QueryRight::ask);
  /// Sets this client's number and sends. Returns the error if the keys do not grant the right, or the server accepts
  /// no more messages.
  std::optional<Error> send(wire::Query& query, QueryRight right = QueryRight::ask);
  /// The result of wait(): the replies, or the error.
  struct Waited {
    const std::vector<SamplePool<wire::Reply>::Pointer>* replies = nullptr;
    std::optional<Error> error = {};
  };
  /// Waits for replies to a request. Returns the error if `deadline` passes, or the server falls silent or is no longer
  /// `server`. `what` begins the error.
  Waited wait(Requests::Running& request, Clock::time_point deadline, std::uint64_t server, const std::string& what);

  /// The error that states how long the server has been silent.
  Error disconnected() const;
  /// The newest message of any of this connection's publishers, as passed to note_write().
  WriteBarrier last_write() const;
  void note_write(const WriteBarrier& barrier);

 private:
  Connection(const ConnectOptions& options, std::shared_ptr<dds::Participant> participant, bool is_beside = false);
  /// Repeats hello until a server answers. False if none does by `deadline` or, after its reader was matched, by
  /// `deadline_if_found`.
  bool greet(Clock::time_point deadline, Clock::time_point deadline_if_found, QueryRight right);
  bool is_from_server_or_its_heir(const dds::Sample<wire::Status>& status);
  Error no_server(std::chrono::nanoseconds waited);
  bool is_gone() const;

  void hear_status(const dds::Taker<wire::Status>& taker);
  void keep_until_greeted(dds::Sample<wire::Status>& status);
  void know_server_by(const dds::Sample<wire::Reply>& reply);

  using EarlyStatuses = std::map<std::uint64_t, dds::Sample<wire::Status>>;  // by the reader's handle of the writer
  ConnectOptions options_;
  std::shared_ptr<dds::Participant> participant_;
  const bool is_beside_;  // a connection to a replica
  std::uint64_t client_;
  Requests requests_;
  Names names_;
  ServerPulse pulse_;
  KnownServer known_server_;  // before the first greeting its readers may not exist yet, and all samples are accepted
  dds::Sample<wire::Status> incoming_status_;
  std::mutex early_mutex_;
  EarlyStatuses early_;  // from before the first reply to hello
  std::unique_ptr<Route> route_;
  std::mutex greeting_mutex_;
  std::array<std::atomic<std::uint64_t>, wire_contract::kQueryRights.size()>
      greeted_server_{};  // by the writer's index
  mutable std::mutex barrier_mutex_;
  WriteBarrier last_write_;

  // Last, so that they are destroyed first: their callbacks use the members above.
  dds::Topic<wire::Reply> reply_topic_;
  dds::Topic<wire::Status> status_topic_;
  dds::Reader<wire::Reply> reply_reader_;
  dds::Reader<wire::Status> status_reader_;
  QueryWriters query_writers_;
};

/// Returns a random number, never 0, that identifies a client or publisher among all processes.
std::uint64_t random_number();

}  // namespace collided::client
