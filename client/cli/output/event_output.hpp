#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "client/cli/output/output.hpp"
#include "collided/client.hpp"

namespace collided::cli {

/// Every field of an event, for machines; fields without meaning for its kind are empty. The pair is in the order of
/// its names, and so are its fields.
Record event_record(const Event& event);

/// The few fields of plain output without --fields.
std::vector<std::string> usual_event_fields();

/// An event as a line for people. It begins with the time by which the change had happened, which may be long before
/// the event arrived.
std::string event_line(const Printer& printer, const Event& event);

}  // namespace collided::cli
