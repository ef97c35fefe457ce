#pragma once

#include <string>

namespace collided::testing_support {

/// What the words of a witness's lines mean. Times are of std::chrono::steady_clock, which all processes of a machine share.
///   event EPOCH HEARD_NS         a contact event was heard
///   answer EPOCH ASKED_NS HOW    a question that was asked then was answered: right, wrong or undecided
///   refused ASKED_NS
inline constexpr const char* kEventLine = "event";
inline constexpr const char* kAnswerLine = "answer";
inline constexpr const char* kRefusedLine = "refused";

/// Publishes four balls that touch posts and part from them, hears the events, asks one ray after another, and looks at the
/// fleet, from one place of a network; until it is ended by a signal. Prints lines as above, and writes to the file
/// `<fleet_path>` what it sees of the fleet: "SEEN_NS FAULTS", and a line for each member, "NAME ROLE STATE HASHED".
/// Returns the exit code.
int run_cut_witness(int domain, const std::string& interface, const std::string& name, const std::string& fleet_path);

}  // namespace collided::testing_support
