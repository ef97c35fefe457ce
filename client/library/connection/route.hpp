#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "client/library/connection/server_pulse.hpp"
#include "collided/client.hpp"

namespace collided::client {

class Connection;

/// The way of a client's questions to the servers that hold one world: its primary and whoever else can answer. This is
/// all that the core of the library knows of a fleet.
///
/// threads  any
class Route {
 public:
  /// Asks the server of this connection once.
  using AskOnce = std::function<std::optional<Error>(Connection& connection)>;

  virtual ~Route() = default;

  /// Other servers write the namespace's status: from the next question on they are looked for.
  virtual void note_company() = 0;
  /// Whether there may be a server beside the primary. If not, the primary is asked without this class.
  virtual bool has_company() const = 0;

  /// Asks one server after the other until one has a good answer.
  ///
  /// answers   are what a call of `once` without an error has filled in
  /// deadline  of the whole question
  /// returns   the error of the server that was asked last
  virtual std::optional<Error> ask(const AskOnce& once, const AskOptions& options, const Answers& answers,
                                   Clock::time_point deadline) = 0;

  /// A command of this client has changed the world by this world time. Questions after it are answered with that change.
  virtual void note_change(std::int64_t world_time_ns) = 0;
  /// A command failed, and may have been carried out.
  virtual void note_possible_change() = 0;

 protected:
  Route() = default;
  Route(const Route&) = default;
  Route& operator=(const Route&) = default;
};

/// primary  must outlive the route
std::unique_ptr<Route> make_route(Connection& primary);

}  // namespace collided::client
