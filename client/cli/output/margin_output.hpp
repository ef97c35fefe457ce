#pragma once

#include <string>
#include <vector>

#include "client/cli/output/output.hpp"
#include "collided/client.hpp"

namespace collided::cli {

/// Every field of an event, for machines; fields without meaning for its kind are empty.
Record margin_record(const MarginEvent& event);
/// The few fields of plain output where the user chose none.
std::vector<std::string> usual_margin_fields();
/// An event as a line for people. It begins with the time by which the change had happened.
std::string margin_line(const Printer& printer, const MarginEvent& event);

/// A margin of a list, for machines and as the cells of a table.
Record margin_record(const ListedMargin& listed);
std::vector<std::string> margin_row(const ListedMargin& listed);

}  // namespace collided::cli
