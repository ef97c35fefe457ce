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
  /// role  `server` makes other clients find this process too, which is needed to hear them
  static Result<std::shared_ptr<Connection>> open(const ConnectOptions& options, dds::Role role = dds::Role::client);

  /// A connection to a replica of that one's server, in the same process; null where none answers by then. It gives up
  /// sooner than others: there is somebody else who can be asked.
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
  /// Null: the server of this connection alone is asked.
  Route* route() { return route_.get(); }
  ServerPulse& pulse() { return pulse_; }
  const ServerPulse& pulse() const { return pulse_; }
  /// Whether a sample that this reader took was written by the server, which then lives. Any thread, DDS's too.
  ///
  /// server  whose it is, as it says
  bool is_from_server(const dds::ReaderBase& reader, const dds_sample_info_t& info, std::uint64_t server);
  /// Likewise, of a sample that says its epoch. Where the known server is silent, one of a greater epoch is its heir's, also
  /// if the heir's status comes later: a server that stood still, and goes on in between, is heard no more.
  bool is_from_server(const dds::ReaderBase& reader, const dds_sample_info_t& info, std::uint64_t server,
                      std::uint64_t epoch);

  /// What others wrote on the server's topics.
  Strangers strangers() const { return {.samples = known_server_.refused(), .speak_now = known_server_.has_rival()}; }

  using QueryRight = wire_contract::QueryRight;
  /// Makes sure that what needs this right can be sent: greets a server that is new to this client, by the way that it
  /// will go. The error where none answers.
  std::optional<Error> ready(Clock::time_point deadline, QueryRight right = QueryRight::ask);
  /// Sets this client's number and sends. The error where the keys do not give the right, or the server takes no more
  /// messages.
  std::optional<Error> send(wire::Query& query, QueryRight right = QueryRight::ask);
  /// What wait() returns: the replies, or the error.
  struct Waited {
    const std::vector<SamplePool<wire::Reply>::Pointer>* replies = nullptr;
    std::optional<Error> error = {};
  };
  /// Waits for replies to a request. Returns the error where `deadline` passes, or the server falls silent or is no
  /// longer `server`. `what` begins the error.
  Waited wait(Requests::Running& request, Clock::time_point deadline, std::uint64_t server, const std::string& what);

  /// The error that says since when the server has been silent.
  Error disconnected() const;
  /// The newest message of any of this connection's publishers, as note_write() was told.
  WriteBarrier last_write() const;
  void note_write(const WriteBarrier& barrier);

 private:
  Connection(const ConnectOptions& options, std::shared_ptr<dds::Participant> participant, bool is_beside = false);
  /// Says hello until a server answers. False where none does by `deadline`, or, once its reader was found, by the other.
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
  const bool is_beside_;  // it is to a replica
  std::uint64_t client_;
  Requests requests_;
  Names names_;
  ServerPulse pulse_;
  KnownServer known_server_;  // before the first greeting its readers may not be made yet, and all is taken
  dds::Sample<wire::Status> incoming_status_;
  std::mutex early_mutex_;
  EarlyStatuses early_;  // from before somebody has answered hello
  std::unique_ptr<Route> route_;
  std::mutex greeting_mutex_;
  std::array<std::atomic<std::uint64_t>, wire_contract::kQueryRights.size()>
      greeted_server_{};  // by the writer's place
  mutable std::mutex barrier_mutex_;
  WriteBarrier last_write_;

  // Last, so that they are destroyed first: their callbacks use the members above.
  dds::Topic<wire::Reply> reply_topic_;
  dds::Topic<wire::Status> status_topic_;
  dds::Reader<wire::Reply> reply_reader_;
  dds::Reader<wire::Status> status_reader_;
  QueryWriters query_writers_;
};

/// A random number that identifies a client or publisher among all processes. Never 0.
std::uint64_t random_number();

}  // namespace collided::client
