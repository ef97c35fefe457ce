#pragma once

#include <chrono>
#include <string>

#include "client/cli/output.hpp"
#include "collided/client.hpp"

namespace collided::cli {

/// Every field of an event, for machines; those that say nothing of its kind are empty.
Record event_record(const Event& event);

/// For people. at  what the line begins with: when it was told, or when it happened
std::string event_line(const Printer& printer, const Event& event, std::chrono::nanoseconds at);

}  // namespace collided::cli
