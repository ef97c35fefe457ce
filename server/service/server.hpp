#pragma once

#include <memory>
#include <spdlog/logger.h>
#include <string>
#include <thread>
#include <vector>

#include "server/service/options/options.hpp"

namespace collided::engine::service {

/// What stops a start: one sentence for the user.
struct StartError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The server: everything between main() and the rooms below.
///
///   Server server(options, log);   // loads, joins the domain, makes sure to be alone; throws StartError
///   server.start();                // serves from here on
///   server.stop();                 // answers what is in, ends the contacts, leaves
class Server {
 public:
  Server(const Options& options, std::shared_ptr<spdlog::logger> log);
  ~Server();

  /// "ready: ..." for scripts that wait.
  std::string start();
  void stop();
  /// Writes the flight recorder's memory beside the server's other files, and says where or why not.
  void write_flight_recorder();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Loads, compares some answers with brute force, says so; 0 when all are equal.
int run_once(const Options& options);

std::string version_text();

}  // namespace collided::engine::service
