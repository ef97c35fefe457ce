#pragma once

#include <string>
#include <vector>

#include "client/cli/output/output.hpp"
#include "collided/client.hpp"

namespace collided::cli {

/// Every field of an event, for machines; fields without meaning for its kind are empty.
Record nearest_record(const NearestEvent& event);
/// The few fields of plain output where the user chose none.
std::vector<std::string> usual_nearest_fields();
/// An event as a line for people. It begins with the time by which the change had happened.
std::string nearest_line(const Printer& printer, const NearestEvent& event);

/// A question of a list, for machines and as the cells of a table.
Record nearest_record(const ListedNearest& listed);
std::vector<std::string> nearest_row(const ListedNearest& listed);

}  // namespace collided::cli
