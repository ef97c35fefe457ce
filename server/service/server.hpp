#pragma once

#include <functional>
#include <memory>
#include <spdlog/fwd.h>
#include <string>
#include <thread>
#include <vector>

#include "server/service/options/options.hpp"

namespace collided::engine::service {

/// The reason why the server cannot start: one sentence for the user.
struct StartError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The server: connects everything between main() and the folders of this room.
///
///   Server server(options, log);   // loads, joins the domain, makes sure to be alone; throws StartError
///   server.start();                // serves from here on
///   server.stop();                 // answers what is queued, ends the contacts, leaves
///
/// threads  one
class Server {
 public:
  /// end  has stop() called soon, once another server has taken this one's place; called on any thread, returns at once
  /// Throws StartError or LoadError.
  Server(const Options& options, std::shared_ptr<spdlog::logger> log, std::function<void()> end);
  ~Server();

  /// Starts serving; returns a line "ready: ..." for scripts that wait for it.
  std::string start();
  /// Returns once all is ended; a second call does nothing.
  void stop();
  /// To be asked when end was called. Whether this server was asked to hand over, and nobody has taken its place: then it
  /// goes on.
  bool goes_on();
  /// Whether another server of the namespace has taken this one's place without having been asked to.
  bool has_given_way() const;
  /// Writes the flight recorder's memory to a file beside the server's others; the log says where, or why it cannot.
  void write_flight_recorder();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Loads the scenes, compares some answers with brute force and prints the result; returns 0 when all are equal, else
/// 1.
int run_once(const Options& options);

std::string version_text();

}  // namespace collided::engine::service
