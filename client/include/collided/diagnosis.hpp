#pragma once

#include <string>
#include <vector>

#include <collided/client.hpp>

/// Why do programs not find or hear each other?
#pragma GCC visibility push(default)

namespace collided {

/// ok: as it should be. warn: works, but is likely to cause trouble. fail: does not work.
enum class Health { ok, warn, fail };

/// The result of one check.
struct Finding {
  Health health = Health::ok;
  /// What was checked, as a fixed word for programs: configuration, interface, buffer, places, server, busy, versions, clock,
  /// publisher_clocks, round_trip, strangers or losses.
  std::string about;
  std::string text;    // what was found, one sentence for people
  std::string remedy;  // what to do; empty where nothing is to be done
};

/// Checks what usually keeps programs from finding or hearing each other over DDS: reads this machine's settings, joins
/// the domain, listens for servers, and sends one of them 1,000 empty questions.
///
/// returns  the findings in the order of the checks; checks that cannot be made, such as those of a server where none
///          answers, are left out. Errors are findings too.
/// cost     about a second, and up to options.wait more where no server answers
/// threads  any; it makes a connection of its own
std::vector<Finding> diagnose(const ConnectOptions& options);

}  // namespace collided

#pragma GCC visibility pop
