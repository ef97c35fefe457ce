#pragma once

#include <string>
#include <vector>

#include "client/cli/output/output.hpp"
#include "collided/client.hpp"

namespace collided::cli {

/// Every field of an event of a standing question, for machines; fields without meaning for its form or kind are empty.
Record standing_record(const StandingEvent& event);
/// The few fields of plain output without --fields.
std::vector<std::string> usual_standing_fields();
/// An event as a line for people. It begins with the time by which the change had happened.
std::string standing_line(const Printer& printer, const StandingEvent& event);

/// A standing question of a list, for machines.
Record standing_record(const ListedStanding& standing);
/// The same as the cells of a table, and the names of its columns.
std::vector<std::string> standing_row(const ListedStanding& standing);
std::vector<std::string> standing_columns();

/// The origin of the distances of a question for the nearest: an object's name, or a point.
std::string target_text(const DefinedStanding& standing);

}  // namespace collided::cli
