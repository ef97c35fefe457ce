#pragma once

#include <functional>
#include <memory>
#include <spdlog/fwd.h>
#include <string>
#include <thread>
#include <vector>

#include "server/service/options/options.hpp"
#include "server/service/runtime/clock.hpp"
#include "server/service/runtime/place.hpp"

namespace collided::dds {
class Participant;
}

namespace collided::engine::service {

/// The reason why the server cannot start: one sentence for the user.
struct StartError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Makes the place of a server. participant and clock outlive it; `end` as for Server.
using MakePlace = std::function<std::unique_ptr<Place>(const Options& options, const dds::Participant& participant,
                                                       const WorldClock& clock, std::shared_ptr<spdlog::logger> log,
                                                       std::function<void()> end)>;

/// The source of a server's place.
struct PlaceSource {
  ApplyFleetSetting apply;                 // stores the settings of the fleet
  std::function<void(Options&)> complete;  // called once all settings are known, unless nothing will be served
  MakePlace make;
};

/// The server: connects everything between main() and the folders of this room.
///
///   Server server(options, log, make_place, end);  // loads, joins the domain, makes sure to be alone; throws StartError
///   server.start();                                // serves from here on
///   server.stop();                                 // answers queued questions, ends the contacts, leaves
///
/// threads  one
class Server {
 public:
  /// make_place  makes the server's role among others
  /// end         called once another server has taken over, to have stop() called soon; called on any thread, returns
  ///             at once
  /// throws      StartError, LoadError or CannotServeNow
  Server(const Options& options, std::shared_ptr<spdlog::logger> log, const MakePlace& make_place,
         std::function<void()> end);
  ~Server();

  /// Starts serving; returns a line "ready: ..." for waiting scripts, to be printed once is_restoring() is over.
  std::string start();
  /// Whether commands from before a stop or a crash still have to be carried out. It does not wait for publishers
  /// separated by a crash, nor for losses to be accepted. Any thread.
  bool is_restoring() const;
  /// Returns once everything has ended; a second call does nothing.
  void stop();
  /// Call this after `end` was called. True: this server was asked to hand over but no other has taken over, so it
  /// continues.
  bool goes_on();
  /// Whether another server of the namespace has taken over although this one was not asked to hand over.
  bool has_given_way() const;
  /// Writes the flight recorder's memory to a file next to the server's others; the log reports where, or why it
  /// cannot.
  void write_flight_recorder();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Loads the scenes, compares some answers with brute force and prints the result; returns 0 if all are equal, else 1.
int run_once(const Options& options);

std::string version_text();

}  // namespace collided::engine::service
