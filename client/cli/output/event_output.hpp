#pragma once

#include <string>
#include <vector>

#include "client/cli/output/output.hpp"
#include "collided/client.hpp"

namespace collided::cli {

/// Every field of an event, for machines; those that say nothing of its kind are empty.
Record event_record(const Event& event);

/// The few fields that plain output has where none were chosen.
std::vector<std::string> usual_event_fields();

/// For people; it begins with when the change had happened, which may be long before it was told.
std::string event_line(const Printer& printer, const Event& event);

}  // namespace collided::cli
