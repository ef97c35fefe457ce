#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "client/library/connection/server_pulse.hpp"
#include "collided/client.hpp"

namespace collided::client {

class Connection;

/// Routes a client's questions to the servers of one world: the primary and its replicas. It is the only interface of
/// the library's core to a fleet.
///
/// threads  any
class Route {
 public:
  /// Asks the server of this connection once.
  using AskOnce = std::function<std::optional<Error>(Connection& connection)>;

  virtual ~Route() = default;

  /// Notes that other servers publish on the namespace; from the next question on they are looked for.
  virtual void note_company() = 0;
  /// True if there may be a server in addition to the primary. If not, the primary is asked without this class.
  virtual bool has_company() const = 0;

  /// Asks one server after the other until one gives a usable answer.
  ///
  /// answers   filled in by a call of `once` without an error
  /// deadline  for the whole question
  /// returns   the error of the server that was asked last
  virtual std::optional<Error> ask(const AskOnce& once, const AskOptions& options, const Answers& answers,
                                   Clock::time_point deadline) = 0;

  /// Notes that a command of this client has changed the world by this world time. Answers to later questions include
  /// the change.
  virtual void note_change(std::int64_t world_time_ns) = 0;
  /// Notes that a command failed but may have been executed.
  virtual void note_possible_change() = 0;

 protected:
  Route() = default;
  Route(const Route&) = default;
  Route& operator=(const Route&) = default;
};

/// primary  must outlive the route
std::unique_ptr<Route> make_route(Connection& primary);

}  // namespace collided::client
