#pragma once

#include <string>
#include <vector>

#include "client/cli/output/output.hpp"
#include "collided/client.hpp"

namespace collided::cli {

/// Every field of an event, for machines; fields without meaning for its kind are empty.
Record fence_record(const FenceEvent& event);
/// The few fields of plain output where the user chose none.
std::vector<std::string> usual_fence_fields();
/// An event as a line for people. It begins with the time by which the change had happened.
std::string fence_line(const Printer& printer, const FenceEvent& event);

/// A fence of a list, for machines and as the cells of a table.
Record fence_record(const ListedFence& fence);
std::vector<std::string> fence_row(const ListedFence& fence);

}  // namespace collided::cli
