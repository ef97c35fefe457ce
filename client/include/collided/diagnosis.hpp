#pragma once

#include <string>
#include <vector>

#include <collided/client.hpp>

#pragma GCC visibility push(default)

namespace collided {

enum class Health { ok, warn, fail };

/// One thing that was looked at. `about`, for programs: configuration, interface, places, buffer, server, versions, clock,
/// round_trip, losses, others.
struct Finding {
  Health health = Health::ok;
  std::string about;
  std::string text;
  std::string remedy;  // empty where nothing is to be done
};

/// Looks for what usually keeps programs from finding or hearing each other over DDS: reads this machine's settings, joins
/// the domain, listens for servers, and asks one 1,000 times. Takes about a second, and `options.wait` more where no server
/// answers.
std::vector<Finding> diagnose(const ConnectOptions& options);

}  // namespace collided

#pragma GCC visibility pop
