#pragma once

#include <string>
#include <vector>

#include <collided/client.hpp>

/// Diagnosis: why do programs not find or reach each other?
#pragma GCC visibility push(default)

namespace collided {

/// ok: as it should be. warn: works, but is likely to cause trouble. fail: does not work.
enum class Health { ok, warn, fail };

/// The result of one check.
struct Finding {
  Health health = Health::ok;
  /// What was checked, as a fixed word for programs: configuration, interface, buffer, places, server, busy, versions,
  /// clock, publisher_clocks, round_trip, strangers or losses.
  std::string about;
  std::string text;    // what was found, one sentence for people
  std::string remedy;  // what to do; empty if nothing
};

/// Checks the usual causes why programs do not find or reach each other over DDS. It reads this machine's settings,
/// joins the domain, waits for servers' statuses, and sends one server 1,000 empty questions.
///
/// returns  the findings in the order of the checks. Checks that cannot run, such as those of a server if none answers,
///          are left out. Errors are findings too.
/// cost     about a second, and up to options.wait more if no server answers
/// threads  any; it makes a connection of its own
std::vector<Finding> diagnose(const ConnectOptions& options);

}  // namespace collided

#pragma GCC visibility pop
